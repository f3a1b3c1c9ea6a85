#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A long session: does any process grow, does any sample get lost?

Usage: STILLHAND_BUILD=build /usr/bin/python3 tests/faults/soak.py --out DIR [--minutes 30] [--no-real-time]

One trial with cancellation takes the minutes. Memory and open files of every process are read each second. Their slopes
are those of a straight line by least squares through the second half. Prints and writes (DIR/soak.json, DIR/soak.md)
the slopes, the misses of the trial, the lost ticks and the state of the recording. Exit status 1 if a process grows,
the trial does not end, or the recording is damaged or lacks a tick.
"""
import argparse
import datetime
import json
import os
import pathlib
import platform
import sys
import time

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "integration"), str(TESTS / "support")]

from lab_process import CTEST_SKIPPED, INSPECT, STILLHAND, LabProcess, loose_settings, running, wait_for  # noqa: E402

PERIOD_S = 1.0
AROUND_S = 120.0  # start, pegged trial, results
# A page more in each second of 30 minutes is 7 MB. What allocators do at random is far below it after the first half.
MOST_KB_MIN = 240.0
MOST_FILES_MIN = 0.2  # one more in the half of 10 minutes


def resident_kb(pid):
    for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1])
    raise OSError("it ended")


def look(domain, series, began_s):
    for pid, name in running(domain).items():
        try:
            values = (time.monotonic() - began_s, resident_kb(pid), len(os.listdir(f"/proc/{pid}/fd")))
        except OSError:  # it ended meanwhile
            continue
        series.setdefault("experiment" if name == "stillhand" else name.removeprefix("stillhand-"), []).append(values)


def slope_per_min(rows, column):
    """Least squares through the second half; the trial's own half, as the last seconds are the lab's results."""
    half = [row for row in rows if row[0] >= rows[-1][0] / 2]
    mean_s = sum(row[0] for row in half) / len(half)
    mean = sum(row[column] for row in half) / len(half)
    squares = sum((row[0] - mean_s) ** 2 for row in half)
    return 60.0 * sum((row[0] - mean_s) * (row[column] - mean) for row in half) / squares if squares else 0.0


def soak(options):
    """Runs the session. Returns the lab's end status, its summary, the recording, and the series of each process."""
    words = ["--conditions", "C", "--identify-seconds", 10, "--trial-seconds", round(options.minutes * 60), "--seed", 2,
             "--config", loose_settings(options.out / "config")]
    lab = LabProcess(options.out / "run", *words, *(["--no-real-time"] if options.no_real_time else []))
    began_s = time.monotonic()
    series = {}
    try:
        def ended():
            # The results are no part of the session: the lab's memory grows with the recording that it reads.
            if len(running(lab.domain)) > 1 and not (options.out / "run" / "summary.json").exists():
                look(lab.domain, series, began_s)
            return lab.process.poll() is not None
        wait_for("end of the session", ended, options.minutes * 60 + AROUND_S + 60 * options.minutes, poll_s=PERIOD_S)
        if not (options.out / "run" / "summary.json").is_file():
            raise RuntimeError(f"the session has no results: {lab.errors()}")
        summary = json.loads((options.out / "run" / "summary.json").read_text())
        recording = lab.recording(1)
        return lab.process.returncode, summary, recording, series, lab.errors()
    finally:
        lab.close()


def findings(status, summary, recording, series):
    found = [] if status == 0 else [f"exit status {status}: {summary['trials'][-1].get('aborted')}"]
    found += [f"recording: {line}" for line in recording["damage"]]
    found += [f"{topic}: {count} ticks are missing" for topic, count in recording["lost_ticks"].items() if count]
    # The growth of a session that ended early is that of its start.
    for name, rows in series.items() if status == 0 else ():
        memory, files = slope_per_min(rows, 1), slope_per_min(rows, 2)
        if memory > MOST_KB_MIN:
            found.append(f"{name}: its memory grows by {memory:.0f} kB a minute")
        if files > MOST_FILES_MIN:
            found.append(f"{name}: its open files grow by {files:.2f} a minute")
    return found


def table(series):
    lines = ["| process | memory at the middle, end [MB] | slope [kB/min] | open files at the end | slope [1/min] |",
             "| --- | --- | --- | --- | --- |"]
    for name, rows in sorted(series.items()):
        middle = rows[len(rows) // 2]
        lines.append(f"| {name} | {middle[1] / 1024:.1f}, {rows[-1][1] / 1024:.1f} | {slope_per_min(rows, 1):.0f} | "
                     f"{rows[-1][2]} | {slope_per_min(rows, 2):.2f} |")
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, required=True, help="new folder for the session and its results")
    parser.add_argument("--minutes", type=float, default=30.0, help="length of the trial, 1 to 60 [30]")
    parser.add_argument("--no-real-time", action="store_true", help="as of `stillhand lab`")
    options = parser.parse_args()
    missing = [str(path) for path in (STILLHAND, INSPECT) if not path.is_file()]
    if missing:
        print("skipped: not built:", ", ".join(missing))
        return CTEST_SKIPPED
    if not 1.0 <= options.minutes <= 60.0:
        print(f"--minutes {options.minutes:g}: want 1 to 60", file=sys.stderr)
        return 2
    if options.out.exists():
        print(f"--out {options.out}: it is there already; name a new folder", file=sys.stderr)
        return 2
    options.out.mkdir(parents=True)
    try:
        status, summary, recording, series, errors = soak(options)
    except RuntimeError as error:
        print(error, file=sys.stderr)
        return 1
    found = findings(status, summary, recording, series)
    trial = summary["trials"][-1]
    misses = {name: trial[name] for name in ("deadline_misses", "cycle_misses", "lost_ticks")}
    machine = f"{platform.machine()}, {os.cpu_count()} processors"
    lines = [f"{options.minutes:g} minutes, {datetime.date.today()}, {machine}.", "", *table(series), "",
             f"Misses of the trial: {json.dumps(misses)}.",
             f"Ticks missing in the recording: {sum(recording['lost_ticks'].values())}; damage: {recording['damage']}."]
    lines += [f"- {line}" for line in [*found, *errors]]
    (options.out / "soak.md").write_text("\n".join(lines) + "\n")
    (options.out / "soak.json").write_text(json.dumps({"series": series, "misses": misses, "findings": found}))
    print("\n".join(lines))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
