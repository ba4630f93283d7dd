"""What Snakemake starts: one point of a sweep, or the question what points would take.

    scripts/python -m analysis.sweep.point run|motion|check PLAN.json NUMBER
    scripts/python -m analysis.sweep.point work PLAN.json NUMBER SHARD

`run` runs the program once and keeps what came of it in points/NAME.json, whatever it is: a run that fails is a row of
the table, not an error of the sweep. So it ends with 0, unless it was stopped or nothing can be written. The file is
there from the start, so that a process that dies without a word has left its host and its job.

With shards `motion` comes before, then workers, and `run` assembles: what a worker could not do, it does.
"""

import json
import os
import signal
import socket
import subprocess
import sys
import time

from .state import identity, inputs_sha256, read_json, write_json

NOTE = "warning: "
STOPS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
INTERRUPTED = 130  # the program's own exit code for such a signal
TAIL = 1 << 16  # bytes of a log in which the reason is looked for


def main():
    _, act, plan, number, *shard = sys.argv
    with open(plan, encoding="utf-8") as file:
        plan = json.load(file)
    of = plan["check" if act == "check" else "run"][int(number)]
    return {"run": run, "motion": motion, "work": work, "check": check}[act](plan, of, *shard)


def motion(plan, point):
    """Makes the motion of a point that workers will share; 0 as run."""
    return run(plan, point, ["--motion-only"])


def work(plan, point, shard):
    """Fills chunks of a point beside other workers. What it cannot do, for want of disk or memory say, others do: only
    one that was stopped is worth another try."""
    base = os.path.join(plan["folder"], "points", point["name"])
    if (read_json(base + ".json") or {}).get("status") != "running":
        return 0  # its motion could not be made
    options = plan["options"]
    plugins = [word for option, value in zip(options, [*options[1:], ""]) if option == "--plugin"
               for word in (option, value)] + [option for option in options if option.startswith("--plugin=")]
    command = [plan["program"], "work", base + ".h5.part", "--quiet", "--threads", str(plan["threads"]),
               "--config", point["config"], *_sets(point), *plugins]
    code, ended = _process(command, plan["cwd"], f"{base}.work-{shard}.log")
    return 1 if ended else 0


def run(plan, point, only=()):
    """Runs one point; 0 when the file of its state says what came of it."""
    base = os.path.join(plan["folder"], "points", point["name"])
    before = read_json(base + ".json") or {} if plan["shards"] and not only else {}
    if before and before.get("status") != "running":
        return 0  # it has failed
    state = {name: point[name] for name in ("name", "parameters", "config", "sets", "identity")} | {
        "status": "running",
        "reason": "",
        "exit_code": None,
        "host": socket.gethostname(),
        "node": os.environ.get("SLURMD_NODENAME", ""),
        "job": os.environ.get("SLURM_JOB_ID", ""),
        "started": time.strftime("%Y-%m-%dT%H:%M:%S%z"),
        "began": time.time(),
    } | {name: before[name] for name in ("started", "began") if name in before}
    try:
        write_json(base + ".json", state)
        changed = identity(plan["program"], point["config"], point["sets"], plan["options"])
        if changed != point["identity"]:
            what = [name for name, value in changed.items() if value != point["identity"][name]]
            state |= {
                "status": "failed",
                "reason": f"{', '.join(what)} changed while the sweep was running; run it again",
            }
        else:
            state |= _ran(plan, point, base, only)
            if before:
                state["wall_time_s"] = round(time.time() - state["began"], 3)  # of all that shared it
        if only and state["status"] == "done":
            state["status"] = "running"
        write_json(base + ".json", state)
    except OSError as error:
        print(error, file=sys.stderr)
        return 1
    return 1 if state["status"] == "stopped" else 0


def _process(command, folder, log):
    """Runs it; its exit code, and the signal by which it or this process was told to stop, None if by none."""
    stopped = []
    with open(log, "wb") as file:
        process = subprocess.Popen(
            command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=file
        )

        def stop(
            number, _
        ):  # scancel, a time limit and Ctrl-C: the program keeps what it has, the next sweep goes on from there
            stopped.append(number)
            process.terminate()

        for number in STOPS:
            signal.signal(number, stop)
        code = process.wait()
    # A scheduler's signal goes to all processes of a job; the program may end before this one has noticed its own.
    ended = stopped[0] if stopped else -code if -code in STOPS else signal.SIGTERM if code == INTERRUPTED else None
    return code, ended


