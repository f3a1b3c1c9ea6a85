#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Mitigations as conditions of a session over DDS: they act, they are recorded, the same cores answer the same.

A minute: signal cancellation, which needs a trial with the stick free, and damping with the motor. With `--campaign`
every mitigation that a session runs, in trials of 45 s, next to the study's row of the same person; some 20 minutes.
The table is printed; each share is within bounds of the study's 48 people, each motor's force within a factor of two of
the same person's.
"""
import math
import statistics

from lab_process import LabTestCase, campaign, loose_settings, main
from verb_case import rows

CORES = ("CancellationAnswersTheSame", "DisplayAnswersTheSame", "IdentificationFindsTheSameModel",
         "TheSimulatedSubjectAnswersTheSame")
SESSION_LIMIT_S = 150.0
STUDY_LIMIT_S = 1800.0
SEED = 20261125
MAX_FORCE_N = 25.0  # of the rig and of the canceller, deploy/config


def rms(values):
    return math.sqrt(sum(value * value for value in values) / len(values))


def shake(values):
    """RMS of the second difference over 0.35 s: most of 0.7 to 2 Hz (4 times at 1.4 Hz), little of what is tracked."""
    lag = int(0.35 * 1000)
    return rms([values[n] - 2 * values[n - lag] + values[n - 2 * lag] for n in range(2 * lag, len(values))])


def share_bounds(people, moving):
    """Where the share (B - M)/(B - A) of one more person, live, lies: 3 standard deviations about the study's mean.

    The study gives A, B and M of a person one target and one noise, a session three. So to the spread of its people
    comes that of three errors which are each one trial: their relative spread is at most that of the errors with a
    still platform over people, which holds persons and targets. Nothing here is of a live trial.
    @param people, moving  rows of mitigation_people.csv of the mitigation, and of none
    """
    shares = [share for share in (float(row["restored"]) for row in people) if math.isfinite(share)]
    error, still = ([float(row[column]) for row in people] for column in ("error [mm]", "still [mm]"))
    b, m, a = (statistics.mean(each) for each in ([float(row["error [mm]"]) for row in moving], error, still))
    share = statistics.mean(shares)
    one_trial = statistics.stdev(still) / a * math.hypot(b * (1 - share), m, a * share) / (b - a)
    spread = 3 * math.hypot(statistics.stdev(shares), one_trial)
    return share - spread, share + spread


class MitigationsTest(LabTestCase):
    def live(self):
        """Every mitigation that a session runs, as a refusal lists them; A, B and C have a title behind their letter."""
        line = self.refused("lab", "--conditions", "B,signals", "--headless", "--out", self.folder / "none")
        return [name for name in line.strip().partition("want a list of ")[2].split(", ") if " (" not in name]

    def test_two_mitigations_act_and_answer_the_same_in_one_process(self):
        config = loose_settings(self.folder / "config")
        lab = self.lab("--conditions", "signal,damping+force", "--identify-seconds", 6, "--trial-seconds", 6,
                       "--seed", 3, "--config", config)
        self.assertEqual(lab.end_status(SESSION_LIMIT_S), 0, lab.errors())
        self.assert_nothing_left(lab)
        summary = lab.summary()
        trials = {trial["condition"]: trial["number"] for trial in summary["trials"]}
        self.assertEqual(set(trials), {"I", "J", "signal", "damping+force"})
        self.assertEqual((trials["I"], trials["J"]), (0, 1))
        self.assertEqual(set(summary["conditions"]), {"signal", "damping+force"})
        signals = {name: lab.measured_signals(trials[name]) for name in ("signal", "damping+force")}
        cursor = {name: shake([row[3] for row in rows["tracking"]]) for name, rows in signals.items()}
        raw = {name: shake([0.6 * row[1] for row in rows["stick"]]) for name, rows in signals.items()}
        print({name: (round(1e3 * cursor[name]), round(1e3 * raw[name])) for name in cursor}, "mm, cursor and stick",
              flush=True)
        # A quarter is left of the shaking in both (seen); a mitigation that does nothing, or of the wrong sign, leaves
        # it all or more. The signal leaves the stick shaken, as condition B does, and the force does not.
        self.assertLess(cursor["signal"], 0.5 * raw["signal"])
        self.assertLess(cursor["damping+force"], 0.5 * raw["signal"])
        self.assertGreater(summary["conditions"]["damping+force"]["cancelled_share"], 0.4)
        # The signal's motor is off, to the bit; the other's acts within its bounds.
        motor = {name: rows["motor"] for name, rows in signals.items()}
        force = {name: [row[1] for row in rows] for name, rows in motor.items()}
        self.assertEqual(set(force["signal"]), {0.0})
        self.assertGreater(rms(force["damping+force"]), 1.0)
        self.assertLessEqual(max(map(abs, force["damping+force"])), MAX_FORCE_N)
        # Recorded are the raw stick and what was taken off it.
        taken_off = {name: [row[2] for row in rows] for name, rows in motor.items()}
        stick = [row[1] for row in signals["signal"]["stick"]]
        self.assertGreater(rms(taken_off["signal"]), 0.25 * rms(stick))
        self.assertEqual(set(taken_off["damping+force"]), {0.0})
        self.assert_same_in_one_process(lab, config, *CORES)

    def test_a_wrong_name_is_refused_in_one_line_that_lists_them(self):
        self.assertLessEqual({"low-pass", "signal", "scheduled", "damping+force"}, set(self.live()))

    def arm(self, task):
        """The fitted arm of the person in a task, from a session of its own."""
        lab = self.lab("--identify", "admittance,feedthrough", "--task", task, "--perturb-period-s", 20,
                       "--trial-seconds", 120, "--identify-seconds", 5, "--subject", 1, "--seed", SEED,
                       "--config", loose_settings(self.folder / f"config_{task}"), out=self.folder / task)
        self.assertEqual(lab.end_status(300.0), 0, lab.errors())
        found = self.folder / f"{task}.json"
        self.run_verb("identify", lab.out / "session.mcap", "--admittance", "--json", found)
        return found

    @campaign
    def test_every_mitigation_live_next_to_the_study(self):
        # First the study: it chooses the parameters on the same other people as the lab's own (SU-18).
        study = self.folder / "study"
        every = self.live()
        names = ",".join(("force", *every))
        self.run_verb("study", "--mitigations", names, "--subjects", 48, "--seed", SEED, "--trial-seconds", 45, "--out", study,
                      timeout=STUDY_LIMIT_S)
        people = [row for row in rows(study / "mitigation_people.csv") if row["task"] == "track" and
                  row["motion"] == "0.7-2 Hz" and row["model"] in ("own", "none")]
        inside = {row["mitigation"]: row for row in people if row["person"] == "1"}
        self.assertLessEqual({"force", *every}, set(inside))
        arms = [self.arm(task) for task in ("relax", "hold")]
        lab = self.lab("--conditions", ",".join(("A", "B", "C", *every)), "--arms", ",".join(map(str, arms)),
                       "--identify-seconds", 40, "--trial-seconds", 45, "--seed", SEED, "--subject", 1)
        self.assertEqual(lab.end_status(1000.0), 0, lab.errors())
        live = lab.summary()["mitigations"]
        table = ["| | live: restored, motor | study: restored, motor |", "| --- | --- | --- |"]
        for name, one in live.items():
            other = inside["force" if name == "C" else name]
            table.append(f"| `{name}` | {100 * one['restored']:.0f} %, {one['motor_n']:.1f} N | "
                         f"{100 * float(other['restored']):.0f} %, {float(other['motor [N]']):.1f} N |")
        print(*table, sep="\n", flush=True)
        self.assertEqual(set(live), {"C", *every})
        for name, one in live.items():
            of_study = "force" if name == "C" else name
            with self.subTest(name):
                low, high = share_bounds([row for row in people if row["mitigation"] == of_study],
                                         [row for row in people if row["mitigation"] == "none"])
                self.assertTrue(low <= one["restored"] <= high, (low, one["restored"], high))
                # The platform's RMS is fixed, so the force of a person's motor is too: twice or half is another loop.
                motor_n = float(inside[of_study]["motor [N]"])
                self.assertTrue(motor_n / 2 <= one["motor_n"] <= 2 * motor_n, (motor_n, one["motor_n"]))
        self.assert_same_in_one_process(lab, lab.out / "logs" / "config", *CORES)


if __name__ == "__main__":
    main()
