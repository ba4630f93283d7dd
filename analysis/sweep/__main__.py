"""scripts/sweep: one configuration at many points, each a process and a result file, here or on Slurm.

SWEEP.toml names a configuration, the values of its keys and the seeds (configs/README.md); Snakemake runs the points,
one table has them all, failed ones with their reason. A rerun repeats only points that are missing, failed, or whose
configuration, inputs or program changed. --shards N has N processes work on every point, on as many nodes: for one
large configuration, which may be given in the place of a sweep.

Exit codes as the pipeline's: 0 all points are done, 1 some failed (the table is written and says which), 2 the command
line's grammar, 3 what is wrong in SWEEP.toml, 4 the folder of the results, 130 interrupted; the same command goes on.
"""

import argparse
import contextlib
import fcntl
import getpass
import hashlib
import json
import math
import os
import re
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

from ..output import complain, open_standard_descriptors, say, visible
from ..program import Refused, default_program
from . import tables
from .plan import points, read, refuse_if_many
from .state import file_sha256, identity, read_json, state, why_again, write_json

HERE = os.path.dirname(os.path.abspath(__file__))
ABOVE = os.path.dirname(os.path.dirname(HERE))
PACKAGE = __package__.rpartition(".")[0]  # as it is imported: analysis, or collision_analysis
SLURM_JOBS = 64  # at a time, unless -j says otherwise
MORE_MEMORY, MORE_MEMORY_MB = 1.5, 256  # than check foresees: it is right within a factor of 1.5
MORE_TIME, MORE_MINUTES = 2, 10  # than the longer of check's range: nodes differ, a file system may be slow
MANIFEST = "sweep.json"


def main(arguments=None):
    open_standard_descriptors()
    chosen = parsed(arguments)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's & ignores it, and what is started would too
    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) != signal.SIG_IGN:  # nohup means it
            signal.signal(number, signal.default_int_handler)
    try:
        return swept(chosen)
    except Refused as error:
        complain(error)
        return error.code
    except OSError as error:
        complain(f"{error.filename or 'scripts/sweep'}: {error.strerror}" if error.strerror else error)
        return 4
    except KeyboardInterrupt:
        complain("interrupted; the same command goes on")
        return 130


def parsed(arguments):
    parser = argparse.ArgumentParser(prog="scripts/sweep", description=__doc__.split("\n", 1)[0])
    parser.add_argument(
        "sweep",
        metavar="SWEEP.toml",
        help="a configuration, the values of its keys, seeds; see configs/sweeps. Or a configuration alone",
    )
    parser.add_argument(
        "-o", "--output", metavar="FOLDER", help="folder of the results (default: results/<name of SWEEP>)"
    )
    jobs = f"processors to use here (1: side by side, points disturb each other's times); jobs on Slurm ({SLURM_JOBS})"
    parser.add_argument("-j", "--jobs", type=int, metavar="N", help=jobs)
    shards = "workers that share each point: its motion is made by one, truth and answers by all"
    parser.add_argument("--shards", type=int, metavar="N", help=shards)
    parser.add_argument(
        "--slurm", action="store_true", help="a Slurm job for every point; the folder must be one that all nodes see"
    )
    parser.add_argument("--partition", help="Slurm's partition (default: the cluster's)")
    parser.add_argument("--account", help="Slurm's account")
    parser.add_argument(
        "--dry-run", action="store_true", help="say what would run, how large it is and how long it takes"
    )
    parser.add_argument("--yes", action="store_true", help="more than a thousand points are meant")
    named = "the built program (default: build/pipeline of this folder, or what PIPELINE names)"
    parser.add_argument("--program", default=default_program(), help=named)
    chosen = parser.parse_args(arguments)
    if chosen.jobs is not None and chosen.jobs < 1:
        parser.error("-j: must be at least 1")
    if chosen.shards is not None and not 1 <= chosen.shards <= 1000:
        parser.error("--shards: must be 1 to 1000")
    chosen.shards = chosen.shards or 0
    if not chosen.slurm and (chosen.partition or chosen.account):
        parser.error("--partition and --account are Slurm's; add --slurm")
    if any(word and not re.fullmatch(r"[A-Za-z0-9_.@-]+", word) for word in (chosen.partition, chosen.account)):
        parser.error("--partition and --account are names of letters, digits and _.@-")
    chosen.jobs = chosen.jobs or (SLURM_JOBS if chosen.slurm else max(1, chosen.shards))
    return chosen


