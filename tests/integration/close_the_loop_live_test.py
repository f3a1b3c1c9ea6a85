#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`stillhand close-the-loop --live`: the closed loop over DDS with every process, and Ctrl-C during it.

By default the trials last 5 s. With `--campaign` they last 15 s, and the model that the loop ends with runs in the
canceller of a session of its own.
"""
import json
import signal
import subprocess

import lab_process
from lab_process import INSPECT, STILLHAND, campaign, loose_settings, next_domain, wait_for
from verb_case import FolderCase

START_LIMIT_S = 60.0


def measuring(file):
    """Whether a recording holds the measured part of a trial yet."""
    inspected = subprocess.run([INSPECT, file, "1"], capture_output=True, text=True)
    found = json.loads(inspected.stdout) if inspected.returncode == 0 else {"trials": [], "rig": {"tick": []}}
    return any(trial["start_tick"] < tick for trial in found["trials"] for tick in found["rig"]["tick"][-1:])


class CloseTheLoopLiveTest(FolderCase):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "loop"

    def assert_loop_closes(self):
        self.run_verb("close-the-loop", "--live", "--domain", next_domain(), "--undeclared-effect", 9, "--seed", 3,
                      "--trial-seconds", 15, "--identify-seconds", 30, "--out", self.out)
        summary = json.loads((self.out / "summary.json").read_text())
        self.assertTrue(summary["live"])
        self.assertEqual(list(summary["conditions"]), ["A", "B", "C", "C'", "C+"])
        self.assertTrue(summary["truth"]["verdict_right"], summary["verdict"])
        # Trials this short show little of the tracking; they show that most of the force is cancelled. How much more in
        # C+ than in C, the hand's own force hides in one trial; close_the_loop_test repeats them.
        shares = {name: condition["cancelled_share"] for name, condition in summary["conditions"].items()}
        for name in ("C", "C'", "C+"):
            self.assertGreater(shares[name], 0.5, name)
        left = {name: condition["force_left_n"]["mean"] for name, condition in summary["conditions"].items()}
        self.assertLess(left["C+"], left["B"])
        self.assertIsNone(summary["conditions"]["C'"]["force_left_n"]["interval95"])
        for name in ("C", "C'", "C+"):
            causes = dict(summary["lateness"][name])
            whole = causes.pop("left")["force_n"]
            self.assertAlmostEqual(sum(cause["force_n"] for cause in causes.values()), whole, places=6)
            self.assertAlmostEqual(whole, left[name], delta=0.1 * whole)
        self.assert_sealed(self.out)
        messages = {topic["topic"]: topic["messages"] for topic in self.info(self.out / "session.mcap")["topics"]}
        self.assertGreaterEqual(messages["stillhand/augmented_model"], 1)
        models = {row["model [-]"] for row in self.rows(self.out / "session.mcap", "stillhand/motor_command")}
        self.assertTrue(models >= {"0", "1000"}, models)
        self.assertEqual(len(summary["rounds"][0]["weights"]), 2)

    @campaign
    def test_the_loop_closes_over_dds_and_its_model_runs_in_the_next_session(self):
        self.assert_loop_closes()
        again = self.folder / "again"
        ran = self.run_verb("lab", "--model", self.out / "control_model.json", "--conditions", "C", "--seed", 4,
                            "--trial-seconds", 10, "--identify-seconds", 5, "--config",
                            loose_settings(self.folder / "config"), "--headless", "--domain", next_domain(), "--out", again)
        self.assertIn("control_model.json", ran.stdout)
        condition = json.loads((again / "summary.json").read_text())["conditions"]["C"]
        self.assertGreater(condition["sensor_to_command_us"]["p50"], 0.0)
        enabled = {row["model [-]"] for row in self.rows(again / "session.mcap", "stillhand/motor_command")
                   if row["enabled [-]"] in ("1", "true")}
        self.assertEqual(enabled, {"1000"})

    # interrupt_test does the same to `lab`, by default.
    @campaign
    def test_ctrl_c_during_a_trial_leaves_a_whole_recording(self):
        process = subprocess.Popen([STILLHAND, "close-the-loop", "--live", "--domain", str(next_domain()),
                                    "--trial-seconds", "60", "--identify-seconds", "60", "--seed", "3",
                                    "--out", str(self.out)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        file = self.out / "session.mcap"
        wait_for("a trial's measured part", lambda: process.poll() is not None or measuring(file), START_LIMIT_S, 0.2)
        self.assertIsNone(process.poll(), "it ended by itself")
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=START_LIMIT_S)
        self.assertEqual(process.returncode, 1, errors)
        self.assertIn("interrupted", errors)
        # The recorder closed the file; a recorder that is killed leaves a file without an end.
        self.run_verb("verify", file)


if __name__ == "__main__":
    lab_process.main()
