#!/usr/bin/env -S /usr/bin/python3
"""Reads every mesh file under some folders by this program and by assimp, and lists where they differ.

    PIPELINE=build/pipeline /usr/bin/python3 tests/survey_meshes.py FOLDER... [--all]

Compared are triangles, their corners' distinct places, their area and the box around them, as far as assimp's single
precision allows. Needs Debian's assimp-utils, which the set-up does not install; Debian's assimp-testmodels is a
folder to begin with (/usr/share/assimp/models). Prints one row per file that differs (--all: per file), and a sum.
"""
import argparse
import os
import struct
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

PIPELINE = os.environ.get("PIPELINE", str(Path(__file__).resolve().parent.parent / "build" / "pipeline"))
KINDS = {".obj", ".off", ".ply", ".stl"}
SECONDS = 120  # for one file, by either


@dataclass
class Surface:
    triangles: int
    places: int  # distinct, of corners, in single precision
    area: float
    edges: float  # sum of lengths: what rounding the corners can do to the area, by that rounding
    low: np.ndarray
    high: np.ndarray


def surface(corners):
    """Of an array of triangles, T x 3 x 3."""
    edges = corners[:, 1:] - corners[:, :1]
    area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1).sum() / 2
    length = np.linalg.norm(edges, axis=2).sum() + np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1).sum()
    points = corners.reshape(-1, 3)
    if len(corners) == 0:
        return Surface(0, 0, 0.0, 0.0, np.zeros(3), np.zeros(3))
    places = len(np.unique(points.astype(np.float32) + np.float32(0), axis=0))  # -0 is 0
    return Surface(len(corners), places, float(area), float(length), points.min(axis=0), points.max(axis=0))


def ours(path):
    """What a run of one step stores of the mesh, and what it says of the file; or why it refuses it."""
    with tempfile.TemporaryDirectory() as folder:
        mesh = Path(folder) / f"m{path.suffix.lower()}"  # any name can be put into the configuration so
        mesh.symlink_to(path.resolve())
        poses = "step,body,px,py,pz,qw,qx,qy,qz\n0,m,0,0,0,1,0,0,0\n0,b,0,0,0,1,0,0,0\n"
        (Path(folder) / "p.csv").write_text(poses)
        (Path(folder) / "c.toml").write_text(
            f'[scene]\nkind = "replay"\nposes = "p.csv"\n[[scene.body]]\nname = "m"\nmesh = "{mesh.name}"\n'
            '[[scene.body]]\nname = "b"\nshape = "box"\nsize = [1, 1, 1]\n'
            '[timing]\nrepeats = 1\n[[algorithm]]\nname = "aabb"\n')
        command = [PIPELINE, "run", "c.toml", "-o", "r.h5", "--quiet"]
        run = subprocess.run(command, cwd=folder, text=True, capture_output=True, timeout=SECONDS)
        said = [line.removeprefix("warning: ").replace(mesh.name, path.name) for line in run.stderr.splitlines()]
        if run.returncode != 0:
            return None, said
        with h5py.File(Path(folder) / "r.h5") as file:
            return surface(file["meshes/m/vertices"][()][file["meshes/m/triangles"][()]]), said


def assimps(path):
    """The same of assimp, as the binary PLY that it writes of the file, triangulated. It may hold lines and points."""
    with tempfile.TemporaryDirectory() as folder:
        ply = Path(folder) / "a.ply"
        command = ["assimp", "export", str(path), str(ply), "-fplyb", "-tri"]
        run = subprocess.run(command, text=True, capture_output=True, timeout=SECONDS)
        if run.returncode != 0 or not ply.exists():
            lines = [line for line in (run.stdout + run.stderr).splitlines() if "rror" in line or "ail" in line]
            return None, (lines or [f"ends with {run.returncode}"])[-1].strip()
        head, body = ply.read_bytes().split(b"end_header\n", 1)
        words = [line.split() for line in head.decode().splitlines()]
        count = {line[1]: int(line[2]) for line in words if line[0] == "element"}
        names = [line[2] for line in words if line[0] == "property" and line[1] != "list"]
        for colour in ("u1", "f4"):  # 5.2.5 announces bytes and writes single reals
            vertex = np.dtype([(name, colour if name in ("red", "green", "blue", "alpha") else "f4") for name in names])
            found = ply_surface(body, vertex, count)
            if found:
                return (found, "") if found.triangles else (None, "has no triangle")
        return None, "its PLY is not understood"


def ply_surface(body, vertex, count):
    """Of vertices and lists of corners; nothing when they do not end where the file does."""
    at = vertex.itemsize * count["vertex"]
    if at > len(body):
        return None
    vertices = np.frombuffer(body, vertex, count=count["vertex"])
    points = np.stack([vertices[k] for k in "xyz"], axis=1).astype(float)
    triangles = []
    for _ in range(count["face"]):
        if at >= len(body):
            return None
        if body[at] == 3:
            triangles.append(struct.unpack_from("<3i", body, at + 1))
        at += 1 + 4 * body[at]
    return surface(points[np.array(triangles, dtype=int).reshape(-1, 3)]) if at == len(body) else None


def differences(a, b):
    """What differs between two surfaces, or between one and a refusal."""
    if (a is None) != (b is None):
        return ["refused by us" if a is None else "refused by assimp"]
    if a is None:
        return []
    out = [name for name in ("triangles", "places") if getattr(a, name) != getattr(b, name)]
    size = max(np.abs(a.low).max(), np.abs(a.high).max(), np.ptp([a.low, a.high], axis=0).max())
    rounding = 2.0**-23 * size
    if abs(a.area - b.area) > rounding * a.edges:
        out.append("area")
    if max(np.abs(a.low - b.low).max(), np.abs(a.high - b.high).max()) > rounding:
        out.append("bounds")
    return out


def row(name, ours_, assimps_, said, why):
    def of(s):
        if s is None:
            return "refused"
        extent = " x ".join(f"{x:.4g}" for x in s.high - s.low)
        return f"{s.triangles} triangles, {s.places} places, area {s.area:.6g}, {extent}"
    return f"{name}\n    ours:   {of(ours_)}" + "".join(f"\n            {line}" for line in said) + \
        f"\n    assimp: {of(assimps_)}" + (f"\n            {why}" if why else "")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="+", type=Path)
    parser.add_argument("--all", action="store_true", help="print equal ones too")
    arguments = parser.parse_args()
    files = sorted(p for folder in arguments.folder for p in folder.rglob("*") if p.suffix.lower() in KINDS
                   and p.is_file())
    equal = both_refuse = 0
    for path in files:
        found, said = ours(path)
        theirs, why = assimps(path)
        different = differences(found, theirs)
        equal += not different and found is not None
        both_refuse += found is None and theirs is None
        if different or arguments.all:
            verdict = ", ".join(different) or ("equal" if found else "refused by both")
            print(f"[{verdict}] {row(str(path), found, theirs, said, why)}", flush=True)
    print(f"{len(files)} files: {equal} equal, {both_refuse} refused by both, {len(files) - equal - both_refuse} "
          "differ")


if __name__ == "__main__":
    main()
