"""A sweep on a cluster of two nodes: six points, one is cancelled, one invalid, and a node goes down and comes back.
Then one run that two workers share (shards.py)."""

import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

from cluster import NoCluster, cluster, states, until
from shards import shared

ROOT = pathlib.Path(__file__).resolve().parents[2]
PIPELINE = os.environ.get("PIPELINE", str(ROOT / "build" / "pipeline"))
SWEEP = """title = "Six points"
config = "smoke.toml"
[set]
steps = 40
[grid]
scene.segments = [3, 4, 5, 6, 7, 0]
"""
# The program behind a gate, so that points are surely running when something is done to them.
GATED = """#!/bin/sh
if [ "$1" = run ]; then until [ -e {gate} ]; do sleep 0.1; done; fi
exec {pipeline} "$@"
"""
STARTED = []
POINTS, INVALID = [f"segments={n}" for n in (3, 4, 5, 6, 7, 0)], "segments=0"


def sweep(folder, *options, what="six.toml", program="program", environment=None):
    command = [
        ROOT / "scripts" / "sweep",
        folder.parent / what,
        "-o",
        folder,
        "--program",
        folder.parent / program,
        *options,
    ]
    with open(folder.parent / f"{folder.name}.err", "w") as err:
        process = subprocess.Popen(list(map(str, command)), env=environment, stdout=subprocess.DEVNULL, stderr=err)
    STARTED.append(process)
    return process


def ended(process, folder, seconds=240):
    """What a sweep said once it has ended."""
    process.wait(seconds)
    words = (folder.parent / f"{folder.name}.err").read_text()
    print(words, file=sys.stderr, flush=True)
    return words


def manifest(folder):
    return {point["name"]: point for point in json.loads((folder / "sweep.json").read_text())["points"]}


def running(folder):
    """node -> state of the point that runs on it."""
    kept = [json.loads(path.read_text()) for path in (folder / "points").glob("*.json")]
    return {point["node"]: point for point in kept if point["status"] == "running"}


def check(scratch):
    gate, program = scratch / "gate", scratch / "program"
    (scratch / "six.toml").write_text(SWEEP)
    (scratch / "smoke.toml").write_text((ROOT / "configs" / "smoke.toml").read_text())
    program.write_text(GATED.format(gate=gate, pipeline=PIPELINE))
    program.chmod(0o755)
    folder = scratch / "slurm"

    (scratch / "cluster").mkdir()
    with cluster(scratch / "cluster") as environment:
        say("the cluster of two nodes is up")
        try:
            digests = on_slurm(folder, gate, environment)
            shared(scratch, environment, sweep, ended, ROOT, PIPELINE, say)
        finally:
            end_sweeps()  # while the cluster can still cancel what they started

    local = sweep(scratch / "local", "-j", "2")
    ended(local, scratch / "local")
    here = {name: point.get("digest") for name, point in manifest(scratch / "local").items()}
    assert here == digests and len(set(here.values())) == 6  # five digests, and none
    say("digests are those of a local sweep")


def on_slurm(folder, gate, environment):
    """Sweeps twice; name -> digest of the points."""

    def slurm(*command):
        return subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout

    swept = sweep(folder, "--slurm", "-j", "4", "--partition", "main", environment=environment)
    until(lambda: len(running(folder)) == 2, 120, lambda: running(folder))
    there = running(folder)
    cancelled, moved = there["n1"], there["n2"]
    say(f"{cancelled['name']} runs on n1 and is cancelled, {moved['name']} runs on n2, which goes down")
    slurm("scancel", cancelled["job"])
    slurm("scontrol", "update", "NodeName=n2", "State=DOWN", "Reason=test")
    until(lambda: "DOWN" in states(environment)["n2"], 20, lambda: states(environment))
    gate.touch()
    until(lambda: any(p["status"] == "done" for p in kept(folder)), 120, lambda: kept(folder))
    slurm("scontrol", "update", "NodeName=n2", "State=RESUME")
    say("n2 is back")
    ended(swept, folder)
    assert swept.returncode == 1, swept.returncode

    first = manifest(folder)
    assert list(first) == POINTS, "six rows, in their order"
    bad = {name: point["reason"] for name, point in first.items() if point["status"] != "done"}
    assert set(bad) == {cancelled["name"], INVALID}, bad
    assert "CANCELLED" in bad[cancelled["name"]], bad
    assert "'scene.segments' must be" in bad[INVALID], bad
    with open(folder / "sweep.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(dict.fromkeys(row["point"] for row in rows)) == POINTS
    assert {row["point"]: row["reason"] for row in rows if row["reason"]} == bad
    assert first[moved["name"]]["job"] == moved["job"], "Slurm itself put it back into the queue"
    say("six rows, two with their reasons")

    again = sweep(folder, "--slurm", "-j", "4", environment=environment)
    words = ended(again, folder)
    second = manifest(folder)
    repeated = {name for name in POINTS if second[name].get("started") != first[name].get("started")}
    assert repeated == {cancelled["name"]}, repeated  # the invalid one is asked about, it needs no job
    assert "6 points, 4 are done, 1 to run" in words
    assert {name for name, point in second.items() if point["status"] != "done"} == {INVALID}
    say("the rerun repeated those two only")
    return {name: point.get("digest") for name, point in second.items()}


def end_sweeps():
    for process in STARTED:
        if process.poll() is None:
            process.terminate()
            process.wait()


def kept(folder):
    return [json.loads(path.read_text()) for path in (folder / "points").glob("*.json")]


def say(text):
    print(f"{time.monotonic() - BEGAN:5.0f} s  {text}", flush=True)


if __name__ == "__main__":
    BEGAN = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="slurm-test-", ignore_cleanup_errors=True) as scratch:
        os.chmod(scratch, 0o755)  # munged, another user, reaches its folder through it
        try:
            check(pathlib.Path(scratch))
        except NoCluster as error:
            print(f"tests/slurm/run: skipped, no cluster starts here: {error}")
        except AssertionError:  # the folder is about to go
            for log in ("slurm/.sweep/snakemake.log", "shared/.sweep/snakemake.log", "cluster/slurmctld.log"):
                if not (pathlib.Path(scratch) / log).exists():
                    continue
                print(f"--- {log}\n{(pathlib.Path(scratch) / log).read_text()}", file=sys.stderr)
            raise
        finally:
            end_sweeps()
