#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a test; runs it once more when it failed while the machine itself stood still.

Usage: again_after_standstill.py COMMAND [ARGUMENT]...

A virtual machine can lose its processors for tenths of a second. A life sign that lasts 0.3 s is then lost, and a
session under test ends as it must. A clock of its own on each core measures such standstills, whatever the test does.
Without one, a failure counts at once. Each run's reason is printed, and the second run counts.
"""
import os
import subprocess
import sys
import threading
import time

TICK_S = 0.01
# No load that was tried (four busy processes on two cores and a full disk queue) delays the clocks by as much.
STANDSTILL_S = 0.1
CTEST_SKIPPED = 77


class Clock(threading.Thread):
    """Measures the longest time between two ticks on one core [s]."""

    def __init__(self, core):
        super().__init__(daemon=True)
        self.core = core
        self.longest_s = 0.0
        self.ended = threading.Event()

    def run(self):
        os.sched_setaffinity(0, {self.core})
        before = time.monotonic()
        while not self.ended.wait(TICK_S):
            now = time.monotonic()
            self.longest_s = max(self.longest_s, now - before - TICK_S)
            before = now


def main():
    command = sys.argv[1:]
    if not command or command[0] in ("-h", "--help"):
        print(__doc__)
        return 0 if command else 2
    clocks = [Clock(core) for core in sorted(os.sched_getaffinity(0))]
    for clock in clocks:
        clock.start()
    status = subprocess.run(command, check=False).returncode
    for clock in clocks:
        clock.ended.set()
        clock.join()
    longest_s = max(clock.longest_s for clock in clocks)
    if status in (0, CTEST_SKIPPED) or longest_s < STANDSTILL_S:
        return status
    print(f"run 1 failed with status {status}; the machine stood still for {longest_s:.2f} s meanwhile: again",
          flush=True)
    status = subprocess.run(command, check=False).returncode
    print(f"run 2 ended with status {status}", flush=True)
    return status


if __name__ == "__main__":
    sys.exit(main())
