#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`stillhand close-the-loop` as a user meets it: what was missing is found, the hand is stiller, the truth comes last.

In one process, and once over DDS with every process.
"""
import csv
import json
import os
import pathlib
import signal
import subprocess
import tempfile
import time
import unittest

from lab_process import INSPECT

BUILD = pathlib.Path(os.environ["STILLHAND_BUILD"])
STILLHAND = str(BUILD / "bin" / "stillhand")
SHORT = ["--trial-seconds", "60", "--identify-seconds", "60", "--seed", "3"]
METRICS = ("rms_error", "dwell_ratio", "crossover")


def close_the_loop(*arguments, **options):
    return subprocess.run([STILLHAND, "close-the-loop", *map(str, arguments)], capture_output=True, text=True,
                          timeout=240, **options)


def measuring(file):
    """Whether the measured part of a trial is in a recording so far."""
    told = subprocess.run([INSPECT, file, "1"], capture_output=True, text=True)
    found = json.loads(told.stdout) if told.returncode == 0 else {"trials": [], "rig": {"tick": []}}
    return any(trial["start_tick"] < tick for trial in found["trials"] for tick in found["rig"]["tick"][-1:])


class CloseTheLoopTest(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="stillhand-")
        self.addCleanup(temporary.cleanup)
        self.out = pathlib.Path(temporary.name) / "loop"

    def summary(self, *arguments):
        ran = close_the_loop(*SHORT, *arguments, "--out", self.out)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        return json.loads((self.out / "summary.json").read_text())

    def test_what_was_missing_is_found_and_makes_the_hand_stiller(self):
        summary = self.summary("--undeclared-effect", 9)
        self.assertEqual(list(summary["conditions"]), ["A", "B", "C", "C+"])
        for condition in summary["conditions"].values():
            self.assertEqual(len(condition["rms_error_mm"]["per_subject"]), 1)
        for of in ("restoration", "restoration_c_plus"):
            self.assertEqual(tuple(summary[of]), METRICS)
        self.assertGreater(summary["restoration_c_plus"]["rms_error"], summary["restoration"]["rms_error"])
        self.assertGreater(summary["conditions"]["C+"]["cancelled_share"], summary["conditions"]["C"]["cancelled_share"])
        prediction = summary["force_prediction"]
        self.assertLess(prediction["after_rmse_n"], 0.5 * prediction["before_rmse_n"])
        self.assertLess(prediction["after_over_noise"], 1.3)
        self.assertEqual((summary["verdict"]["kind"], summary["verdict"]["channel"]), ("coupled_input", "a_x"))
        self.assertEqual((summary["truth"]["kind"], summary["truth"]["channel"]), ("coupled_input", "a_x"))
        self.assertTrue(summary["truth"]["verdict_right"])
        # The digests prove that the truth was there before, and that the verdict is the one it was opened for.
        checked = subprocess.run(["sha256sum", "--check", "--strict", "undeclared_effect.sha256"], cwd=self.out,
                                 capture_output=True, text=True)
        self.assertEqual(checked.returncode, 0, checked.stderr)
        self.assertIn("verdict.json: OK", checked.stdout)
        self.assertEqual(json.loads((self.out / "verdict.json").read_text()), summary["verdict"])
        report = (self.out / "report.html").read_text()
        self.assertIn("coupled_input", report)
        self.assertEqual(report.count("<svg"), 4)

    def test_over_dds_it_is_the_same_loop_and_the_recording_is_kept(self):
        ran = close_the_loop("--live", "--domain", 71, "--undeclared-effect", 9, "--seed", 3, "--trial-seconds", 15,
                             "--identify-seconds", 30, "--out", self.out)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        summary = json.loads((self.out / "summary.json").read_text())
        self.assertTrue(summary["live"])
        self.assertEqual(list(summary["conditions"]), ["A", "B", "C", "C+"])
        self.assertTrue(summary["truth"]["verdict_right"], summary["verdict"])
        # Trials this short say little of tracking; how much of the force went is plain all the same.
        self.assertGreater(summary["conditions"]["C+"]["cancelled_share"], summary["conditions"]["C"]["cancelled_share"])
        checked = subprocess.run(["sha256sum", "--check", "--strict", "undeclared_effect.sha256"], cwd=self.out,
                                 capture_output=True, text=True)
        self.assertEqual(checked.returncode, 0, checked.stderr)
        told = self.out / "info.json"
        subprocess.run([STILLHAND, "info", self.out / "session.mcap", "--json", told], check=True,
                       stdout=subprocess.DEVNULL)
        messages = {topic["topic"]: topic["messages"] for topic in json.loads(told.read_text())["topics"]}
        self.assertGreaterEqual(messages["stillhand/augmented_model"], 1)
        rows = self.out / "tables"
        subprocess.run([STILLHAND, "export", self.out / "session.mcap", "--csv", rows, "--topics",
                        "stillhand/motor_command"], check=True, stdout=subprocess.DEVNULL)
        with open(rows / "stillhand_motor_command.csv", encoding="utf-8", newline="") as table:
            models = {row["model [-]"] for row in csv.DictReader(table)}
        self.assertTrue(models >= {"0", "1000"}, models)
        self.assertEqual(len(summary["rounds"][0]["weights"]), 2)

        # The model that it ends with is a file that the next session's canceller takes.
        again = self.out.parent / "again"
        ran = subprocess.run([STILLHAND, "lab", "--model", self.out / "control_model.json", "--conditions", "C", "--seed", "4",
                              "--trial-seconds", "10", "--identify-seconds", "30", "--headless", "--domain", "71", "--out",
                              again], capture_output=True, text=True, timeout=240)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        self.assertIn("control_model.json", ran.stdout)
        condition = json.loads((again / "summary.json").read_text())["conditions"]["C"]
        self.assertGreater(condition["sensor_to_command_us"]["p50"], 0.0)
        subprocess.run([STILLHAND, "export", again / "session.mcap", "--csv", rows, "--topics", "stillhand/motor_command"],
                       check=True, stdout=subprocess.DEVNULL)
        with open(rows / "stillhand_motor_command.csv", encoding="utf-8", newline="") as table:
            ran_with = {row["model [-]"] for row in csv.DictReader(table) if row["enabled [-]"] in ("1", "true")}
        self.assertEqual(ran_with, {"1000"})

    def test_a_diagnosed_model_reaches_the_canceller_as_a_file(self):
        self.summary("--undeclared-effect", 9)
        good = self.out / "control_model.json"
        text = good.read_text()
        edited = json.loads(text)
        edited["denominator"][1:3] = [-2.2, 1.3]
        for name, content, word in (("unstable", json.dumps(edited), "unit circle"),
                                    ("rig", text.replace('"rig": 1', '"rig": 2'), "rig"),
                                    ("newer", text.replace('"version": 1', '"version": 9'), "version"),
                                    ("forged", text.replace('"rig": 1', '"max_force_n": 90, "rig": 1'), "max_force_n"),
                                    ("cut", text[:200], "JSON"),
                                    ("diagnosed", (self.out / "model.json").read_text(), "control-model")):
            file = self.out.parent / f"{name}.json"
            file.write_text(content)
            lab = self.out.parent / "lab"
            ran = subprocess.run([STILLHAND, "lab", "--model", file, "--conditions", "C", "--headless", "--out", lab],
                                 capture_output=True, text=True, timeout=60)
            self.assertEqual(ran.returncode, 2, name)
            self.assertEqual(ran.stderr.count("\n"), 1, ran.stderr)
            self.assertIn(str(file), ran.stderr)
            self.assertIn(word, ran.stderr)
            self.assertFalse(lab.exists())
        pipe = self.out.parent / "pipe"
        os.mkfifo(pipe)  # nobody writes it: waiting for that would be for ever
        for verb in (["lab", "--out", lab, "--headless", "--model"], ["diagnose"], ["info"], ["identify"]):
            ran = subprocess.run([STILLHAND, *verb, pipe], capture_output=True, text=True, timeout=20)
            self.assertEqual(ran.returncode, 2, verb)
            self.assertIn("not a regular file", ran.stderr)

    def test_without_an_effect_nothing_is_named_and_nothing_is_worse(self):
        summary = self.summary()
        self.assertEqual(summary["verdict"], {"kind": "none", "channel": None, "findings": []})
        self.assertIsNone(summary["truth"])
        errors = {name: condition["rms_error_mm"]["mean"] for name, condition in summary["conditions"].items()}
        self.assertLessEqual(errors["C+"], errors["C"])
        self.assertFalse((self.out / "undeclared_effect.json").exists())

    def test_wrong_words_are_refused_before_anything_runs(self):
        taken = self.out.parent / "file"
        taken.write_text("mine\n")
        recorded = self.out.parent / "recorded"
        recorded.mkdir()
        (recorded / "session.mcap").write_text("mine\n")
        for arguments, word in (([*SHORT, "--out", taken], "--out"),
                                (["--trial-seconds", "1", "--out", self.out], "trial"),
                                (["--identify-seconds", "nan", "--out", self.out], "identif"),
                                (["--seed", "-4", "--out", self.out], "--seed"),
                                (["--undeclared-effect", "x", "--out", self.out], "--undeclared-effect"),
                                ([*SHORT, "--domain", 5, "--out", self.out], "--live"),
                                ([*SHORT, "--rig", 5, "--out", self.out], "--live"),
                                ([*SHORT, "--out", recorded], "recording"),
                                ([*SHORT], "--out")):
            ran = close_the_loop(*arguments)
            self.assertEqual(ran.returncode, 2, arguments)
            self.assertEqual(ran.stderr.count("\n"), 1, ran.stderr)
            self.assertIn(word, ran.stderr)
            self.assertFalse(self.out.exists())
        self.assertEqual(taken.read_text(), "mine\n")
        self.assertEqual([file.name for file in recorded.iterdir()], ["session.mcap"])

    def test_ctrl_c_leaves_nothing(self):
        process = subprocess.Popen([STILLHAND, "close-the-loop", *SHORT, "--out", str(self.out)],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        deadline = time.monotonic() + 60
        while not self.out.exists() and time.monotonic() < deadline:
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        self.assertNotEqual(process.wait(timeout=60), 0)
        self.assertFalse(self.out.exists())
        process.communicate()

    def test_ctrl_c_during_a_live_trial_leaves_a_whole_recording(self):
        process = subprocess.Popen([STILLHAND, "close-the-loop", "--live", "--domain", "71", *SHORT, "--out", str(self.out)],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        file = self.out / "session.mcap"
        deadline = time.monotonic() + 60
        while not measuring(file) and time.monotonic() < deadline:
            self.assertIsNone(process.poll())
            time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1, said)
        self.assertIn("interrupted", said)
        # The recorder closed it; one that is killed leaves a file without an end.
        checked = subprocess.run([STILLHAND, "verify", file], capture_output=True, text=True)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
