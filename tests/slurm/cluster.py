"""A Slurm cluster of this machine alone, for a test: munged, slurmctld and slurmds in a scratch folder."""

import contextlib
import grp
import os
import pathlib
import pwd
import secrets
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "scancel", "scontrol", "snakemake")
CONFIGURATION = """ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket,cred_expire=5
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=2,bf_interval=2
SlurmdParameters=config_overrides
ReturnToService=1
MinJobAge=3600
KillWait=5
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd-%n.log
NodeName={nodes} NodeHostname={host} NodeAddr=127.0.0.1 Port={ports} CPUs=1 RealMemory=4000
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


class NoCluster(Exception):
    """None starts here, which is no fault of what would be tried on it: a container may forbid what it needs."""


def missing():
    """The programs that a cluster needs and that are not here."""
    path = os.environ["PATH"] + ":/usr/sbin:/sbin"
    return [program for program in PROGRAMS if not shutil.which(program, path=path)]


@contextlib.contextmanager
def cluster(folder, nodes=2):
    """Starts it and gives the environment in which Slurm's commands reach it; ends its own processes, by their ids."""
    folder, user = pathlib.Path(folder), pwd.getpwuid(os.getuid()).pw_name
    environment = os.environ | {"SLURM_CONF": str(folder / "slurm.conf"), "USER": user}
    environment["PATH"] += ":/usr/sbin:/sbin"
    names = [f"n{number}" for number in range(1, nodes + 1)]
    for name in ("munge", "state", *(f"spool-{name}" for name in names)):
        (folder / name).mkdir()
    controller, *ports = free_ports(nodes + 1)
    (folder / "slurm.conf").write_text(CONFIGURATION.format(
        host=socket.gethostname(), user=user, folder=folder, controller=controller, nodes=",".join(names),
        ports=",".join(map(str, ports))))  # fmt: skip
    started = []

    def start(*command, **more):
        with open(folder / f"{pathlib.Path(command[0]).name}-{len(started)}.out", "wb") as out:
            started.append(
                subprocess.Popen(command, env=environment, stdin=subprocess.DEVNULL, stdout=out, stderr=out, **more)
            )

    try:
        try:
            start_munge(folder / "munge", start)
            start("slurmctld", "-D")
            for name in names:
                start("slurmd", "-D", "-N", name)
            until(lambda: states(environment) == dict.fromkeys(names, "IDLE"), 60,
                  lambda: f"nodes are {states(environment)}")
        except (AssertionError, OSError, KeyError) as error:
            raise NoCluster(str(error)) from error
        yield environment
    finally:
        end_jobs(environment)
        for process in reversed(started):
            process.terminate()
        for process in started:
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        for number in strays(environment["SLURM_CONF"]):
            with contextlib.suppress(ProcessLookupError):
                os.kill(number, signal.SIGKILL)


def strays(configuration):
    """Ids of this cluster's processes that are left: of a job whose node went down proctrack/linuxproc loses some,
    where a real cluster has control groups."""
    wanted, found = f"SLURM_CONF={configuration}".encode(), []
    for path in pathlib.Path("/proc").glob("[0-9]*/environ"):
        with contextlib.suppress(OSError):
            if wanted in path.read_bytes().split(b"\0") and int(path.parent.name) != os.getpid():
                found.append(int(path.parent.name))
    return found


def end_jobs(environment):
    """What slurmd started would outlive it."""
    subprocess.run(["scancel", "--user", environment["USER"]], env=environment, capture_output=True)
    end = time.monotonic() + 30
    while time.monotonic() < end:
        left = subprocess.run(["squeue", "--noheader"], env=environment, capture_output=True, text=True)
        if left.returncode or not left.stdout.strip():
            return
        time.sleep(0.2)


def start_munge(folder, start):
    """Munge refuses keys and folders that others could write to; as root it runs as its own user."""
    who = {}
    (folder / "key").write_bytes(secrets.token_bytes(1024))
    (folder / "key").chmod(0o400)
    folder.chmod(0o755)
    if os.getuid() == 0:
        who = {"user": pwd.getpwnam("munge").pw_uid, "group": grp.getgrnam("munge").gr_gid, "extra_groups": []}
        for path in (folder, folder / "key"):
            os.chown(path, who["user"], who["group"])
    files = [f"--{name}-file={folder / name}" for name in ("key", "pid", "log", "seed")]
    start("munged", "--foreground", f"--socket={folder / 'socket'}", *files, **who)
    until((folder / "socket").exists, 20, lambda: "munged made no socket")


def states(environment):
    """node -> its state."""
    done = subprocess.run(["scontrol", "show", "node", "--oneliner"], env=environment, capture_output=True, text=True)
    words = [dict(word.split("=", 1) for word in line.split() if "=" in word) for line in done.stdout.splitlines()]
    return {found["NodeName"]: found["State"] for found in words if "NodeName" in found}


def free_ports(count):
    held = [socket.socket() for _ in range(count)]
    for one in held:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in held]
    for one in held:
        one.close()
    return ports


def until(holds, seconds, told):
    """Waits until holds() is true and returns it; AssertionError with told() after `seconds`."""
    end = time.monotonic() + seconds
    while not (found := holds()):
        assert time.monotonic() < end, f"waited {seconds} s: {told()}"
        time.sleep(0.2)
    return found
