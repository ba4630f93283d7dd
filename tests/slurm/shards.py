"""One run shared by two workers on the cluster: one is killed by SIGKILL in its chunk, one is stopped for longer than
its lease. The result has the digest of a plain run."""

import json
import os
import signal
import subprocess
import time

from cluster import until

LEASE = 3  # s
SHARED = {"steps = 120": "steps = 300", "repeats = 1": "repeats = {repeats}"}  # of configs/smoke.toml
# Workers wait for each other, so that both surely have a chunk at one time.
PROGRAM = """#!/bin/sh
if [ "$1" = work ]; then
  : >{gate}.$$
  until [ -e {gate} ]; do sleep 0.1; done
  exec {pipeline} "$@" --lease {lease}
fi
exec {pipeline} "$@"
"""
REPEATS = 240  # a chunk takes seconds


def shared(scratch, environment, sweep, ended, root, pipeline, say):
    """Raises AssertionError. sweep(folder, ...) starts scripts/sweep, ended(process, folder) waits for it."""
    text = (root / "configs" / "smoke.toml").read_text()
    for old, new in SHARED.items():
        assert old in text
        text = text.replace(old, new.format(repeats=REPEATS))
    config, program, gate = scratch / "shared.toml", scratch / "sharing", scratch / "workers"
    config.write_text(text)
    program.write_text(PROGRAM.format(pipeline=pipeline, lease=LEASE, gate=gate))
    program.chmod(0o755)
    folder = scratch / "shared"
    swept = sweep(folder, "--shards", "2", "--slurm", "-j", "4", what=config, program=program, environment=environment)
    plain = subprocess.Popen([pipeline, "run", config, "-o", scratch / "plain.h5", "--quiet", "--json"],
                             stdout=subprocess.PIPE, text=True)  # fmt: skip
    part = folder / "points" / "shared.h5.part"

    def claimed():
        """process -> chunk that it makes, of both workers."""
        found = {}
        for path in part.glob("answers-*.claim"):
            try:
                found[json.loads(path.read_text())["process"]] = path
            except (OSError, ValueError):
                pass  # it was given back
        return found if len(found) == 2 else None

    def told():
        return swept.poll(), list(part.glob("*"))

    until(lambda: len(list(scratch.glob("workers.*"))) == 2, 180, told)
    gate.touch()
    (killed, chunk), (stopped, other) = until(claimed, 60, told).items()
    os.kill(stopped, signal.SIGSTOP)
    os.kill(killed, signal.SIGKILL)
    say(f"both workers have a chunk; that of {chunk.stem} is killed, that of {other.stem} is stopped for two leases")
    time.sleep(2 * LEASE)
    assert not (part / chunk.stem).exists() and chunk.exists(), "it was killed in its chunk"
    os.kill(stopped, signal.SIGCONT)
    ended(swept, folder)
    assert swept.returncode == 0, swept.returncode
    point = json.loads((folder / "sweep.json").read_text())["points"][0]
    digest = json.loads(plain.communicate()[0])["digest"]
    assert point["status"] == "done" and point["digest"] == digest, point
    assert not part.exists()
    say(f"the shared run has the digest of the plain one, {digest}")