def swept(chosen):
    sweep = read(chosen.sweep)
    refuse_if_many(sweep, chosen.yes)
    program = os.path.abspath(chosen.program)
    if not os.access(program, os.X_OK) or not os.path.isfile(program):
        raise Refused(f"{chosen.program}: is no program that can be run; `scripts/setup pipeline` builds it", 1)
    if not shutil.which("snakemake"):
        raise Refused("snakemake: is not installed; `scripts/peers sweep` installs it", 1)
    if chosen.slurm and not shutil.which("sbatch"):
        raise Refused("--slurm: there is no sbatch here; call it on a machine of the cluster, or leave it out", 1)
    folder = os.path.abspath(chosen.output or os.path.join("results", sweep.name))
    refuse_other(folder, chosen.output or os.path.join("results", sweep.name), sweep)
    with contextlib.ExitStack() as stack:
        if chosen.dry_run and not os.path.isdir(os.path.join(folder, ".sweep")):  # nothing is left behind
            work = stack.enter_context(tempfile.TemporaryDirectory())
        else:
            work = os.path.join(folder, ".sweep")
            os.makedirs(os.path.join(work, "checks"), exist_ok=True)
            os.makedirs(os.path.join(folder, "points"), exist_ok=True)
        lock = locked(stack, work, folder)
        job = Job(sweep, chosen, program, folder, work, lock)
        return job.dry_run() if chosen.dry_run else job.run()


def refuse_other(folder, said, sweep):
    """Raises Refused when the folder is not this sweep's."""
    if not os.path.lexists(folder):
        return
    if not os.path.isdir(folder):
        raise Refused(f"{said}: exists and is no folder; -o names another", 4)
    kept = read_json(os.path.join(folder, MANIFEST))
    if kept is None:
        if set(os.listdir(folder)) - {".sweep", "points"}:
            raise Refused(f"{said}: exists and is not the folder of a sweep; -o names another", 4)
        return
    if kept.get("sweep") != sweep.name or kept.get("parameters") != list(sweep.axes):
        over = ", ".join(map(str, kept.get("parameters") or [])) or "nothing"
        raise Refused(f"{said}: holds the sweep '{kept.get('sweep')}' over {over}, this is '{sweep.name}' over "
                      f"{', '.join(sweep.axes) or 'nothing'}; -o names another folder", 4)  # fmt: skip


def locked(stack, work, folder):
    """A descriptor that holds the folder for this sweep, and for the Snakemake that it starts, until they end."""
    path = os.path.join(work, "lock")
    file = stack.enter_context(open(path, "a+", encoding="utf-8"))
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        file.seek(0)
        who = " ".join(file.read().split()) or "unknown"
        raise Refused(
            f"{folder}: another sweep ({who}) is at work here; wait for its end, or name another -o", 4
        ) from None
    file.truncate(0)
    file.write(f"process {os.getpid()} on {socket.gethostname()}\n")
    file.flush()
    return file.fileno()


