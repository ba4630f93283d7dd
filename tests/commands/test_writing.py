"""What is written is whole and one's own, or it is told: killed runs, closed descriptors, links and files of others in
the way, locks, threads and disks that fail. Failures that cannot be had for real are made by a small library that is
loaded before the C library; without a C compiler those tests are skipped."""
import errno
import itertools
import json
import os
import random
import resource
import shutil
import signal
import stat
import subprocess
import sys

import h5py
import pytest
from program import DONE, FILE, INPUT, INTERRUPTED, PIPELINE, ROOT, digest, one_line, pipeline, start, wait_for

SMOKE = str(ROOT / "configs" / "smoke.toml")
BOX = ROOT / "tests" / "data" / "box.h5"
LONG = ["--set", "steps=300", "--set", "timing.repeats=3"]  # six chunks of every stage
SHORT = ["--set", "steps=3", "--set", "timing.repeats=1"]
SLOW = "facet_distance:prefilter=none@slow"  # seconds on SMOKE


def last_line(run):
    """The error of a run that may have said before that it resumes."""
    return run.stderr.strip().splitlines()[-1]


def names(folder):
    return sorted(entry.name for entry in folder.iterdir())


def killed_after(condition, *arguments):
    """Starts a run and kills it when the condition holds."""
    run = start(*arguments)
    wait_for(condition, run)
    run.kill()
    run.communicate()
    assert run.returncode == -signal.SIGKILL, "it was quicker than the kill"


@pytest.fixture(scope="module")
def long_digest(tmp_path_factory):
    path = tmp_path_factory.mktemp("long") / "long.h5"
    assert pipeline("run", SMOKE, "-o", path, *LONG).returncode == DONE
    return digest(path)


@pytest.fixture(scope="module")
def smoke(tmp_path_factory):
    path = tmp_path_factory.mktemp("smoke") / "smoke.h5"
    assert pipeline("run", SMOKE, "-o", path).returncode == DONE
    return path


# ---- closed descriptors


def closing(numbers, *command, **more):
    """Runs a command without some of the descriptors 0, 1 and 2; what it prints on the others is dropped."""
    words = " ".join(f"{number}>&-" if number in numbers else f"{number}{'<' if number == 0 else '>'}/dev/null"
                     for number in range(3))  # fmt: skip
    return subprocess.run(["sh", "-c", f'exec "$@" {words}', "sh", *map(str, command)], timeout=300, **more).returncode


CLOSED = [numbers for count in range(4) for numbers in itertools.combinations(range(3), count)]


@pytest.mark.parametrize("numbers", CLOSED, ids=lambda numbers: "closed" + "".join(map(str, numbers)))
def test_a_killed_run_resumes_whole_without_standard_descriptors(tmp_path, long_digest, numbers):
    """Until 29 November 2026 a run resumed with stderr closed ended with code 0 and a file that began with "resuming":
    the result had been opened as descriptor 2. Kills come at random moments."""
    seed = random.randrange(2**32)
    print("seed", seed)
    moments = random.Random(seed)
    path = tmp_path / "x.h5"
    for _ in range(2):
        run = start("run", SMOKE, "-o", path, *LONG)
        try:
            run.communicate(timeout=moments.uniform(0.02, 0.6))
        except subprocess.TimeoutExpired:
            run.kill()
            run.communicate()
    if path.exists():  # quicker than the kill
        path.unlink()
    code = closing(numbers, PIPELINE, "run", SMOKE, "-o", path, *LONG)
    assert code == (FILE if 1 in numbers else DONE)  # a lost summary is told
    assert digest(path) == long_digest
    assert pipeline("show", path).returncode == DONE
    assert names(tmp_path) == ["x.h5"]


@pytest.mark.parametrize("numbers", CLOSED[1:], ids=lambda numbers: "closed" + "".join(map(str, numbers)))
def test_other_commands_without_standard_descriptors(tmp_path, smoke, numbers):
    expected = FILE if 1 in numbers else DONE
    copy = shutil.copy(smoke, tmp_path / "x.h5")
    assert closing(numbers, PIPELINE, "detect", copy, "--algorithm", "obb_sat@again") == expected
    assert pipeline("show", copy).returncode == DONE
    assert closing(numbers, PIPELINE, "score", copy, "--against", tmp_path / "b.json", "--write") == expected
    assert json.loads((tmp_path / "b.json").read_text())["steps"] > 0
    assert closing(numbers, PIPELINE, "--version") == expected


