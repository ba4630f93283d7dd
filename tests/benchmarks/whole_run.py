"""Runs one configuration from start to file and says where the time went.

usage: whole_run.py PIPELINE CONFIG

Prints wall seconds and peak memory of the whole process, the seconds of integration, truth (summed over threads and
divided by their number) and algorithms (all repeats), and the share of everything else.
"""
import json
import os
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
    out = subprocess.run([program, "run", config, "-o", path, "--quiet", "--json"], check=True, stdout=subprocess.PIPE)
    wall = time.monotonic() - start
    memory = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    digest = json.loads(out.stdout)["digest"]
    with h5py.File(path) as file:
        integration = file["physics/time_ns"][:].sum() * 1e-9 if "physics" in file else 0.0
        threads = os.cpu_count()
        truth = file["truth/time_ns"][:].sum() * 1e-9 / threads
        repeats = json.loads(out.stdout)["repeats"]
        # The median repeat stands for every repeat, and the untimed pass that counts operations does the same work.
        passes = file["results/time_median_ns"][:].astype(np.float64).sum() * 1e-9 * (repeats + 1)
        labels = [name.decode() if isinstance(name, bytes) else name for name in file["algorithm"][:]]
        means = file["summary/time_mean_ns"][:]
    rest = wall - integration - truth - passes
    print(f"digest {digest}")
    print(f"wall {wall:.1f} s, peak memory {memory:.0f} MiB")
    print(f"integration {integration:.1f} s, truth {truth:.1f} s on {threads} threads, algorithms {passes:.1f} s, "
          f"everything else {rest:.1f} s = {100 * rest / wall:.1f} %")
    for label, mean in sorted(zip(labels, means), key=lambda row: row[1]):
        print(f"  {label:24s} {mean * 1e-6:10.4f} ms per step")
