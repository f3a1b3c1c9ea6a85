#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Time and memory of `stillhand study` as the subjects grow, with short trials.

    STILLHAND_BUILD=build /usr/bin/python3 tests/benchmark/study_growth.py [--subjects 100 1000 10000] [--threads 2]

Pegged trial 20 s, three trials of 20 s.  Wall time of the whole command, report included, and its largest resident
memory.  "more a subject" is the difference to the row above over the difference in subjects: constant if the growth is
linear.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import time

BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", "build"))


def run(subjects, threads):
    with tempfile.TemporaryDirectory() as out:
        begin = time.perf_counter()
        child = subprocess.Popen([BUILD / "bin" / "stillhand", "study", "--subjects", str(subjects), "--trial-seconds", "20",
                                  "--identify-seconds", "20", "--seed", "5", "--threads", str(threads), "--out", out],
                                 stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(child.pid, 0)
        if status:
            sys.exit(f"study_growth: stillhand study ended with {status}")
        return time.perf_counter() - begin, usage.ru_maxrss / 1024, usage.ru_utime + usage.ru_stime


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--subjects", type=int, nargs="+", default=[100, 1000, 10000])
    words.add_argument("--threads", type=int, default=2)
    options = words.parse_args()
    print("| subjects | wall [s] | processor [s] | memory [MiB] | more a subject: processor [ms] | memory [kiB] |\n"
          "| --- | --- | --- | --- | --- | --- |")
    before = None
    for subjects in options.subjects:
        wall_s, memory_mib, cpu_s = run(subjects, options.threads)
        more = ("-", "-") if before is None else (
            f"{1e3 * (cpu_s - before[1]) / (subjects - before[0]):.1f}",
            f"{1024 * (memory_mib - before[2]) / (subjects - before[0]):.1f}")
        print(f"| {subjects} | {wall_s:.1f} | {cpu_s:.1f} | {memory_mib:.0f} | {more[0]} | {more[1]} |", flush=True)
        before = (subjects, cpu_s, memory_mib)


if __name__ == "__main__":
    main()