def test_a_study_without_standard_descriptors(tmp_path):
    few = ["--set", "every=97", "--set", "budget.force_evaluations=2000"]
    study = ROOT / "configs" / "integrators.toml"
    for name, numbers in (("open.h5", ()), ("closed.h5", (0, 1, 2))):
        code = closing(numbers, PIPELINE, "run", study, "-o", tmp_path / name, *few)
        assert code == (FILE if numbers else DONE)
    with h5py.File(tmp_path / "open.h5") as a, h5py.File(tmp_path / "closed.h5") as b:
        assert list(a["study/status"].asstr()) == list(b["study/status"].asstr())
        assert (a["study/steps"][:] == b["study/steps"][:]).all()


@pytest.mark.parametrize("numbers", [(1,), (2,), (0, 1, 2)])
def test_a_page_without_standard_descriptors(tmp_path, smoke, numbers):
    page = tmp_path / "report.html"
    command = (sys.executable, "-m", "analysis", "report", smoke, "-o", page)
    code = closing(numbers, *command, cwd=ROOT)
    assert code == (FILE if 1 in numbers else DONE)
    text = page.read_text()
    assert text.lower().startswith("<!doctype") and text.rstrip().endswith("</html>")
    assert names(tmp_path) == ["report.html"]


def test_a_full_stdout_is_told_by_every_command(smoke):
    for command in ([PIPELINE, "--version"], [PIPELINE, "list", "scenes"],
                    [sys.executable, "-m", "analysis", "study", str(smoke)]):  # fmt: skip
        with open("/dev/full", "w") as full:
            run = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, cwd=ROOT)
        assert run.returncode == FILE, command
        assert one_line(run) == "stdout: cannot be written (No space left on device)"


def test_who_reads_enough_is_no_failure(smoke):
    """As in `scripts/analysis study FILE | head -1`: nothing is said."""
    command = [sys.executable, "-m", "analysis", "study", str(smoke)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT) as run:
        run.stdout.close()
        assert run.stderr.read() == ""
    assert run.returncode == 128 + signal.SIGPIPE


@pytest.mark.parametrize("force", [[], ["--force"]])
def test_a_pipe_at_the_place_of_the_result_is_called_no_regular_file(tmp_path, force):
    os.mkfifo(tmp_path / "x.h5")
    run = pipeline("run", SMOKE, "-o", tmp_path / "x.h5", *force)
    assert run.returncode == FILE
    assert one_line(run) == f"{tmp_path / 'x.h5'}: is not a regular file; choose another place"


# ---- kills, races


def test_a_killed_detect_leaves_nothing_after_the_next(tmp_path, smoke):
    path = shutil.copy(smoke, tmp_path / "x.h5")
    content = path.read_bytes()
    killed_after(lambda: len(names(tmp_path)) == 3, "detect", path, "--algorithm", SLOW)
    assert len(names(tmp_path)) == 3 and path.read_bytes() == content
    assert pipeline("detect", path, "--algorithm", "obb_sat@again").returncode == DONE
    assert names(tmp_path) == ["x.h5"]


def test_writers_that_race_end_with_one_whole_result(tmp_path, long_digest):
    path = tmp_path / "x.h5"
    for _ in range(3):
        runs = [start("run", SMOKE, "-o", path, *LONG) for _ in range(4)]
        errors = [run.communicate(timeout=300)[1] for run in runs]
        codes = [run.returncode for run in runs]
        assert DONE in codes and set(codes) <= {DONE, FILE}, errors
        for code, error in zip(codes, errors):
            assert code == DONE or "another run" in error or "exists" in error, error
        assert digest(path) == long_digest
        assert names(tmp_path) == ["x.h5"]
        path.unlink()


# ---- links and files of others in the way


