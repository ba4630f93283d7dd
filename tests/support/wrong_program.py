"""A program that answers with balls of 1 m and goes wrong at step 4 as its first word says (test_foreign.py)."""
import os
import signal
import struct
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "algorithms" / "program"))
import collision_program  # noqa: E402

how = sys.argv[1]
now = False  # whether it is the moment to go wrong
asked = 0
send, hits = collision_program.send, collision_program.hits


def near(step):
    at = step.positions
    return [(a, b) for a, b in step.pairs() if sum((p - q) ** 2 for p, q in zip(at[a], at[b])) < 4]


def answer(step):
    global now, asked
    asked += 1
    now = step.number >= 4
    pairs = near(step)
    if not now:
        return pairs
    if how == "throw":
        raise ValueError("no such luck")
    if how == "abort":
        print("about to abort", file=sys.stderr)
        os.abort()
    if how == "crash":
        signal.signal(signal.SIGSEGV, signal.SIG_DFL)
        os.kill(os.getpid(), signal.SIGSEGV)
    if how == "killed":
        os.kill(os.getpid(), signal.SIGKILL)
    if how == "end":
        os._exit(0)
    if how == "leak":
        kept = []
        while True:
            kept.append(bytearray(1 << 20))
    if how == "hang":
        time.sleep(1000)
    if how == "slow":
        time.sleep(0.3)
    if how == "print":
        print("what is printed goes to stderr")
        os.system("echo and so does what is started")
    if how == "unsure":
        return pairs if asked % 2 else []
    wrong = {"unknown": (0, 99), "order": (2, 0), "self": (2, 2), "unborn": (0, 1), "unasked": (2, 3)}
    if how in wrong:
        return [wrong[how]]
    if how == "twice":
        return [(0, 2), (0, 2)]
    if how == "many":
        return [(0, 2)] * 1000
    return pairs


def wrong_hits(pairs, time_ns=0, prepare_ns=0, operations=0):
    if now and how in ("nan", "negative", "long"):
        time_ns, prepare_ns = {"nan": float("nan"), "negative": -1.0, "long": 1e18}[how], 0
    return hits(pairs, time_ns, prepare_ns, operations)


def wrong_send(to, kind, number, content=b""):
    if not now or kind != b"HITS":
        return send(to, kind, number, content)
    if how == "noise":
        to.write(b"Babylon.js v6.49.0 - WebGL2\n")
    if how in ("half", "half_hang"):
        to.write(b"HITS" + struct.pack("<II", number, len(content)) + content[:-1])
        to.flush()
        if how == "half_hang":
            time.sleep(1000)
        os._exit(0)
    if how == "huge":
        to.write(b"HITS" + struct.pack("<II", number, 0xffffffff) + bytes(1000))
    if how == "close":
        os.close(to.fileno())
        time.sleep(1000)
    if how == "garbage":
        to.write(bytes(range(100)))
    if how == "again":
        send(to, kind, number, content)
        time.sleep(0.001)  # the second may come before, with and after the next question
    send(to, kind, number, content)


if how == "at_once":
    print("cannot find the engine", file=sys.stderr)
    sys.exit(7)
if how == "deaf":
    time.sleep(1000)
if how == "banner":
    os.write(1, b"Welcome to the engine\n")
collision_program.send, collision_program.hits = wrong_send, wrong_hits
about = {"promise": "always"} if how == "promise" else {}
collision_program.serve(lambda run: answer, name="wrong", **about)
