#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`stillhand lab --close live` over the bus: the watch finds that the arm stiffened, the pause identifies and
diagnoses, a person takes C+ on the terminal, and C runs again with it.

The watch needs twelve blocks of 4 s before it judges (cancellation, CC-20, ST-22): no short trial can show it.
"""
import os
import pty

import lab_process
from lab_process import TICKS_PER_S, LabTestCase, campaign, loose_settings
from virtual_display import VirtualDisplay, missing_tools

CHANGE_S = 110  # [s] of the session: 60 s after the trial of C began
ASYMMETRY = 1   # seed of an undeclared effect that a person's C+ carries
TRIAL_LIMIT_S = 300.0
PAUSE_LIMIT_S = 300.0
MODEL_OF_C_PLUS = 1000
MOST_FORCE_N = 25.0
MOST_STEP_N = 2.0  # a tick, 2000 N/s: the force envelope (signal, SG-6)
# The rig's seal is not known to the cores in one process.
CORES = ("SensingAnswersTheSame", "MotionAnswersTheSame", "CancellationAnswersTheSame", "DisplayAnswersTheSame",
         "TheSimulatedSubjectAnswersTheSame", "IdentificationFindsTheSameModel")


def changing_settings(folder):
    loose_settings(folder)
    (folder / "identification.yaml").write_text("false_alarms_h: 5\n")
    (folder / "rig.yaml").write_text(f"body:\n  neuromuscular:\n    change: 1.5\n    change_at_s: {CHANGE_S}\n")
    return folder


class LiveClosingTest(LabTestCase):
    def setUp(self):
        super().setUp()
        self.terminal, self.input = pty.openpty()
        self.addCleanup(os.close, self.terminal)
        self.addCleanup(os.close, self.input)
        self.display = VirtualDisplay()
        self.addCleanup(self.display.close)

    def said(self, words):
        return next((n for n, line in enumerate(self.lab_.errors()) if words in line), None)

    def wait_for_line(self, words, limit_s):
        self.lab_.wait_for(words, lambda: self.said(words) is not None, limit_s)

    @campaign
    def test_a_person_takes_the_c_plus_that_the_pause_found(self):
        config = changing_settings(self.folder / "config")
        self.lab_ = lab = self.lab(
            "--conditions", "C", "--close", "live", "--identify-seconds", 40, "--trial-seconds", 130, "--seed", 6,
            "--undeclared-effect", ASYMMETRY, "--config", config, headless=False, typed=self.input,
            environment=self.display.environment)
        self.wait_for_line("the model no longer holds since", TRIAL_LIMIT_S)
        self.wait_for_line("C+ offered for trial 3, asymmetry", PAUSE_LIMIT_S)
        os.write(self.terminal, b"y\n")
        self.wait_for_line("C+ taken for trial 3", 30.0)
        self.assertEqual(lab.end_status(TRIAL_LIMIT_S), 0, lab.errors())
        trials = {trial["number"]: trial["condition"] for trial in lab.summary()["trials"]}
        self.assertEqual(trials, {0: "I", 1: "C", 2: "I", 3: "C+"})
        changes = [mark for mark in lab.summary()["trials"][1]["marks"] if mark["what"] == "model no longer holds"]
        self.assertGreater(changes[0]["first_tick"], CHANGE_S * TICKS_PER_S)
        self.assert_commands_are_bounded(self.rows(lab.out / "session.mcap", "stillhand/motor_command"))
        self.run_verb("verify", lab.out / "session.mcap")
        self.assert_same_in_one_process(lab, config, *CORES)

    def assert_commands_are_bounded(self, commands):
        """One model before the pause and C+ behind it; every force within the limits of any model."""
        models = [int(row["model [-]"]) for row in commands if row["enabled [-]"] in ("1", "true")]
        self.assertEqual(list(dict.fromkeys(models)), [0, MODEL_OF_C_PLUS])
        force = [float(row["force_n [N]"]) for row in commands]
        tick = [int(row["tick [-]"]) for row in commands]
        self.assertLessEqual(max(map(abs, force)), MOST_FORCE_N)
        steps = (abs(b - a) / (u - t) for a, b, t, u in zip(force, force[1:], tick, tick[1:]) if u > t)
        self.assertLessEqual(max(steps), MOST_STEP_N * (1.0 + 1e-9))


if __name__ == "__main__":
    if missing_tools():
        lab_process.skip("not installed: " + ", ".join(missing_tools()))
    lab_process.main(lab_process.EQUIVALENCE)
