#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""From the command to the first cancelled sample: a lab of nine processes with condition C alone.

    STILLHAND_BUILD=build /usr/bin/python3 tests/benchmark/start_time.py [--repeats 5] [--identify-seconds 40]

Counted on the machine's monotonic clock, from the moment before `stillhand lab` is started to the stamps of messages in
its recording: the first raw sample (every process is up and every endpoint matched), the first sample of the pegged
trial, the first model, the first motor command with a force.  Median, least and most of the repeats, each a session of
its own.  The pegged trial itself takes --identify-seconds and two ramps; "our part" is what remains of the whole.
"""
import argparse
import csv
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "integration"))

from lab_process import loose_settings, next_domain  # noqa: E402

BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", "build"))
STILLHAND = BUILD / "bin" / "stillhand"
RAMPS_S = 4.0  # of the pegged trial, before and after


def column(row, name):
    """The column of that name, with or without a unit."""
    return next(value for title, value in row.items() if title.split(" ")[0] == name)


def rows(folder, topic):
    with open(next(path for path in folder.glob("*.csv") if path.stem.endswith(topic)), newline="") as file:
        yield from csv.DictReader(file)


def session(folder, identify_s):
    settings = loose_settings(folder / "config")
    begin_ns = time.monotonic_ns()
    run = subprocess.run([STILLHAND, "lab", "--headless", "--conditions", "C", "--identify-seconds", str(identify_s),
                          "--trial-seconds", "5", "--seed", "2", "--match-seconds", "120", "--domain", str(next_domain()), "--config", settings,
                          "--out", folder / "out"], capture_output=True, text=True)
    if run.returncode:
        sys.exit("start_time: " + run.stderr.strip()[-400:])
    end_s = (time.monotonic_ns() - begin_ns) * 1e-9
    subprocess.run([STILLHAND, "export", folder / "out" / "session.mcap", "--csv", folder / "csv", "--topics",
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
            "our part": since(force) - identify_s - RAMPS_S, "end of the session": end_s}


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--repeats", type=int, default=5)
    words.add_argument("--identify-seconds", type=float, default=10.0)
    options = words.parse_args()
    found = []
    for _ in range(options.repeats):
        with tempfile.TemporaryDirectory(prefix="stillhand-") as folder:
            found.append(session(pathlib.Path(folder), options.identify_seconds))
    print("| from the command to | median [s] | least | most |\n| --- | --- | --- | --- |")
    for name in found[0]:
        values = [each[name] for each in found]
        print(f"| {name} | {statistics.median(values):.2f} | {min(values):.2f} | {max(values):.2f} |")


if __name__ == "__main__":
    main()
