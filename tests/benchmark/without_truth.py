#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What C and C+ leave of a pegged force, estimated from what is sensed alone, next to the truth of the simulated rig.

    STILLHAND_BUILD=build /usr/bin/python3 tests/benchmark/without_truth.py [--people 8] [--effect SEED] [--seconds 60]

Simulated people of an experiment, made without a bus. For each, `close-the-loop --pegged` reads the first 70 % of the
pegged trial and the trials B and C, as sensed, and judges its models on the rest (CL-6): once on the force that the load
cell gave, as a rig without truth does, and once on the true feedthrough force of the same samples. Prints a row for each
person, whether the truth lies in the estimate's 95 % interval, and the mean difference. Two minutes of processor time.
"""
import argparse
import datetime
import json
import pathlib
import subprocess
import statistics
import sys
import tempfile

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "integration"), str(TESTS / "support")]

from lab_process import STILLHAND  # noqa: E402
from sample_experiment import conduct, stillhand  # noqa: E402
from verb_case import columns  # noqa: E402

FITTED = 0.7
IDENTIFY_S = 150  # of which the last 45 s are four blocks of CL-6
UNITS = {"accel_x_m_s2": "a_x [m/s^2]", "accel_y_m_s2": "a_y [m/s^2]", "accel_z_m_s2": "a_z [m/s^2]", "roll_rad": "roll [rad]",
         "theta_rad": "theta [rad]", "omega_rad_s": "omega [rad/s]"}


def write(path, samples, forces):
    with open(path, "w", encoding="utf-8") as file:
        file.write(",".join(["t [s]", *UNITS.values(), "f [N]"]) + "\n")
        for (tick, *values, _), force in zip(samples, forces):
            file.write(",".join([f"{int(tick) / 1000:.3f}", *values, force]) + "\n")
    return path


def parts(recording, folder):
    """CSV files of the pegged trial: its first part as sensed; the rest as sensed, and with the true force."""
    folder.mkdir()
    tables = folder / "csv"
    subprocess.run([str(STILLHAND), "export", str(recording), "--csv", str(tables), "--topics",
                    "stillhand/sensed,stillhand/rig_truth,stillhand/trial_control"], check=True, stdout=subprocess.DEVNULL)
    controls = columns(tables / "stillhand_trial_control.csv", "trial", "start_tick", "duration_ticks")
    start, length = next((int(start), int(length)) for trial, start, length in controls if int(trial) == 0)
    truth = dict(columns(tables / "stillhand_rig_truth.csv", "tick", "feedthrough_force_n"))
    samples = [row for row in columns(tables / "stillhand_sensed.csv", "tick", *UNITS, "force_n")
               if start <= int(row[0]) < start + length and row[0] in truth]
    cut = int(FITTED * len(samples))
    unseen = samples[cut:]
    return (write(folder / "fitted.csv", samples[:cut], [row[-1] for row in samples[:cut]]),
            write(folder / "sensed.csv", unseen, [row[-1] for row in unseen]),
            write(folder / "true.csv", unseen, [truth[row[0]] for row in unseen]))


def judged(recording, folder):
    fitted, sensed, true = parts(recording, folder)
    subprocess.run([str(STILLHAND), "close-the-loop", "--pegged", str(fitted), "--moving", str(recording), "--cancelled",
                    str(recording), "--unseen", str(sensed), str(true), "--out", str(folder / "loop")], check=True,
                   stdout=subprocess.DEVNULL)
    summary = json.loads((folder / "loop" / "summary.json").read_text())
    return summary["verdict"], summary["unseen"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--people", type=int, default=8)
    parser.add_argument("--effect", type=int, default=0, help="seed of an undeclared effect that every rig holds")
    parser.add_argument("--seconds", type=int, default=60, help="length of B and C")
    options = parser.parse_args()
    print(f"`tests/benchmark/without_truth.py --people {options.people} --effect {options.effect} --seconds {options.seconds}`, "
          f"{datetime.date.today()}\n\n| person | C, as sensed [%] | C, truth [%] | C+, as sensed [%] | C+, truth [%] | verdict |")
    print("| --- | --- | --- | --- | --- | --- |")
    inside = {"motor_linear": [], "motor_augmented": []}
    apart = {"motor_linear": [], "motor_augmented": []}
    with tempfile.TemporaryDirectory(prefix="stillhand-truth-") as place:
        folder = pathlib.Path(place) / "experiment"
        stillhand("experiment", "new", folder, "--participants", options.people, "--trial-seconds", options.seconds,
                  "--identify-seconds", IDENTIFY_S, "--seed", 11)
        conduct(folder, 0, 1, options.effect)
        for number, recording in enumerate(sorted(folder.rglob("session.mcap"))):
            name = recording.relative_to(folder).parts[1]
            try:
                verdict, (sensed, true) = judged(recording, pathlib.Path(place) / str(number))
            except (subprocess.CalledProcessError, StopIteration):
                print(f"| {name} | left out: no whole trial I, B or C | | | | |")
                continue
            cells = []
            for which, lists in inside.items():
                estimate, truth = sensed[which], true[which]
                if not estimate or not truth or not estimate["cut_interval95"]:
                    cells += ["-", "-"]
                    continue
                low, high = estimate["cut_interval95"]
                lists.append(low <= truth["cut"] <= high)
                apart[which].append(100 * (estimate["cut"] - truth["cut"]))
                cells += [f"{100 * estimate['cut']:.1f} ({100 * low:.1f} to {100 * high:.1f})", f"{100 * truth['cut']:.1f}"]
            print(f"| {name} | {' | '.join(cells)} | {verdict['conclusion']} {verdict.get('kind') or ''} |", flush=True)
    for name, which in (("C", "motor_linear"), ("C+", "motor_augmented")):
        if apart[which]:
            print(f"\n{name}: estimate less truth {statistics.mean(apart[which]):+.1f} points on average, "
                  f"{min(apart[which]):+.1f} to {max(apart[which]):+.1f}; the truth lies in {sum(inside[which])} of "
                  f"{len(inside[which])} intervals")


if __name__ == "__main__":
    main()
