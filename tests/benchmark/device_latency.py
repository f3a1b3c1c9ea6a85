#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""From a sample of the emulated accelerometer to the torque that answers it at the emulated drive.

    STILLHAND_BUILD=build /usr/bin/python3 tests/benchmark/device_latency.py [--seconds 60]

A session in condition C over the emulators (tests/emulators), then the same session on the simulated rig. The emulated
drive stamps each answer that carries a sample and each command that it obeys; both clocks are this machine's. A torque
is matched to its command by its value (the force of a tick times the lever, in 32 bit), the command to its sample by
the tick that it answers, and that sample to the drive's answer by its three numbers (acceleration, force, angle).
Prints one table in microseconds: p50, p99 and worst. What could not be matched is counted.
"""
import argparse
import bisect
import datetime
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "integration"), str(TESTS / "support")]

from emulated_laboratory import MAX_AGE_MS, PROGRAM, WATCHDOG_MS, EmulatedLaboratory  # noqa: E402
from lab_process import BUILD, STILLHAND, LabProcess, loose_settings, next_domain  # noqa: E402
from verb_case import columns  # noqa: E402

LOOP_STAMPS = BUILD / "tests" / "loop_stamps"
LEVER_M = 0.10        # rig.yaml
ANALOGUE_V = 3.3      # devices.yaml
COUNTS_REV = 4096
OLDEST_NS = 200_000_000
PEGGED_S = 5


def session(seconds):
    return ["--conditions", "C", "--identify-seconds", PEGGED_S, "--trial-seconds", seconds, "--seed", 2]


def end(lab, seconds):
    status = lab.end_status(3 * seconds + 90)
    if status != 0:
        sys.exit(f"device_latency.py: the session ended with status {status}: {lab.errors()[-1:]}")


def over_devices(folder, seconds):
    domain = next_domain()
    loose_settings(folder / "config")
    laboratory = EmulatedLaboratory(folder / "config", domain=domain)
    lab = LabProcess(folder / "devices", "--rig", "devices", *session(seconds), "--config", folder / "config", domain=domain)
    try:
        laboratory.order("trace")
        end(lab, seconds)
        laboratory.order("write_trace", folder / "trace")
        laboratory.report()  # the trace is written when the next order is answered
    finally:
        lab.close()
        laboratory.close()
    return folder / "devices"


def simulated(folder, seconds):
    lab = LabProcess(folder / "simulated", *session(seconds), "--config", loose_settings(folder / "plain"))
    try:
        end(lab, seconds)
    finally:
        lab.close()
    return folder / "simulated"


def named(path, *names):
    return [dict(zip(names, row)) for row in columns(path, *names)]


def table(recording, topic, *names):
    tables = recording.parent / "csv"
    if not tables.is_dir():
        subprocess.run([str(STILLHAND), "export", str(recording), "--csv", str(tables), "--topics",
                        "stillhand/raw_sample,stillhand/rig_truth"], check=True, stdout=subprocess.DEVNULL)
    return named(tables / f"stillhand_{topic}.csv", *names)


def torque_bits(torque_n_m):
    return np.float32(torque_n_m).tobytes()


def matched(folder, recording):
    """Times in ns: device to device, from the answer that carried the sample, and their counts."""
    replies = named(pathlib.Path(f"{folder}/trace_replies.csv"), "sampled_ns", "sent_ns", "analog1", "analog2", "position_rev")
    # What the rig published of an answer: volts and counts (device_plant.cpp, put_stick).
    carried = {}
    for each in replies:
        key = (round(ANALOGUE_V * float(each["analog2"]), 9), round(ANALOGUE_V * float(each["analog1"]), 9),
               int(np.rint(float(each["position_rev"]) * COUNTS_REV)))
        carried.setdefault(key, []).append((int(each["sent_ns"]), int(each["sampled_ns"])))
    commands = {}
    for each in named(pathlib.Path(f"{folder}/trace_torques.csv"), "at_ns", "torque_n_m"):
        commands.setdefault(torque_bits(float(each["torque_n_m"])), []).append(int(each["at_ns"]))

    raw = {int(each["tick"]): each for each in table(recording, "raw_sample", "tick", "stamp_ns", "accel_y_v", "load_cell_v",
                                                      "encoder_counts")}
    sampled, sent, own, ticks, unmatched = [], [], 0, 0, 0
    for truth in table(recording, "rig_truth", "tick", "stamp_ns", "motor_force_n", "motor_tick"):
        force_n, answered = float(truth["motor_force_n"]), int(truth["motor_tick"])
        if force_n == 0.0 or answered not in raw:
            continue
        ticks += 1
        own += answered == int(truth["tick"])
        sample = raw[answered]
        stamp_ns = int(sample["stamp_ns"])
        key = (round(float(sample["accel_y_v"]), 9), round(float(sample["load_cell_v"]), 9), int(sample["encoder_counts"]))
        # The newest answer with these numbers that was there before the sample was published.
        answers = carried.get(key, [])
        at = bisect.bisect_right(answers, (stamp_ns, 0)) - 1
        # The first command with this torque after it.
        times = commands.get(torque_bits(force_n * LEVER_M), [])
        then = bisect.bisect_left(times, stamp_ns)
        if at < 0 or stamp_ns - answers[at][0] > OLDEST_NS or then == len(times) or times[then] - stamp_ns > OLDEST_NS:
            unmatched += 1
            continue
        sent.append(times[then] - answers[at][0])
        sampled.append(times[then] - answers[at][1])
    return sampled, sent, {"ticks": ticks, "unmatched": unmatched, "own": own}


def figures(times_ns):
    us = np.array(times_ns) / 1000.0
    return f"{np.quantile(us, 0.5):.0f} | {np.quantile(us, 0.99):.0f} | {us.max():.0f}"


def stamps(recording):
    found = json.loads(subprocess.run([str(LOOP_STAMPS), str(recording)], capture_output=True, text=True, check=True).stdout)
    return found["command"], found["used"], found["same_cycle_share"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=int, default=60, help="length of the trial")
    seconds = parser.parse_args().seconds
    missing = [str(path) for path in (PROGRAM, STILLHAND, LOOP_STAMPS) if not path.is_file()]
    if missing:
        sys.exit(f"device_latency.py: not built: {', '.join(missing)}")
    folder = pathlib.Path(tempfile.mkdtemp(prefix="stillhand-latency-"))
    try:
        devices = over_devices(folder, seconds) / "session.mcap"
        plain = simulated(folder, seconds) / "session.mcap"
        sampled, sent, counts = matched(folder, devices)
        print(f"`tests/benchmark/device_latency.py --seconds {seconds}`, {datetime.date.today()}, load average "
              f"{os.getloadavg()[0]:.1f}; age limit {MAX_AGE_MS} ms, watchdog {WATCHDOG_MS} ms; {len(sampled)} of {counts['ticks']} "
              f"ticks with a force, {counts['unmatched']} without a match; {100 * counts['own'] / max(counts['ticks'], 1):.1f} % "
              "answer their own tick\n")
        print("| from | to | p50 | p99 | worst |\n| --- | --- | --- | --- | --- |")
        print(f"| sample of the emulated accelerometer | torque at the emulated drive | {figures(sampled)} |")
        print(f"| the drive's answer that carried it, sent | torque at the emulated drive | {figures(sent)} |")
        for name, recording in (("devices", devices), ("simulated rig", plain)):
            command, used, share = stamps(recording)
            for what, row in (("motor command", command), (f"used by the rig ({100 * share:.1f} % in the same tick)", used)):
                print(f"| {name}: raw sample published | {what} | {row['p50']:.0f} | {row['p99']:.0f} | {row['worst']:.0f} |")
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
