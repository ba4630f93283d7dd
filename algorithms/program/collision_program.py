"""A method of your own in Python, asked by `pipeline` on stdin and stdout: algorithms/README.md, "A program".

    from collision_program import serve

    def setup(run):        # once. run: label, bodies (name, mesh, fixed), meshes (name, vertices, triangles), knobs
        def answer(step):  # timed. The pairs (a, b), a < b, that meet
            return [(a, b) for a, b in step.pairs() if near(step.positions[a], step.positions[b])]
        return answer

    serve(setup, name="mine")  # what is printed goes to stderr: stdout belongs to the frames
"""
import json
import os
import platform
import struct
import time
import traceback


class Step:
    """One question: poses of all bodies (NaN: not there yet) and runs (a, first, last) of the pairs asked about."""

    def __init__(self, content, bodies):
        self.number, runs, self.enlarge = struct.unpack_from("<IId", content)
        flat = struct.unpack_from(f"<{7 * bodies}d", content, 16)
        self.positions = [flat[i:i + 3] for i in range(0, 7 * bodies, 7)]         # m
        self.orientations = [flat[i + 3:i + 7] for i in range(0, 7 * bodies, 7)]  # unit quaternions w x y z
        self.runs = list(struct.iter_unpack("<3I", content[16 + 56 * bodies:16 + 56 * bodies + 12 * runs]))

    def pairs(self):
        return ((a, b) for a, first, last in self.runs for b in range(first, last))


def send(to, kind, number, content=b""):
    to.write(kind + struct.pack("<II", number, len(content)) + content)
    to.flush()


def hits(pairs, time_ns=0, prepare_ns=0, operations=0):
    flat = [int(body) for pair in pairs for body in pair]
    return struct.pack("<3d", time_ns, prepare_ns, operations) + struct.pack(f"<{len(flat)}I", *flat)


def serve(setup, **about):
    down, up = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    method, bodies, number = {}, 0, 0
    try:
        while head := down.read(12):
            kind, number, length = struct.unpack("<4sII", head)
            content = down.read(length)
            if kind == b"HELO":
                run = json.loads(content)
                bodies, start = len(run["bodies"]), time.perf_counter_ns()
                made = setup(run)
                method = made if isinstance(made, dict) else {"answer": made}
                setup_ns = time.perf_counter_ns() - start
                said = {"protocol": 1, "language": "Python " + platform.python_version(), "setup_ns": setup_ns,
                        "remembers": "remember" in method, **method.get("about", {}), **about}
                send(up, b"HELO", number, json.dumps(said).encode())
            elif kind == b"STEP":
                step = Step(content, bodies)
                start = time.perf_counter_ns()
                method.get("prepare", bool)(step)
                prepared = time.perf_counter_ns()
                pairs = list(method["answer"](step))
                end = time.perf_counter_ns()
                send(up, b"HITS", number, hits(pairs, end - start, prepared - start if "prepare" in method else 0))
            elif kind == b"OPER":
                step = Step(content, bodies)
                method.get("prepare", bool)(step)
                operations, pairs = method["count"](step)
                send(up, b"HITS", number, hits(pairs, operations=operations))
            else:
                method["remember" if kind == b"KEEP" else "forget"]()
                send(up, b"DONE", number)
    except Exception as error:
        line = traceback.extract_tb(error.__traceback__)[-1]
        send(up, b"FAIL", number, f"{type(error).__name__}: {error} ({line.filename}:{line.lineno})".encode()[:65536])
