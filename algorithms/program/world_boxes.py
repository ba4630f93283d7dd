"""Axis-aligned boxes of the world vertices, the built-in `aabb` once more: an example of a method in Python.

    pipeline detect results/padani.h5 --algorithm 'program:command=python3 algorithms/program/world_boxes.py@boxes'
"""
from collision_program import serve


def setup(run):
    vertices = [run["meshes"][body["mesh"]]["vertices"] for body in run["bodies"]]
    boxes = [None] * len(vertices)

    def prepare(step):
        for body, (t, (w, x, y, z)) in enumerate(zip(step.positions, step.orientations)):
            if w != w:  # NaN: not there yet
                continue
            rows = ((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
                    (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
                    (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)))
            boxes[body] = []
            for (a, b, c), offset in zip(rows, t):
                along = [((a * p + b * q) + c * r) + offset for p, q, r in vertices[body]]
                boxes[body] += (min(along), max(along))

    def answer(step):
        for a, first, last in step.runs:
            x0, x1, y0, y1, z0, z1 = boxes[a]
            for b in range(first, last):
                u0, u1, v0, v1, w0, w1 = boxes[b]
                if x0 <= u1 and u0 <= x1 and y0 <= v1 and v0 <= y1 and z0 <= w1 and w0 <= z1:
                    yield a, b

    return {"prepare": prepare, "answer": answer}


serve(setup, name="world_boxes", version="1")
