#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Cycles that the control loop misses, next to those that the kernel misses in the same minutes.

    tests/benchmark/loop_misses.py [--seconds 605] [--loads idle,core,disk,build]

For each load: a session (condition C) of SECONDS, next to `cyclictest -p90 -i1000` with one thread on each core (package
rt-tests). Late is what comes more than 1 ms after it was due: a sample of the rig, the motor command that answers a
sample, and a wake-up of cyclictest's (the larger count of its threads). Where the threads of all cores are late in the
same 10 ms, the machine itself stood still; these wake-ups are counted apart. `cycles` and `deadlines` are the sums of
what all readers of all topics counted themselves: one standstill of 10 ms makes some hundred. The loads:

  idle    nothing else
  core    one endless loop
  disk    files of 64 MB, written and synced without a pause
  build   one compiler after the other, at most two at a time
"""
import argparse
import bisect
import contextlib
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", SOURCE / "build"))
sys.path.insert(0, str(SOURCE / "tests" / "integration"))

from lab_process import loose_settings, next_domain  # noqa: E402

LATE_US = 1000
NEAR_CYCLES = 10
COMPILE = ("while :; do for n in 1 2; do echo '#include <bits/stdc++.h>' | c++ -std=c++20 -O2 -x c++ -c -o /dev/null - & "
           "done; wait; done")
LOADS = {"idle": None, "core": "while :; do :; done",
         "disk": "while :; do dd if=/dev/zero of=load bs=1M count=64 conv=fsync status=none; done", "build": COMPILE}


@contextlib.contextmanager
def load(name, folder):
    if LOADS[name] is None:
        yield
        return
    process = subprocess.Popen(["bash", "-c", LOADS[name]], cwd=folder, start_new_session=True)
    try:
        yield
    finally:
        os.killpg(process.pid, 9)
        process.wait()


def late_cycles(path):
    """Cycles of each thread that woke more than 1 ms late, [[cycle, ...], ...]."""
    threads = {}
    with open(path, encoding="utf-8") as lines:
        for line in lines:
            found = re.match(r"\s*(\d+):\s*(\d+):\s*(\d+)", line)
            if found:
                thread, cycle, late_us = (int(word) for word in found.groups())
                threads.setdefault(thread, [])
                if late_us > LATE_US:
                    threads[thread].append(cycle)
    return list(threads.values())


def standstills(threads):
    """Late cycles of the first thread near which every other thread was late too."""
    def near(cycles, cycle):
        place = bisect.bisect_left(cycles, cycle - NEAR_CYCLES)
        return place < len(cycles) and cycles[place] <= cycle + NEAR_CYCLES
    return [cycle for cycle in threads[0] if all(near(others, cycle) for others in threads[1:])] if threads else []


def measure(name, seconds):
    with tempfile.TemporaryDirectory(prefix="stillhand-") as scratch, load(name, scratch):
        folder = pathlib.Path(scratch)
        clock = subprocess.Popen(["cyclictest", "-p90", "-i1000", "-d0", "-m", "-a", f"-t{os.cpu_count()}", "-v"],
                                 stdout=open(folder / "clock", "w", encoding="utf-8"), stderr=subprocess.DEVNULL)
        try:
            done = subprocess.run([BUILD / "bin" / "stillhand", "lab", "--conditions", "C", "--identify-seconds", "5",
                                   "--trial-seconds", str(seconds), "--seed", "2", "--headless", "--domain",
                                   str(next_domain()), "--config", loose_settings(folder / "config"), "--out",
                                   folder / "session"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                                  check=False)
        finally:
            clock.terminate()
            clock.wait()
        threads = late_cycles(folder / "clock")
        still = standstills(threads)
        kernel = max((len(thread) for thread in threads), default=0)
        if not (folder / "session" / "summary.json").exists():
            print(f"{name:8} the session failed: {done.stderr.strip().splitlines()[-1:]}; cyclictest {kernel} late, "
                  f"{len(still)} of them on all cores at once")
            return
        summary = json.loads((folder / "session" / "summary.json").read_text())
        trial = summary["trials"][-1]
        loop = json.loads(subprocess.check_output([BUILD / "tests" / "loop_stamps", folder / "session" / "session.mcap"]))
        late = loop["late"]
        print(f"{name:8} {late['samples']:8} {late['commands']:9} {kernel:11} {len(still):12} {trial['cycle_misses']:8} "
              f"{trial['deadline_misses']:10} {trial['lost_ticks']:6} {100 * loop['same_cycle_share']:10.2f}   "
              f"{trial['aborted'] or 'completed'}", flush=True)


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--seconds", type=int, default=605,
                       help="of each load [605: not with every length the target stays on the screen]")
    words.add_argument("--loads", default=",".join(LOADS))
    options = words.parse_args()
    print(f"{options.seconds} s for each load, {os.cpu_count()} cores, kernel {os.uname().release}")
    print(f"{'late:':8} {'samples':>8} {'commands':>9} {'cyclictest':>11} {'standstills':>12} {'cycles':>8} {'deadlines':>10} "
          f"{'lost':>6} {'same tick':>10}")
    for name in options.loads.split(","):
        measure(name, options.seconds)


if __name__ == "__main__":
    sys.exit(main())
