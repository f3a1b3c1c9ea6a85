# SPDX-License-Identifier: Apache-2.0
"""Whether `stillhand misses --why` names why a process was late: ten causes, known from outside.

Usage: STILLHAND_BUILD=build /usr/bin/python3 tests/faults/causes.py [--only CAUSE]

Needs root, for the kernel's trace of its switches, for real-time priority and for control groups of version 1, and a
machine without other work. A session each: four minutes.
"""
import argparse
import ctypes
import json
import os
import pathlib
import re
import select
import signal
import subprocess
import sys
import tempfile

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "integration"), str(TESTS / "support")]

from inject import control_thread  # noqa: E402
from lab_process import BUILD, LabProcess, hold, quick_session, running  # noqa: E402

STANDS_S = 0.08
SEEN_S = 2.0
WORK, WRITE, READ_PAGES, READ = (signal.SIGRTMIN + number for number in (8, 9, 10, 11))  # busy_on_signal.cpp
MAPPED_BYTES = 1 << 28
GROUPS = pathlib.Path("/sys/fs/cgroup")
LIBC = ctypes.CDLL(None, use_errno=True)
PTRACE_SEIZE, PTRACE_INTERRUPT, PTRACE_DETACH = 0x4206, 0x4207, 17
HOG = """import ctypes, os, sys, time
ctypes.CDLL(None).prctl(15, b"compiler", 0, 0, 0)
os.sched_setaffinity(0, {0})
time.sleep(0.01)  # the trace takes the name when it comes back
end = time.monotonic() + float(sys.argv[1])
while time.monotonic() < end: pass
"""


def keep_away(lab):
    """All threads of a session on the second processor: what strikes the first one strikes the victim alone."""
    for pid in running(lab.domain):
        for task in pathlib.Path(f"/proc/{pid}/task").iterdir():
            os.sched_setaffinity(int(task.name), {1})


class Victim:
    def __init__(self, lab, service):
        self.pid = lab.pid_of(service)
        self.thread = control_thread(self.pid, service)
        os.sched_setaffinity(self.thread, {0})


def hog(priority):
    return subprocess.Popen(["chrt", "-f", str(priority), sys.executable, "-c", HOG, str(STANDS_S)])


def stop(victim, _other):
    os.kill(victim.pid, signal.SIGSTOP)
    hold(STANDS_S)
    os.kill(victim.pid, signal.SIGCONT)


def debugger(victim, _other):
    LIBC.ptrace(PTRACE_SEIZE, victim.thread, None, None)
    LIBC.ptrace(PTRACE_INTERRUPT, victim.thread, None, None)
    os.waitpid(victim.thread, 0x40000000)  # __WALL
    hold(STANDS_S)
    LIBC.ptrace(PTRACE_DETACH, victim.thread, None, None)


def real_time_program(_victim, _other):
    hog(priority=60).wait()


def tgkill(thread, pid, number):
    if LIBC.tgkill(pid, thread, number) != 0:
        raise OSError(ctypes.get_errno(), f"no thread {thread}")


def work(victim, _other):
    tgkill(victim.thread, victim.pid, WORK)


def our_own(_victim, other):
    os.sched_setscheduler(other.thread, os.SCHED_FIFO, os.sched_param(60))
    tgkill(other.thread, other.pid, WORK)
    hold(2 * STANDS_S)
    os.sched_setscheduler(other.thread, os.SCHED_OTHER, os.sched_param(0))


def written(victim, _other):
    """A pipe that nobody reads meanwhile."""
    pipe = os.open(os.environ["STILLHAND_PIPE"], os.O_RDWR | os.O_NONBLOCK)
    tgkill(victim.thread, victim.pid, WRITE)
    hold(STANDS_S)
    left = 1 << 20
    while left > 0:
        select.select([pipe], [], [])
        left -= len(os.read(pipe, left))
    os.close(pipe)


def pages(victim, _other):
    """A file that is mapped, and on the disk alone."""
    with open(os.environ["STILLHAND_MAPS"], "rb") as file:
        os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)
    tgkill(victim.thread, victim.pid, READ_PAGES)
    hold(2 * STANDS_S)


