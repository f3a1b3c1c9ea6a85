#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`stillhand close-the-loop` in one process: it finds the effect that the model lacks, the hand is stiller, and the sealed
truth is opened after the verdict is written.
"""
import json
import math
import os
import pathlib
import signal
import subprocess
import tempfile
import unittest

import lab_process
from lab_process import wait_for

STILLHAND = str(lab_process.STILLHAND)
SHORT = ["--trial-seconds", "60", "--identify-seconds", "60", "--seed", "3", "--repeats", "3"]
METRICS = ("rms_error", "dwell_ratio", "crossover")


def close_the_loop(*arguments, **options):
    return subprocess.run([STILLHAND, "close-the-loop", *map(str, arguments)], capture_output=True, text=True,
                          timeout=240, **options)


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
        self.assertEqual(list(summary["conditions"]), ["A", "B", "C", "C'", "C+"])
        for condition in summary["conditions"].values():
            self.assertEqual(len(condition["rms_error_mm"]["per_subject"]), 1)
        for of in ("restoration", "restoration_c_prime", "restoration_c_plus"):
            self.assertEqual(tuple(summary[of]), METRICS)
        self.assertGreater(summary["restoration_c_plus"]["rms_error"], summary["restoration"]["rms_error"])
        # An acceleration that the paper's model does not read: following gain and phase is not enough.
        left = {name: condition["force_left_n"]["mean"] for name, condition in summary["conditions"].items()}
        self.assertLess(left["C+"], left["C'"])
        self.assertLess(left["C'"], left["B"])
        self.assertLess(summary["paired"]["C'-C+"]["force_left_n"]["interval95"][1], 0.0)
        for condition in summary["conditions"].values():
            low, high = condition["rms_error_mm"]["interval95"]
            self.assertTrue(low < condition["rms_error_mm"]["mean"] < high)
            self.assertEqual(len(condition["rms_error_mm"]["repeats"]), 3)
        prediction = summary["force_prediction"]
        # The hand's own involuntary and unmeasured force is left: it is the noise floor.
        self.assertGreater(math.sqrt(prediction["before_rmse_n"] ** 2 - prediction["after_rmse_n"] ** 2), 0.7)
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
        os.mkfifo(pipe)  # no process writes to it, so that reading it would never end
        for verb in (["lab", "--out", lab, "--headless", "--model"], ["diagnose"], ["info"], ["identify"]):
            ran = subprocess.run([STILLHAND, *verb, pipe], capture_output=True, text=True, timeout=20)
            self.assertEqual(ran.returncode, 2, verb)
            self.assertIn("not a regular file", ran.stderr)

    def test_without_an_effect_nothing_is_named_and_nothing_is_worse(self):
        summary = self.summary()
        self.assertEqual(summary["verdict"], {"kind": "none", "channel": None, "where": None,
                                              "conclusion": "nothing missing", "findings": []})
        self.assertFalse(summary["rounds"][0]["augmented"])
        self.assertEqual(summary["conditions"]["C+"], summary["conditions"]["C'"])
        self.assertIsNone(summary["truth"])
        errors = {name: condition["rms_error_mm"]["mean"] for name, condition in summary["conditions"].items()}
        self.assertLessEqual(errors["C+"], errors["C"])
        self.assertFalse((self.out / "undeclared_effect.json").exists())

    def test_an_effect_outside_of_the_kinds_is_sealed_and_opened_the_same_way(self):
        summary = self.summary("--undeclared-effect", 4, "--off-catalogue")
        self.assertGreater(summary["truth"]["force_rms_n"], 0.0)
        self.assertGreater(summary["truth"]["detectable_n"], 0.0)
        checked = subprocess.run(["sha256sum", "--check", "--strict", "undeclared_effect.sha256"], cwd=self.out,
                                 capture_output=True, text=True)
        self.assertEqual(checked.returncode, 0, checked.stderr)

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
                                (["--repeats", 0, "--out", self.out], "--repeats"),
                                (["--repeats", 3, "--live", "--out", self.out], "--live"),
                                (["--off-catalogue", "--out", self.out], "--undeclared-effect"),
                                (["--subject", -1, "--out", self.out], "--subject"),
                                (["--threads", 999, "--out", self.out], "--threads"),
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
        self.addCleanup(process.kill)
        wait_for("the results' folder", self.out.exists, 60.0)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1, errors)
        self.assertFalse(self.out.exists())


if __name__ == "__main__":
    lab_process.main()
