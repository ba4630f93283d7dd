"""Runs one configuration from start to file and says where the time went.

usage: whole_run.py PIPELINE CONFIG

Prints wall seconds and peak memory of the whole process, the seconds of integration, truth (summed over threads and
divided by their number) and algorithms, and the share of everything else. The algorithms' time is that of the detect
stage: the timed passes, told apart, and the pass that counts operations, which no clock in the file covers.
"""
import json
import os
import pty
import re
import resource
import subprocess
import sys
import tempfile
import time

import h5py
import numpy as np

program, config = sys.argv[1:]
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "bench.h5")
    start = time.monotonic()
    # The progress bar, shown only on a terminal, ends with each stage's seconds.
    ours, theirs = pty.openpty()
    run = subprocess.Popen([program, "run", config, "-o", path, "--json"], stdout=subprocess.PIPE, stderr=theirs)
    os.close(theirs)
    bar = b""
    while True:
        try:
            block = os.read(ours, 65536)
        except OSError:  # the other end is closed
            break
        bar += block
    out = run.stdout.read()
    assert run.wait() == 0, bar.decode()
    wall = time.monotonic() - start
    detect = float(re.findall(rb"detect +\[#+\] 100 %.*?([0-9.]+) s\r?\n", bar)[-1])
    memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    digest = json.loads(out)["digest"]
    with h5py.File(path) as file:
        integration = file["physics/time_ns"][:].sum() * 1e-9 if "physics" in file else 0.0
        threads = os.cpu_count()
        truth = file["truth/time_ns"][:].sum() * 1e-9 / threads
        repeats = json.loads(out)["repeats"]
        timed = file["results/time_median_ns"][:].astype(np.float64).sum() * 1e-9 * repeats
        labels = [name.decode() if isinstance(name, bytes) else name for name in file["algorithm"][:]]
        means = file["summary/time_mean_ns"][:]
    rest = wall - integration - truth - detect
    print(f"digest {digest}")
    print(f"wall {wall:.1f} s, peak memory {memory:.0f} MiB")
    print(f"integration {integration:.1f} s, truth {truth:.1f} s on {threads} threads, algorithms {detect:.1f} s "
          f"(timed {timed:.1f} s), everything else {rest:.1f} s = {100 * rest / wall:.1f} %")
    for label, mean in sorted(zip(labels, means), key=lambda row: row[1]):
        print(f"  {label:24s} {mean * 1e-6:10.4f} ms per step")
