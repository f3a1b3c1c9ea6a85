#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Several rigs on one machine: how many before a cycle is missed, and what gives first.

    STILLHAND_BUILD=build /usr/bin/python3 tests/benchmark/rigs_at_once.py [--rigs 1 2 4 8] [--seconds 20] [--repeats 3]

Each rig is a whole lab of nine processes on a DDS domain of its own, with trials A, B and C; all are started together.
From each summary.json: late cycles, deadline misses and lost ticks while trials ran, trials that were not completed, and
the earliest mark: what gave first, where.  Labs that ended early, with the line of the first.  Processor time of all over
the wall time: cores in use.  Numbers are sums over the labs of a count; the median repeat, by early ends and late cycles,
is shown.
"""
import argparse
import collections
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "integration"))

from lab_process import DOMAINS, loose_settings  # noqa: E402

BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", "build"))
FIRST_DOMAIN = 215


def cores_used():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def together(count, seconds):
    with tempfile.TemporaryDirectory(prefix="stillhand-") as holder:
        holder = pathlib.Path(holder)
        settings = loose_settings(holder / "config")
        begin, before = time.monotonic(), cores_used()
        labs = [subprocess.Popen([BUILD / "bin" / "stillhand", "lab", "--headless", "--conditions", "A,B,C",
                                  "--identify-seconds", "10", "--trial-seconds", str(seconds), "--seed", str(i + 1),
                                  "--config", settings, "--domain", str(FIRST_DOMAIN + i), "--out", holder / f"lab{i}"],
                                 stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) for i in range(count)]
        errors = [lab.communicate()[1].strip() for lab in labs]
        wall_s = time.monotonic() - begin
        total, first, ended = collections.Counter(), [], []
        for i, lab in enumerate(labs):
            summary = holder / f"lab{i}" / "summary.json"
            if lab.returncode or not summary.exists():
                ended.append(errors[i].splitlines()[-1][:100] if errors[i] else f"status {lab.returncode}")
                continue
            read = json.loads(summary.read_text())
            for trial in read["trials"]:
                for name in ("deadline_misses", "cycle_misses", "lost_ticks"):
                    total[name] += trial[name]
                if not trial["completed"]:
                    total["trials that did not complete"] += 1
                first += [(mark["first_tick"], mark["what"], mark["source"], mark["topic"]) for mark in trial["marks"]]
        first.sort()
        return total, ended, first[:1], (cores_used() - before) / wall_s


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--rigs", type=int, nargs="+", default=[1, 2, 4, 8])
    words.add_argument("--seconds", type=float, default=20.0)
    words.add_argument("--repeats", type=int, default=3)
    options = words.parse_args()
    if max(options.rigs) > DOMAINS:
        sys.exit(f"rigs_at_once: at most {DOMAINS} rigs, a domain each")
    print(f"{os.cpu_count()} cores\n| rigs | late cycles | deadline misses | lost ticks | trials not completed "
          "| labs that ended early | cores in use | first mark |\n| --- | --- | --- | --- | --- | --- | --- | --- |")
    for count in options.rigs:
        runs = sorted((together(count, options.seconds) for _ in range(options.repeats)),
                      key=lambda run: (len(run[1]), run[0]["cycle_misses"]))
        total, ended, first, cores = runs[len(runs) // 2]
        mark = "{1} of {2} {3}, tick {0}".format(*first[0]) if first else "-"
        print(f"| {count} | {total['cycle_misses']} | {total['deadline_misses']} | {total['lost_ticks']} "
              f"| {total['trials that did not complete']} | {len(ended)} {'(' + ended[0] + ')' if ended else ''} "
              f"| {cores:.2f} | {mark} |", flush=True)


if __name__ == "__main__":
    main()
