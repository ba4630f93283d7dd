"""Recorded motions of tests/data decided and answered again: the same bits on every machine and build."""
import json

import pytest
from program import ROOT, pipeline


def shown(*arguments):
    run = pipeline(*arguments)
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout)["digests"]


@pytest.mark.parametrize("name", ["falling", "box"])
def test_truth_and_answers_of_a_recorded_motion_do_not_change(tmp_path, name):
    recorded = ROOT / "tests" / "data" / f"{name}.h5"
    config = tmp_path / "again.toml"
    config.write_text(f'[scene]\nkind = "replay"\nmotion = "{recorded}"\n[timing]\nrepeats = 1\n'
                      '[[algorithm]]\nname = "aabb"\n')
    again = shown("run", config, "-o", tmp_path / "again.h5", "--json")
    before = shown("show", recorded, "--json")
    for group in ("/motion", "/truth", "/answers/aabb"):
        assert again[group] == before[group], group
