"""The method of algorithms/program/conversation.txt: centres nearer than the knob `reach`; fails at step 9."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "algorithms" / "program"))
from collision_program import serve  # noqa: E402


def setup(run):
    reach = run["knobs"]["reach"]
    print("a banner that must not reach stdout")

    def answer(step):
        if step.number == 9:
            raise ValueError("no step 9")
        return [(a, b) for a, b in step.pairs()
                if sum((p - q) ** 2 for p, q in zip(step.positions[a], step.positions[b])) < reach ** 2]

    def count(step):
        return sum(1 for _ in step.pairs()), answer(step)

    return {"answer": answer, "count": count, "remember": lambda: None, "forget": lambda: None}


serve(setup, name="near", version="1.0", promise="none", operations_unit="distances", memory_bytes=48)