def _ran(plan, point, base, only):
    command = [plan["program"], "run", point["config"], "-o", base + ".h5", "--quiet", "--force",
               "--threads", str(plan["threads"]), *only, *_sets(point), *plan["options"]]
    began = time.monotonic()
    code, ended = _process(command, plan["cwd"], base + ".log")
    found = {"exit_code": code if code >= 0 else 128 - code, "wall_time_s": round(time.monotonic() - began, 3)}
    if ended:
        reason = f"stopped by {signal.Signals(ended).name} (cancelled, or its time was up); a rerun goes on from there"
        return found | {"status": "stopped", "reason": reason}
    if code < 0:
        memory = " (its memory was up?)" if code == -signal.SIGKILL else ""
        return found | {"status": "failed", "reason": f"killed by {signal.Signals(-code).name}{memory}"}
    reason = "" if code == 0 else _reason(base) or f"exit code {code} without a word"
    if code in (0, 1) and not only and os.path.exists(base + ".h5"):
        try:
            found |= _told(base + ".h5")
        except (OSError, KeyError, ValueError, RuntimeError) as error:
            code, reason = code or 1, reason or " ".join(str(error).split())
    return found | {"status": "done" if code == 0 else "failed", "reason": reason}


def _told(path):
    """What the table needs of a result."""
    from ..load import load  # takes a second, which points that fail early need not

    result = load(path)
    rows = []
    for label, row in result.summary.iterrows() if len(result.summary.columns) else []:
        answers = result.meta["answers"][label]
        kept = {
            name: answers[name] for name in ("name", "knobs", "promise", "scope", "operations_unit") if name in answers
        }
        rows.append(
            {"label": label}
            | {"algorithm": kept.pop("name", label)}
            | kept
            | {name: plain(v) for name, v in row.items()}
        )
    return {
        "digest": result.meta["digest"],
        "file_bytes": os.path.getsize(path),
        "inputs": inputs_sha256(result.meta.get("inputs_sha256", "{}")),
        "title": result.meta.get("title", ""),
        "build": " ".join(str(result.meta.get(name, "")) for name in ("git_commit", "build_type", "compiler")),
        "processor": _processor(result),
        "steps": result.meta["steps"],
        "bodies": len(result.meta["bodies"]),
        "truth_hits": int(result.truth_hits.sum()),
        "summary": rows,
    }


def _processor(result):
    """On which it was timed; of a run that was shared it may have been assembled on another."""
    timed = [answers["processor"] for answers in result.meta["answers"].values() if answers.get("processor")]
    return timed[0] if timed else result.meta["run"].get("processor", "")


def plain(value):
    value = value.item() if hasattr(value, "item") else value
    return None if isinstance(value, float) and value != value else value


def _reason(base):
    """The error among the last lines of a log: what is no warning."""
    with open(base + ".log", "rb") as file:
        file.seek(max(0, os.path.getsize(base + ".log") - TAIL))
        lines = file.read().decode(errors="replace").strip().splitlines()
    lines = [line for line in lines if line and not line.startswith(NOTE)]
    return lines[-1].removeprefix(f"{base}.h5: ") if lines else ""


def _sets(point):
    return [word for key, value in point["sets"].items() for word in ("--set", f"{key}={value}")]


def check(plan, group):
    """Asks once for points that differ by their seed alone; the first that can run stands for the others."""
    failed = {}
    for point in group["points"]:
        output = os.path.join(plan["folder"], "points", point["name"] + ".h5")
        command = [plan["program"], "check", point["config"], "-o", output, "--json", *_sets(point), *plan["options"]]
        done = subprocess.run(
            command, cwd=plan["cwd"], stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace"
        )
        if done.returncode == 0:
            told = json.loads(done.stdout)
            found = {name: told[name] for name in ("memory_bytes", "seconds", "file_bytes")}
            break
        lines = [line for line in done.stderr.strip().splitlines() if not line.startswith(NOTE)]
        failed[point["name"]] = {
            "exit_code": done.returncode,
            "reason": lines[-1] if lines else "check failed without a word",
        }
    else:
        found = {}
    try:
        write_json(group["file"], found | {"failed": failed})
    except OSError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