class Job:
    """One call of scripts/sweep: what there is, what is to be done, and doing it."""

    def __init__(self, sweep, chosen, program, folder, work, lock):
        self.sweep, self.chosen, self.program, self.folder, self.work, self.lock = (
            sweep,
            chosen,
            program,
            folder,
            work,
            lock,
        )
        self.points, self.log = points(sweep), os.path.join(work, "snakemake.log")
        program_sha, digests, configs = file_sha256(program), {}, {}
        self.identities, self.again = {}, {}
        for point in self.points:
            if point.config not in configs:
                configs[point.config] = file_sha256(point.config)
            now = identity("", "", point.sets, sweep.options) | {
                "configuration": configs[point.config],
                "program": program_sha,
            }
            self.identities[point.name] = now
            why = why_again(folder, point, now, [sweep.folder], digests)
            if why:
                self.again[point.name] = why
        self.plan = {
            # as scripts/python has it
            "python": f"env PYTHONPATH={shlex.quote(ABOVE)} {shlex.quote(sys.executable)} -P",
            "module": f"{PACKAGE}.sweep.point",
            "program": program,
            "folder": folder,
            "cwd": sweep.folder,
            "options": sweep.options,
            "threads": sweep.threads,
            "check": [],
            "run": [],
        }

    def checked(self):
        """name -> {memory_bytes, seconds, file_bytes} of what is to be run, or {exit_code, reason} of what cannot.
        Points that differ by their seed alone are asked about once. Raises Refused when a key of the sweep is none."""
        if self.sweep.memory_mb and self.sweep.minutes:
            return {name: {} for name in self.again}
        groups = {}
        for point in self.points:
            if point.name in self.again:
                others = {key: value for key, value in point.sets.items() if key != "seed"}
                now = self.identities[point.name] | {"settings": [others, self.sweep.options]}
                said = json.dumps([self.folder, now, self.inputs_of(point)])
                file = os.path.join(self.work, "checks", hashlib.sha256(said.encode()).hexdigest()[:32] + ".json")
                groups.setdefault(file, []).append(point)
        new = [file for file in groups if "seconds" not in (read_json(file) or {})]
        self.plan["check"] = [{"file": file, "points": [vars(point) for point in groups[file]]} for file in new]
        if new:
            os.makedirs(os.path.join(self.work, "checks"), exist_ok=True)
            if len(new) > 1:
                self.tell(f"{len(new)} settings are checked before they run")
            self.snakemake("checks", 1 if self.chosen.slurm else self.chosen.jobs)
        found = {}
        for file, members in groups.items():
            told = read_json(file)
            if told is None:
                raise Refused(
                    f"{self.chosen.sweep}: what its points take was not found out: {snakemake_error(self.log)}", 1
                )
            for point in members:
                bad = told["failed"].get(point.name)
                if bad and "unknown key '" in bad["reason"]:
                    raise Refused(f"{self.chosen.sweep}: {bad['reason'].removeprefix('--set ')}")
                found[point.name] = bad or {name: value for name, value in told.items() if name != "failed"}
        return found

    def inputs_of(self, point):
        """What the last run of a point read, as it is now: a check holds as long as that does."""
        kept = state(self.folder, point.name)
        return sorted((kept or {}).get("inputs", {}).items())

    # ---- What would be done

    def dry_run(self):
        found = self.checked()
        rows = [("point", "why", "memory", "processor time")]
        for name, why in self.again.items():
            told = found[name]
            if "reason" in told:
                rows.append((name, why, "", f"fails: {told['reason']}"))
            else:
                rows.append((name, why, memory_text(told), time_text(told.get("seconds"))))
        widths = [max(len(row[column]) for row in rows) for column in range(3)]
        lines = (
            ["  ".join(cell.ljust(width) for cell, width in zip(row, [*widths, 0])).rstrip() for row in rows]
            if self.again
            else []
        )
        known = [told for told in found.values() if "seconds" in told]
        lines.append(
            f"{len(self.points)} points, {len(self.points) - len(self.again)} are done, {len(self.again)} would run"
        )
        if known:
            seconds = [sum(told["seconds"][i] for told in known) for i in (0, 1)]
            size = sum(told["file_bytes"] for told in known)
            lines[-1] += (f": {time_text(seconds)} of processor time in all, {size / 2**20:,.0f} MiB of files in "
                          f"{self.folder}")
        say("\n".join(lines))
        return 0

    # ---- Doing it

    def run(self):
        began = time.monotonic()
        if not os.path.exists(os.path.join(self.folder, MANIFEST)):
            self.write_manifest({})  # the folder is this sweep's from now on
        found, reasons = self.checked(), {}
        named = {point.name: point for point in self.points}
        for name, told in found.items():
            if "reason" in told:  # not worth a job
                base = os.path.join(self.folder, "points", name)
                write_json(
                    base + ".json", self.fresh(named[name]) | told | {"status": "failed", "host": socket.gethostname()}
                )
                if os.path.exists(base + ".h5"):  # of another configuration
                    os.remove(base + ".h5")
        memory = machine_memory_mb()
        for name, told in found.items():
            if "reason" in told:
                continue
            wanted = self.sweep.memory_mb or (MORE_MEMORY * told.get("memory_bytes", 0) / 2**20 + MORE_MEMORY_MB)
            minutes = self.sweep.minutes or (MORE_TIME * told.get("seconds", [0, 0])[1] / 60 + MORE_MINUTES)
            memory_mb = math.ceil(wanted) if self.chosen.slurm else min(math.ceil(wanted), memory)
            self.plan["run"].append(self.fresh(named[name]) | {"memory_mb": memory_mb, "minutes": math.ceil(minutes)})
            with contextlib.suppress(FileNotFoundError):
                os.remove(os.path.join(self.folder, "points", name + ".json"))
        interrupted = False
        if self.plan["run"]:
            self.tell(
                f"{len(self.points)} points, {len(self.points) - len(self.again)} are done, "
                f"{len(self.plan['run'])} to run"
            )
            try:
                self.snakemake("points", self.chosen.jobs, progress=True)
            except KeyboardInterrupt:
                interrupted = True
            else_ = "the sweep was interrupted before it" if interrupted else snakemake_error(self.log)
            said = slurm_reasons(self.log)
            reasons = {entry["name"]: said.get(number, else_) for number, entry in enumerate(self.plan["run"])}
        self.write_manifest(reasons)
        tables.write(self.folder, self.manifest)
        bad = [entry for entry in self.manifest["points"] if entry["status"] != "done"]
        for entry in bad[:20]:
            complain(f"{entry['name']}: {entry['status']}: {entry['reason']}")
        if len(bad) > 20:
            complain(f"and {len(bad) - 20} more; {MANIFEST} has all")
        words = f"{len(self.points)} points: {len(self.points) - len(bad)} done, {len(bad)} not; "
        words += f"{len(self.again)} of them in {span(time.monotonic() - began)} now"
        say(f"{words}\n{os.path.join(self.folder, 'sweep.csv')}")
        if interrupted:
            raise KeyboardInterrupt
        return 1 if bad else 0

    def fresh(self, point):
        """What is known of a point before it runs."""
        return vars(point) | {"identity": self.identities[point.name]}

    def write_manifest(self, reasons):
        """reasons: name -> what the scheduler says of a point that has no last word of its own."""
        entries = []
        for point in self.points:
            kept, why = state(self.folder, point.name), reasons.get(point.name, "")
            if kept is None:
                kept = vars(point) | {"status": "missing", "reason": why or "has not run"}
            elif kept["status"] == "running":
                job = f", job {kept['job']}" if kept.get("job") else ""
                kept |= {
                    "status": "died",
                    "reason": f"{why or 'ended without a word'} (on {kept.get('node') or kept.get('host')}{job})",
                }
            elif kept["status"] == "stopped" and why.startswith("Slurm"):
                kept |= {"reason": f"{why}: {kept['reason']}"}
            entries.append(kept)
        self.manifest = {
            "sweep": self.sweep.name,
            "title": self.sweep.title,
            "parameters": list(self.sweep.axes),
            "program": self.program,
            "date": time.strftime("%Y-%m-%dT%H:%M:%S%z"),
            "points": entries,
        }
        write_json(os.path.join(self.folder, MANIFEST), self.manifest)

    def snakemake(self, target, jobs, progress=False):
        """Has Snakemake make `target`. What it says goes to a log; a point that it could not run has no state."""
        write_json(os.path.join(self.work, "plan.json"), self.plan | {"shards": self.chosen.shards})
        for name in ("checked", "ran"):
            shutil.rmtree(os.path.join(self.work, name), ignore_errors=True)
        snakefile = os.path.join(HERE, "Snakefile")
        command = ["snakemake", "--snakefile", snakefile, target, "--keep-going", "--nolock", "--ignore-incomplete",
                   "--rerun-triggers", "mtime", "--drop-metadata", "--scheduler", "greedy", "--nocolor"]  # fmt: skip
        if self.chosen.slurm and target == "points":
            names = [
                f"slurm_{name}={value}"
                for name, value in (("partition", self.chosen.partition), ("account", self.chosen.account))
                if value
            ]
            command += ["--slurm", "--jobs", str(jobs), "--max-status-checks-per-second", "1", "--latency-wait", "60"]
            command += ["--default-resources", *names] if names else []
        else:
            command += ["--cores", str(jobs), "--resources", f"mem_mb={machine_memory_mb()}"]
        environment = {"USER": getpass.getuser()} | os.environ  # Snakemake's Slurm needs it
        with open(self.log, "wb") as log:
            # In a session of its own, so that Ctrl-C reaches it once, through this process.
            told = {"stdin": subprocess.DEVNULL, "stdout": log, "stderr": subprocess.STDOUT}
            own = {"start_new_session": True, "pass_fds": [self.lock]}
            process = subprocess.Popen(command, cwd=self.work, env=environment, **told, **own)
            seen = set()
            try:
                while process.poll() is None:
                    time.sleep(0.2)
                    if progress:
                        self.tell_new(seen)
            except KeyboardInterrupt:
                os.killpg(process.pid, signal.SIGINT)
                process.wait()
                raise
        if progress:
            self.tell_new(seen)

    def tell_new(self, seen):
        try:
            there = set(os.listdir(os.path.join(self.work, "ran")))
        except FileNotFoundError:
            return
        for entry in sorted(name for name in there - seen if name.endswith(".motion")):
            seen.add(entry)
            name = self.plan["run"][int(entry.removesuffix(".motion"))]["name"]
            if (state(self.folder, name) or {}).get("status") == "running":
                self.tell(f"{name}: its motion is made, {self.chosen.shards} workers share the rest")
        for number in sorted(int(name) for name in there - seen if name.isdigit()):
            seen.add(str(number))
            name = self.plan["run"][number]["name"]
            kept = state(self.folder, name) or {}
            took = "" if kept.get("wall_time_s") is None else f", {span(kept['wall_time_s'])}"
            why = f": {kept['reason']}" if kept.get("reason") else ""
            done = sum(entry.isdigit() for entry in seen)
            self.tell(f"{done}/{len(self.plan['run'])}  {name}: {kept.get('status', '?')}{took}{why}")

    def tell(self, text):
        print(visible(text), file=sys.stderr, flush=True)


