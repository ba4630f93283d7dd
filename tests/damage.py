"""Damages a result in many ways and asks every reader: never another number, never a signal, never without end.

usage: damage.py [--seed N] [--flips N] [--resealed N] [FILE]     the long tests/commands/test_damage.py; prints a table

Bits are flipped, blocks of 4 KiB zeroed, ends cut off, as a disk does; then the same with the seal renewed, as only
somebody does who means to, so that the library meets the damage and the child process and the digests must find it.
Without a seal that holds the answer is always code 4. With one, code 4, or what the digests cover as it was: times and
attributes are then whatever he wrote.
"""
import argparse
import json
import random
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parent.parent)]

from editing import MAGIC, sealed  # noqa: E402
from program import DONE, FILE, PIPELINE, ROOT  # noqa: E402

from analysis.load import load  # noqa: E402

BLOCK = 4096
COUNTS = ("label", "hits", "true_positive", "false_positive", "false_negative", "error", "operations")


def flipped(content, random):
    at = random.randrange(len(content))
    return f"bit {at}", content[:at] + bytes([content[at] ^ 1 << random.randrange(8)]) + content[at + 1 :]


def blocks(content):
    for at in range(0, len(content), BLOCK):
        if any(content[at : at + BLOCK]):
            end = min(at + BLOCK, len(content))
            yield f"block {at}", content[:at] + bytes(end - at) + content[end:]


def cut(content, random):
    size = random.randrange(len(content))
    return f"cut to {size}", content[:size]


def cases(content, seed, flips, resealed, every=1):
    """(what, content, whether its seal holds); `every`: of the resealed blocks one in that many."""
    generator = random.Random(seed)
    hdf5 = content[: content.rindex(MAGIC)]
    for _ in range(flips):
        yield *flipped(content, generator), False
    for what, damaged in blocks(content):
        yield what, damaged, False
    for _ in range(flips // 10 + 1):
        yield *cut(content, generator), False
    for _ in range(resealed):
        what, damaged = flipped(hdf5, generator)
        yield f"{what}, resealed", sealed(damaged), True
    for what, damaged in list(blocks(hdf5))[generator.randrange(every) :: every]:
        yield f"{what}, resealed", sealed(damaged), True


def figures(shown):
    return shown["digests"], [[row[key] for key in COUNTS] for row in shown["algorithms"]]


def shown(path):
    """(code, what `show --json` prints, stderr); negative codes are signals, None: it did not end."""
    try:
        run = subprocess.run([PIPELINE, "show", str(path), "--json"], capture_output=True, timeout=120)
    except subprocess.TimeoutExpired:
        return None, None, ""
    return run.returncode, json.loads(run.stdout) if run.stdout else None, run.stderr.decode()


def loaded(path):
    """(code, what the digests cover of the tables, the error) by analysis.load."""
    try:
        run = load(path)
        table = run.summary[[name for name in run.summary.columns if not name.endswith("_ns")]]
        return DONE, (run.meta["digest"], table.to_csv(), run.truth_pairs.to_csv()), ""
    except (OSError, ValueError) as error:
        return FILE, None, str(error)


class Readers:
    """What both readers say of a whole result, to judge what they say of damaged ones."""

    def __init__(self, path):
        code, document, said = shown(path)
        assert code == DONE, said
        self.figures = figures(document)
        code, self.tables, said = loaded(path)
        assert code == DONE, said

    def fault_of_show(self, path, holds):
        """What `show` does wrong with a damaged file; "" when nothing."""
        code, document, said = shown(path)
        if code == FILE:
            lines = said.splitlines()
            return "" if len(lines) == 1 and lines[0].startswith(f"{path}: ") else f"said {said!r}"
        if code == DONE and holds:
            return "" if figures(document) == self.figures else "shows other figures"
        return f"code {code}: {said}"

    def fault_of_load(self, path, holds):
        code, tables, said = loaded(path)
        if code == FILE:
            return "" if said.startswith(f"{path}: ") and "\n" not in said else f"said {said!r}"
        return "" if holds and tables == self.tables else "loads other figures" if holds else "loads it"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", nargs="?", default=str(ROOT / "tests" / "data" / "box.h5"))
    parser.add_argument("--seed", type=int, default=random.randrange(2**32))
    parser.add_argument("--flips", type=int, default=2500)
    parser.add_argument("--resealed", type=int, default=1000)
    chosen = parser.parse_args()
    print(f"seed {chosen.seed}")
    readers, content = Readers(chosen.file), Path(chosen.file).read_bytes()
    counts, faults = {}, 0
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "damaged.h5")
        for what, damaged, holds in cases(content, chosen.seed, chosen.flips, chosen.resealed):
            path.write_bytes(damaged)
            kind = what.split()[0] + (", resealed" if holds else "")
            for name, fault in (("show", readers.fault_of_show), ("load", readers.fault_of_load)):
                found = fault(str(path), holds)
                count = counts.setdefault(f"{kind}: {name}", [0, 0])
                count[0] += 1
                count[1] += bool(found)
                if found:
                    faults += 1
                    print(f"{what}: {name} {found}", flush=True)
    for kind, (tried, wrong) in counts.items():
        print(f"{kind:24} {tried:6} tried {wrong:4} wrong")
    return faults > 0


if __name__ == "__main__":
    sys.exit(main())