def test_no_name_that_is_written_is_followed(tmp_path, smoke):
    """A link at each name that is, or ever was, predictable; what it leads to stays as it is."""
    precious = tmp_path / "precious"
    precious.write_text("precious")
    folder = tmp_path / "work"
    folder.mkdir()

    def links(*where):
        for name in where:
            (folder / name).symlink_to(precious)

    links(".r.h5.new", ".b.json.new", ".x.pvd.new", ".x_000000.vtp.new")
    assert pipeline("run", SMOKE, "-o", folder / "r.h5", *SHORT).returncode == DONE
    assert pipeline("detect", folder / "r.h5", "--algorithm", "obb_sat@again").returncode == DONE
    assert pipeline("score", folder / "r.h5", "--against", folder / "b.json", "--write").returncode == DONE
    shutil.copy(folder / "r.h5", folder / "x.h5")
    assert pipeline("export", folder / "x.h5", "--vtk", folder, "--force").returncode == DONE
    assert precious.read_text() == "precious"
    for name in ("x.pvd", "x_000001.vtp"):
        (folder / name).unlink()
        links(name)
        run = pipeline("export", folder / "x.h5", "--vtk", folder, "--force")
        assert run.returncode == FILE and name in last_line(run)
        (folder / name).unlink()
    links("r2.h5", ".r3.h5.lock", "r4.h5.part")
    for name, force in itertools.product(("r2.h5", "r3.h5", "r4.h5"), ([], ["--force"])):
        run = pipeline("run", SMOKE, "-o", folder / name, *SHORT, *force)
        assert run.returncode == FILE, (name, run.stderr)
    (folder / "r5.h5.part").symlink_to(tmp_path)  # a folder of another
    assert pipeline("run", SMOKE, "-o", folder / "r5.h5", *SHORT, "--force").returncode == FILE
    assert precious.read_text() == "precious" and names(tmp_path) == ["precious", "work"]


def test_no_name_of_a_chunk_is_followed(tmp_path, long_digest):
    path, part, precious = tmp_path / "x.h5", tmp_path / "x.h5.part", tmp_path / "precious"
    precious.write_text("precious")
    killed_after(lambda: (part / "truth-0000000").exists(), "run", SMOKE, "-o", path, *LONG)
    for name in ("truth-0000250.new", "answers-0000000.new", ".answers-0000050.new", "manifest.json.new", "complete"):
        (part / name).symlink_to(precious)
    run = pipeline("run", SMOKE, "-o", path, *LONG)
    assert run.returncode == DONE, run.stderr
    assert "cannot be removed" in last_line(run)  # they are not ours
    assert digest(path) == long_digest and precious.read_text() == "precious"
    (part / "answers-0000000").symlink_to(precious)
    path.unlink()
    shutil.rmtree(part)
    killed_after(lambda: (part / "truth-0000000").exists(), "run", SMOKE, "-o", path, *LONG)
    (part / "answers-0000100").symlink_to(precious)
    run = pipeline("run", SMOKE, "-o", path, *LONG)
    assert run.returncode == FILE and "answers-0000100: is a symbolic link" in last_line(run)
    assert precious.read_text() == "precious"


def test_a_result_swapped_while_it_is_made_never_becomes_the_result(tmp_path, long_digest):
    path, part = tmp_path / "x.h5", tmp_path / "x.h5.part"
    run = start("run", SMOKE, "-o", path, *LONG)
    wait_for(lambda: (part / "truth-0000000").exists(), run)
    (making,) = tmp_path.glob(".x.h5.*.new")
    making.unlink()
    shutil.copy(BOX, making)
    _, error = run.communicate(timeout=120)
    assert run.returncode == FILE and "another program put its file" in error
    assert not path.exists() and (part / "manifest.json").exists()
    again = pipeline("run", SMOKE, "-o", path, *LONG)
    assert again.returncode == DONE and digest(path) == long_digest
    assert names(tmp_path) == ["x.h5"]


@pytest.mark.parametrize("content", [{"lock": "", "diary.txt": "mine"}, {"lock": "7"},
                                     {"manifest.json": "{\"name\": \"web page\"}", "lock": ""}])  # fmt: skip
def test_a_folder_of_others_is_never_emptied(tmp_path, content):
    part = tmp_path / "x.h5.part"
    part.mkdir()
    for name, text in content.items():
        (part / name).write_text(text)
    for force in ([], ["--force"]):
        run = pipeline("run", SMOKE, "-o", tmp_path / "x.h5", *SHORT, *force)
        assert run.returncode == FILE, run.stderr
        assert str(part) in last_line(run)
        assert {name: (part / name).read_text() for name in names(part)} == content
    assert names(tmp_path) == ["x.h5.part"]