def slurm_reasons(log):
    """number of a point -> what Slurm said of its job, from Snakemake's log."""
    try:
        with open(log, encoding="utf-8", errors="replace") as file:
            text = file.read()
    except OSError:
        return {}
    found = {}
    for block in re.split(r"Error in rule (?:point|motion|work):", text)[1:]:
        number, status = re.search(r"output: ran/(\d+)", block), re.search(r"SLURM status is: '(\w+)'", block)
        if number and status:
            found.setdefault(int(number[1]), f"Slurm says {status[1]}")
    return found


def snakemake_error(log):
    """What stopped Snakemake as a whole, in its own words; else that it said nothing."""
    try:
        with open(log, encoding="utf-8", errors="replace") as file:
            lines = file.read().splitlines()
    except OSError:
        lines = []
    for number, line in enumerate(lines):
        if line.startswith(
            ("WorkflowError", "OSError", "PermissionError", "MissingInputException", "snakemake: error")
        ):
            return " ".join(" ".join(lines[number : number + 3]).split())
    return f"the scheduler did not run it; {log} is what it said"


def machine_memory_mb():
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2**20


def memory_text(told):
    return f"{told['memory_bytes'] / 2**20:,.0f} MiB" if "memory_bytes" in told else "?"


def time_text(seconds):
    return f"{span(seconds[0])} to {span(seconds[1])}" if seconds else "?"


def span(seconds):
    if seconds < 60:
        return f"{seconds:.2g} s" if seconds < 10 else f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


if __name__ == "__main__":
    sys.exit(main())
