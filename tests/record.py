"""Makes a small recorded motion for tests and benchmarks from some steps of a result.

usage: record.py PIPELINE RESULT OUT STEP[,STEP...]

The steps become steps 0, 1, ... of a replayed scene with the same bodies and, bit for bit, the same poses; OUT holds
them with their truth and the answers of one cheap algorithm. The files in tests/data were made so:
  falling.h5  configs/padani.toml, steps 0,60,140,200,252,260,400,599
  box.h5      configs/kostka.toml, steps 400,450,500,599 (all 80 spheres born)
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py

program, source, out, steps = sys.argv[1:]
steps = [int(step) for step in steps.split(",")]
with h5py.File(source) as file, tempfile.TemporaryDirectory() as folder:
    names = [name.decode() for name in file["body"][:]]
    meshes = [name.decode() for name in file["bodies/mesh"][:]]
    fixed = file["bodies/fixed"][:]
    lines = ["title = " + json.dumps(f"{len(steps)} recorded steps of {file.attrs['title']}"), "[scene]",
             'kind = "replay"', 'poses = "poses.csv"']
    for name, mesh, still in zip(names, meshes, fixed):
        shape = json.loads(file["meshes"][mesh].attrs["shape"])
        lines += ["[[scene.body]]", f'name = "{name}"', f'shape = "{shape.pop("kind")}"']
        lines += [f"{key} = {json.dumps(value)}" for key, value in shape.items()]
        lines += ["fixed = true"] if still else []
    lines += ["[timing]", "repeats = 1", "[[algorithm]]", 'name = "aabb"']
    Path(folder, "scene.toml").write_text("\n".join(lines))
    rows = ["step,body,px,py,pz,qw,qx,qy,qz"]
    for number, step in enumerate(steps):
        for name, still, p, q in zip(names, fixed, file["motion/position"][step], file["motion/orientation"][step]):
            if number == 0 or not still:
                rows.append(",".join([str(number), name] + [repr(float(x)) for x in (*p, *q)]))
    Path(folder, "poses.csv").write_text("\n".join(rows) + "\n")
    subprocess.run([program, "run", Path(folder, "scene.toml"), "-o", out, "--force", "--quiet"], check=True)
    with h5py.File(out) as made:
        for name in ("position", "orientation"):
            assert (made["motion"][name][:] == file["motion"][name][:][steps]).all(), name