def test_a_chunk_under_another_steps_name_is_not_taken(tmp_path, long_digest):
    path, part = tmp_path / "x.h5", tmp_path / "x.h5.part"
    killed_after(lambda: (part / "answers-0000050").exists(), "run", SMOKE, "-o", path, *LONG)
    shutil.copy(part / "answers-0000000", part / "answers-0000050")
    run = pipeline("run", SMOKE, "-o", path, *LONG)
    assert run.returncode == DONE and "answers-0000050: is damaged" in last_line(run)
    assert digest(path) == long_digest


REPLAY = """steps = 1
[scene]
kind = "replay"
poses = "{poses}"
[[scene.body]]
name = "a"
mesh = "{mesh}"
"""


@pytest.mark.parametrize("mesh, poses, kind", [("/dev/zero", "p.csv", "a device"), ("pipe", "p.csv", "a pipe"),
                                               (".", "p.csv", "a folder"), ("m.obj", "pipe", "a pipe"),
                                               ("m.obj", "/dev/zero", "a device")])  # fmt: skip
def test_inputs_that_are_no_regular_files_are_refused_before_they_are_read(tmp_path, mesh, poses, kind):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "m.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "p.csv").write_text("step,body,px,py,pz,qw,qx,qy,qz\n0,a,0,0,0,1,0,0,0\n")
    config = tmp_path / "c.toml"
    config.write_text(REPLAY.format(mesh=mesh, poses=poses))
    run = pipeline("check", config)
    assert run.returncode == INPUT and f"is {kind}, not a regular file" in last_line(run)
    run = pipeline("check", tmp_path / "pipe")
    assert run.returncode == INPUT and "is a pipe, not a regular file" in last_line(run)


# ---- detect replaces its file and no other


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664])
def test_detect_keeps_the_mode_of_its_file(tmp_path, smoke, mode):
    path = shutil.copy(smoke, tmp_path / "x.h5")
    path.chmod(mode)
    assert pipeline("detect", path, "--algorithm", "obb_sat@again").returncode == DONE
    assert stat.S_IMODE(path.stat().st_mode) == mode


def test_detect_does_not_overwrite_a_result_that_was_replaced_meanwhile(tmp_path, smoke):
    path = shutil.copy(smoke, tmp_path / "x.h5")
    newer = shutil.copy(smoke, tmp_path.with_suffix(".newer"))
    run = start("detect", path, "--algorithm", SLOW)
    wait_for(lambda: len(names(tmp_path)) == 3, run)
    os.replace(newer, path)
    kept = path.stat().st_ino
    _, error = run.communicate(timeout=120)
    assert run.returncode == FILE and "again" in error
    assert "changed by another program meanwhile" in error  # after it was read, or while it was
    assert path.stat().st_ino == kept and names(tmp_path) == ["x.h5"]


# ---- what fails


