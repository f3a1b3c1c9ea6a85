#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Allocations, locks and system calls of the control loop's processes, for each sample.

    tests/benchmark/loop_calls.py [--seconds 10]

Runs a session (condition C) with a library preloaded that counts allocations and locks by who asks for them: the
program's own code or a library (tests/support/count_calls.cpp). During the trial it reads the counts twice, SECONDS
apart, and meanwhile counts system calls with `perf stat` (package linux-perf, as root; without it, that column is
empty). Prints one row for each process. The counts hold all threads: also the ten reports a second.
"""
import argparse
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", SOURCE / "build"))
sys.path.insert(0, str(SOURCE / "tests" / "integration"))

from lab_process import LabProcess, TRIAL_LIMIT_S, quick_session  # noqa: E402

PROCESSES = ("rig", "sensing", "cancellation")
NAMES = ("futex", "sendto", "recvfrom", "setsockopt", "gettid", "clock_nanosleep")
EVENTS = ",".join(["raw_syscalls:sys_enter", *(f"syscalls:sys_enter_{name}" for name in NAMES)])
TICKS_PER_S = 1000.0


def counts(folder, process):
    return struct.unpack("4Q", (folder / f"stillhand-{process}").read_bytes())


def system_calls(text):
    """{name: calls} of `perf stat -x,`."""
    found = {}
    for line in text.splitlines():
        fields = line.split(",")
        if len(fields) > 2 and "sys_enter" in fields[2] and fields[0].isdigit():
            found[fields[2].split(":")[1].removeprefix("sys_enter").lstrip("_") or "all"] = int(fields[0])
    return found


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--seconds", type=float, default=10.0)
    options = words.parse_args()
    perf = shutil.which("perf")
    with tempfile.TemporaryDirectory(prefix="stillhand-") as scratch:
        folder = pathlib.Path(scratch) / "counts"
        folder.mkdir()
        lab = LabProcess(pathlib.Path(scratch) / "session", *quick_session(pathlib.Path(scratch) / "config"),
                         environment={**os.environ, "LD_PRELOAD": str(BUILD / "tests" / "libcount_calls.so"),
                                                     "STILLHAND_COUNTS": str(folder)})
        try:
            lab.wait_for_tick(1, 1.0, TRIAL_LIMIT_S)
            pids = {process: lab.pid_of(process) for process in PROCESSES}
            traces = {}
            if perf:
                for process in PROCESSES:
                    traces[process] = subprocess.Popen(
                        [perf, "stat", "-x,", "-e", EVENTS, "-p", str(pids[process]), "--", "sleep",
                         str(options.seconds)],
                        stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
            first, begin = {name: counts(folder, name) for name in PROCESSES}, time.monotonic()
            texts = {process: trace.communicate()[1] for process, trace in traces.items()}
            time.sleep(max(0.0, begin + options.seconds - time.monotonic()))
            last, end = {name: counts(folder, name) for name in PROCESSES}, time.monotonic()
            if lab.process.poll() is not None:
                raise RuntimeError(f"the session ended meanwhile: {lab.errors()}")
        finally:
            lab.close()
    samples = (end - begin) * TICKS_PER_S
    print(f"{'process':14} {'allocations':>23} {'locks':>23} {'system calls':>13}   a sample")
    print(f"{'':14} {'own code':>11} {'libraries':>11} {'own code':>11} {'libraries':>11}")
    for name in PROCESSES:
        a_sample = [(after - before) / samples for before, after in zip(first[name], last[name])]
        calls = system_calls(texts.get(name, ""))
        per = TICKS_PER_S * options.seconds
        most = ", ".join(f"{call} {calls[call] / per:.2f}" for call in NAMES if calls.get(call, 0) > 0.005 * per)
        print(f"{name:14} " + " ".join(f"{value:11.3f}" for value in a_sample)
              + f" {calls.get('all', 0) / per:13.2f}   {most}")


if __name__ == "__main__":
    sys.exit(main())