def unanswered(victim, _other):
    """A pipe into which nobody writes meanwhile."""
    pipe = os.open(os.environ["STILLHAND_PIPE"], os.O_RDWR)
    tgkill(victim.thread, victim.pid, READ)
    hold(STANDS_S)
    os.write(pipe, b".")
    hold(STANDS_S)
    os.close(pipe)


class Group:
    def __init__(self, kind):
        self.folder = GROUPS / kind / "stillhand-causes"
        self.folder.mkdir(exist_ok=True)

    def join(self, pid):
        (self.folder / "cgroup.procs").write_text(str(pid))

    def set(self, file, value):
        (self.folder / file).write_text(str(value))

    def leave(self, pid):
        (self.folder.parent / "cgroup.procs").write_text(str(pid))
        self.folder.rmdir()


def quota(victim, _other):
    group = Group("cpu")
    group.set("cpu.cfs_period_us", 200000)
    group.set("cpu.cfs_quota_us", 2000)
    group.join(victim.pid)
    hold(STANDS_S)
    group.leave(victim.pid)


def frozen(victim, _other):
    group = Group("freezer")
    group.join(victim.pid)
    group.set("freezer.state", "FROZEN")
    hold(STANDS_S)
    group.set("freezer.state", "THAWED")
    group.leave(victim.pid)


CAUSES = [(stop, "^stopped by a signal"), (debugger, "^stopped by a debugger"),
          (real_time_program, "waited .*; compiler had it"),
          (work, "^worked for"), (our_own, "waited .*; stillhand-cance had it"), (quota, "quota of processor time"),
          (frozen, "freezer"), (written, r"^blocked in write\(\)"), (unanswered, r"^blocked in read\(\)"),
          (pages, "pages of memory from a disk")]


def prepare(folder):
    """The files of written(), unanswered() and pages()."""
    os.environ["STILLHAND_PIPE"] = str(folder / "pipe")
    os.mkfifo(folder / "pipe")
    os.environ["STILLHAND_MAPS"] = str(folder / "mapped")
    with (folder / "mapped").open("wb") as file:
        for _ in range(MAPPED_BYTES >> 20):
            file.write(bytes(1 << 20))
        os.fsync(file.fileno())


def struck(cause, folder):
    """The longest lateness of sensing in a session in which the cause strikes it: (milliseconds, what is said of it)."""
    lab = LabProcess(folder / "run", *quick_session(folder / "config"), "--no-real-time", "--trace-switches",
                     environment=dict(os.environ, LD_PRELOAD=str(BUILD / "tests" / "libbusy_on_signal.so")))
    try:
        lab.wait_for_tick(1, 2, 60)
        keep_away(lab)
        victim, other = Victim(lab, "sensing"), Victim(lab, "cancellation")
        cause(victim, other)
        hold(SEEN_S)
        if lab.process.poll() is None:
            lab.interrupt()
        lab.end_status(60)
    finally:
        lab.close()
    listed = folder / "misses.json"
    subprocess.run([str(BUILD / "bin" / "stillhand"), "misses", str(folder / "run" / "session.mcap"), "--json",
                    str(listed)], check=True, stdout=subprocess.DEVNULL)
    misses = [each for each in json.loads(listed.read_text()) if each["process"] == "sensing" and each["trial"] == 1]
    longest = max(misses, key=lambda each: each["gap_ms"], default={"gap_ms": 0.0, "why": None})
    return longest["gap_ms"], longest["why"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", choices=[cause.__name__ for cause, _ in CAUSES], help="one cause")
    options = parser.parse_args()
    for cause, words in CAUSES:
        if options.only not in (None, cause.__name__):
            continue
        with tempfile.TemporaryDirectory(prefix="stillhand-") as name:
            prepare(pathlib.Path(name))
            gap_ms, why = struck(cause, pathlib.Path(name))
        verdict = "not known" if not why else "right" if re.search(words, why) else "WRONG"
        print(f"{cause.__name__:18} {gap_ms:6.1f} ms  {verdict:9} {why or ''}", flush=True)


if __name__ == "__main__":
    main()