SHIM = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int wanted(const char* call) { const char* w = getenv("FAIL"); return w && !strncmp(w, call, strlen(call)); }
static int error(void) { return atoi(strchr(getenv("FAIL"), '=') + 1); }
static int is(int fd, const char* part) {
  char link[64], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  ssize_t n = readlink(link, path, sizeof path - 1);
  if (n < 0) return 0;
  path[n] = 0;
  return strstr(path, part) != 0;
}
int flock(int fd, int how) {
  if (wanted("flock=")) { errno = error(); return -1; }
  return ((int (*)(int, int))dlsym(RTLD_NEXT, "flock"))(fd, how);
}
int pthread_create(pthread_t* t, const pthread_attr_t* a, void* (*f)(void*), void* x) {
  if (wanted("pthread_create=")) return error();
  int (*create)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*) = dlsym(RTLD_NEXT, "pthread_create");
  return create(t, a, f, x);
}
pid_t fork(void) {
  if (wanted("fork=")) { errno = error(); return -1; }
  return ((pid_t (*)(void))dlsym(RTLD_NEXT, "fork"))();
}
ssize_t read(int fd, void* to, size_t n) {
  if (wanted("read=") && is(fd, ".part/truth-")) { errno = error(); return -1; }
  return ((ssize_t (*)(int, void*, size_t))dlsym(RTLD_NEXT, "read"))(fd, to, n);
}
ssize_t pread(int fd, void* to, size_t n, off_t at) {
  if (wanted("pread=") && is(fd, ".x.h5.")) { errno = error(); return -1; }
  return ((ssize_t (*)(int, void*, size_t, off_t))dlsym(RTLD_NEXT, "pread"))(fd, to, n, at);
}
ssize_t write(int fd, const void* from, size_t n) {  /* a disk that keeps other bytes than it was given */
  ssize_t (*real)(int, const void*, size_t) = (ssize_t (*)(int, const void*, size_t))dlsym(RTLD_NEXT, "write");
  if (wanted("write=") && is(fd, ".x.h5.") && n > 100) {
    char* copy = malloc(n);
    memcpy(copy, from, n);
    copy[n / 2] ^= 1;
    n = real(fd, copy, n);
    free(copy);
    return n;
  }
  return real(fd, from, n);
}
int fsync(int fd) {
  if (wanted("fsync=") && is(fd, ".part/.truth-")) { errno = error(); return -1; }
  return ((int (*)(int))dlsym(RTLD_NEXT, "fsync"))(fd);
}
int rmdir(const char* path) {
  if (wanted("rmdir=") && strstr(path, ".part")) { errno = error(); return -1; }
  return ((int (*)(const char*))dlsym(RTLD_NEXT, "rmdir"))(path);
}
"""


@pytest.fixture(scope="module")
def failing(tmp_path_factory):
    """call, errno -> the environment in which that call fails so."""
    folder = tmp_path_factory.mktemp("shim")
    (folder / "shim.c").write_text(SHIM)
    try:
        subprocess.run(["cc", "-shared", "-fPIC", "-o", folder / "shim.so", folder / "shim.c", "-ldl"], check=True)
    except FileNotFoundError:
        pytest.skip("no C compiler here: calls cannot be made to fail")
    return lambda call, error: os.environ | {"LD_PRELOAD": str(folder / "shim.so"), "FAIL": f"{call}={int(error)}"}


@pytest.mark.parametrize("number", [errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS], ids=errno.errorcode.get)
def test_a_lock_that_cannot_be_had_is_not_another_run(tmp_path, failing, smoke, number):
    env = failing("flock", number)
    output = tmp_path / "a" / "b" / "x.h5"
    copy = shutil.copy(smoke, tmp_path / "copy.h5")
    for command in (["run", SMOKE, "-o", output, *SHORT], ["detect", copy, "--algorithm", "obb_sat@again"],
                    ["score", copy, "--against", tmp_path / "b.json", "--write"],
                    ["export", copy, "--vtk", tmp_path / "vtk", "--steps", ":2"]):  # fmt: skip
        run = pipeline(*command, env=env)
        assert run.returncode == FILE, (command, run.stderr)
        line = last_line(run)
        assert "cannot be locked" in line and os.strerror(number) in line and "another run" not in line
        assert names(tmp_path) == ["copy.h5"], "nor anything left of a run that failed at once"


def test_threads_and_children_that_cannot_start_are_told(tmp_path, failing):
    output = tmp_path / "x.h5"
    run = pipeline("run", SMOKE, "-o", output, *LONG, "--threads", "4", env=failing("pthread_create", errno.EAGAIN))
    assert run.returncode == FILE
    assert "threads: only 1 of 4 could start (Resource temporarily unavailable); give fewer" in last_line(run)
    assert pipeline("run", SMOKE, "-o", output, *LONG, "--threads", "2").returncode == DONE, "it resumes"
    study = ["run", ROOT / "configs" / "integrators.toml", "-o", tmp_path / "s.h5", "--set", "every=97"]
    run = pipeline(*study, env=failing("fork", errno.EAGAIN))
    assert run.returncode == FILE and "cannot start (Resource temporarily unavailable)" in last_line(run)
    assert names(tmp_path) == ["x.h5"]


def test_disks_that_fail_are_told_with_the_place(tmp_path, failing, long_digest):
    path, part = tmp_path / "x.h5", tmp_path / "x.h5.part"
    run = pipeline("run", SMOKE, "-o", path, *LONG, env=failing("fsync", errno.EIO))
    assert run.returncode == FILE and "x.h5.part/truth-0" in last_line(run) and "Input/output error" in run.stderr
    killed_after(lambda: (part / "truth-0000000").exists(), "run", SMOKE, "-o", path, *LONG)
    run = pipeline("run", SMOKE, "-o", path, *LONG, env=failing("read", errno.EIO))
    assert run.returncode == FILE and "truth-0000000: cannot be read (Input/output error)" in last_line(run)
    for call in ("pread", "write"):
        run = pipeline("run", SMOKE, "-o", path, *LONG, env=failing(call, errno.EIO))
        assert run.returncode == FILE, run.stderr
        assert f"{path}: " in last_line(run) and not path.exists()
        assert (part / "answers-0000250").exists(), "nothing is lost"
    assert pipeline("run", SMOKE, "-o", path, *LONG).returncode == DONE
    assert digest(path) == long_digest and names(tmp_path) == ["x.h5"]


def test_too_little_memory_is_not_damage():
    """It was "is damaged: HDF5 could not read /algorithm (memory allocation failed for chunk)"."""
    path = ROOT / "tests" / "data" / "falling.h5"

    def within(kibibytes, *arguments):
        return pipeline(*arguments, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (kibibytes << 10,) * 2))

    def least(*arguments):
        low, high = 0, 4 << 20
        assert within(high, *arguments).returncode == DONE
        while high - low > 64:
            middle = (low + high) // 2
            low, high = (low, middle) if within(middle, *arguments).returncode == DONE else (middle, high)
        return high

    start, enough = least("--version"), least("show", path)
    told = 0
    for limit in range(start, enough, max(64, (enough - start) // 40)):
        run = within(limit, "show", path)
        assert "damaged" not in run.stderr and "not an HDF5" not in run.stderr, run.stderr
        told += run.returncode == FILE and "needs more memory than there is" in run.stderr
    assert told > 0


def test_a_chunk_that_is_a_folder_is_told(tmp_path):
    path, part = tmp_path / "x.h5", tmp_path / "x.h5.part"
    killed_after(lambda: (part / "motion-0000000").exists(), "run", SMOKE, "-o", path, *LONG)
    (part / "truth-0000250").mkdir()
    run = pipeline("run", SMOKE, "-o", path, *LONG)
    assert run.returncode == FILE and "truth-0000250: is a folder" in last_line(run)


def test_a_part_that_cannot_be_removed_is_said(tmp_path, failing):
    path = tmp_path / "x.h5"
    run = pipeline("run", SMOKE, "-o", path, *SHORT, env=failing("rmdir", errno.EBUSY))
    assert run.returncode == DONE
    assert "x.h5.part: cannot be removed (Device or resource busy)" in last_line(run)
    assert pipeline("show", path).returncode == DONE
    path.unlink()
    (tmp_path / "x.h5.part").rmdir()
    run = start("run", SMOKE, "-o", path, *LONG)
    wait_for(lambda: (tmp_path / "x.h5.part" / "motion-0000000").exists(), run)
    (tmp_path / "x.h5.part" / "notes.txt").write_text("mine")
    _, error = run.communicate(timeout=120)
    assert run.returncode == DONE and "notes.txt is in it" in error
    assert names(tmp_path / "x.h5.part") == ["notes.txt"]


def test_a_run_that_fails_at_once_leaves_no_folders(tmp_path):
    def tiny_files():
        resource.setrlimit(resource.RLIMIT_FSIZE, (10, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))

    run = pipeline("run", SMOKE, "-o", tmp_path / "a" / "b" / "c" / "x.h5", *SHORT, preexec_fn=tiny_files)
    assert run.returncode == FILE
    assert names(tmp_path) == []
    run = start("run", SMOKE, "-o", tmp_path / "a" / "b" / "x.h5", "--set", "steps=100000")
    wait_for(lambda: (tmp_path / "a" / "b" / "x.h5.part" / "manifest.json").exists(), run)
    run.send_signal(signal.SIGINT)  # before a first chunk there is nothing to resume
    run.communicate(timeout=60)
    assert run.returncode == INTERRUPTED
    assert names(tmp_path) == [] or list(tmp_path.glob("a/b/x.h5.part/motion-*"))


def test_a_page_is_written_under_a_name_of_its_own(tmp_path, smoke):
    page, precious = tmp_path / "report.html", tmp_path / "precious"
    precious.write_text("precious")
    page.write_text("<!doctype html>old")
    page.chmod(0o600)
    code = "import os, sys; from analysis.output import write; " \
           "os.symlink(sys.argv[2], f'{sys.argv[1]}.{os.getpid()}.part'); write(sys.argv[1], '<!doctype html>new')"
    subprocess.run([sys.executable, "-c", code, page, precious], check=True, cwd=ROOT)
    assert page.read_text() == "<!doctype html>new" and precious.read_text() == "precious"
    assert stat.S_IMODE(page.stat().st_mode) == 0o600
