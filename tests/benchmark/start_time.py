#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""From the command to the first cancelled sample, and what the processes cost: a lab of nine, with condition C alone.

    tests/benchmark/start_time.py [--repeats 5] [--identify-seconds 10] [--lab NAME=PROGRAMS]...

Counted on the machine's monotonic clock, from the moment before `stillhand lab` is started to the stamps of messages in
its recording: the first raw sample (every process is up and every endpoint matched), the first sample of the pegged
trial, the first model, the first motor command with a force.  Median, least and most of the repeats, each a session of
its own.  The pegged trial itself takes --identify-seconds and two ramps; "our part" is what remains of the whole.
Processor time [s] and most memory [MB] of each process are its last ones in /proc, and medians of the repeats.
--lab adds the lab of another build: a session of each in turn.
"""
import argparse
import csv
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "integration"))

from lab_process import loose_settings, next_domain  # noqa: E402

BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", "build"))
RAMPS_S = 4.0  # of the pegged trial, before and after


def column(row, name):
    """The column of that name, with or without a unit."""
    return next(value for title, value in row.items() if title.split(" ")[0] == name)


def rows(folder, topic):
    with open(next(path for path in folder.glob("*.csv") if path.stem.endswith(topic)), newline="") as file:
        yield from csv.DictReader(file)


def costs(lab):
    """{process: (processor time [s], most memory [MB])} of the lab's processes until it ends: those of its session."""
    found = {}
    while True:
        for each in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                name, _, rest = (each / "stat").read_text().partition(" (")[2].rpartition(") ")
                status = (each / "status").read_text()
            except OSError:
                continue  # it has ended
            fields = rest.split()  # from field 3 of proc(5) on: 6 is the session, 14 and 15 the times
            memory = re.search(r"VmHWM:\s+(\d+)", status)
            if int(fields[3]) == lab.pid and memory:
                used_s = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
                found[name] = (used_s, int(memory[1]) / 1024.0)
        try:
            lab.wait(timeout=0.2)
            return found
        except subprocess.TimeoutExpired:
            continue


def session(programs, folder, identify_s):
    settings = loose_settings(folder / "config")
    begin_ns = time.monotonic_ns()
    lab = subprocess.Popen([programs / "stillhand", "lab", "--headless", "--conditions", "C", "--identify-seconds", str(identify_s),
                            "--trial-seconds", "5", "--seed", "2", "--match-seconds", "120", "--domain",
                            str(next_domain()), "--config", settings, "--out", folder / "out"],
                           stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True)
    used = costs(lab)
    if lab.returncode:
        sys.exit("start_time: " + lab.stderr.read().strip()[-400:])
    end_s = (time.monotonic_ns() - begin_ns) * 1e-9
    subprocess.run([BUILD / "bin" / "stillhand", "export", folder / "out" / "session.mcap", "--csv", folder / "csv", "--topics",
                    "stillhand/raw_sample,stillhand/motor_command,stillhand/trial_control,stillhand/feedthrough_model"],
                   check=True, capture_output=True)
    since = lambda row: (int(column(row, "stamp_ns")) - begin_ns) * 1e-9
    raw = list(rows(folder / "csv", "raw_sample"))
    stamps = {int(column(row, "tick")): since(row) for row in raw}
    pegged = next(row for row in rows(folder / "csv", "trial_control") if int(column(row, "trial")) == 0)
    start = int(column(pegged, "start_tick")) - int(column(pegged, "ramp_ticks"))
    model = next(rows(folder / "csv", "feedthrough_model"))
    force = next(row for row in rows(folder / "csv", "motor_command") if float(column(row, "force_n")) != 0.0)
    return {"first raw sample": min(stamps.values()), "pegged trial begins": stamps.get(start, float("nan")),
            "model": since(model), "first cancelled sample": since(force),
            "our part": since(force) - identify_s - RAMPS_S, "end of the session": end_s}, used


def print_starts(starts):
    print("| from the command to | median [s] | least | most |\n| --- | --- | --- | --- |")
    for name in starts[0]:
        values = [each[name] for each in starts]
        print(f"| {name} | {statistics.median(values):.2f} | {min(values):.2f} | {max(values):.2f} |")


def print_costs(used):
    print("| process | processor time [s] | most memory [MB] |\n| --- | --- | --- |")
    total_s = total_mb = 0.0
    for name in sorted(set.intersection(*map(set, used))):
        seconds, memory = (statistics.median(each[name][i] for each in used) for i in (0, 1))
        total_s, total_mb = total_s + seconds, total_mb + memory
        print(f"| {name} | {seconds:.2f} | {memory:.1f} |")
    print(f"| together | {total_s:.2f} | {total_mb:.1f} |")


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--repeats", type=int, default=5)
    words.add_argument("--identify-seconds", type=float, default=10.0)
    words.add_argument("--lab", action="append", default=[], metavar="NAME=PROGRAMS")
    options = words.parse_args()
    labs = {"this build": BUILD / "bin", **{name: pathlib.Path(programs) for name, _, programs in
                                            (each.partition("=") for each in options.lab)}}
    found = {name: [] for name in labs}
    for _ in range(options.repeats):
        for name, programs in labs.items():
            with tempfile.TemporaryDirectory(prefix="stillhand-") as folder:
                found[name].append(session(programs, pathlib.Path(folder), options.identify_seconds))
    for name, sessions in found.items():
        starts, used = zip(*sessions)
        print(f"\n{name}:\n")
        print_starts(starts)
        print()
        print_costs(used)


if __name__ == "__main__":
    main()
