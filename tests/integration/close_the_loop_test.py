#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`stillhand close-the-loop` in one process: it finds the effect that the model lacks, the hand is stiller, and the sealed
truth is opened after the verdict is written.
"""
import json
import math
import os
import pathlib
import random
import shutil
import signal
import subprocess

import lab_process
from lab_process import STILLHAND, wait_for
from verb_case import FolderCase

SHORT = ["--trial-seconds", "60", "--identify-seconds", "60", "--seed", "3", "--repeats", "3"]
DATA = os.environ.get("STILLHAND_DATA", lab_process.SOURCE.parent / "shared" / "data")
METRICS = ("rms_error", "dwell_ratio", "crossover")


class LoopCase(FolderCase):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "loop"

    def assert_all_refused(self, *cases, then=()):
        """(arguments, a word of the line) of each; nothing is left behind."""
        for arguments, word in cases:
            self.refused_for(word, "close-the-loop", *arguments, *then)
            self.assertFalse(self.out.exists(), arguments)


class CloseTheLoopTest(LoopCase):
    def summary(self, *arguments):
        self.run_verb("close-the-loop", *SHORT, *arguments, "--out", self.out)
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
        self.assertIn("verdict.json: OK", self.assert_sealed(self.out))
        self.assertEqual(json.loads((self.out / "verdict.json").read_text()), summary["verdict"])
        report = (self.out / "report.html").read_text()
        self.assertIn("coupled_input", report)
        self.assertEqual(report.count("<svg"), 5)
        worth = summary["repair"]["effects"][0]
        self.assertEqual((worth["kind"], worth["channel"], worth["why_not"]), ("coupled_input", "a_x", None))
        for way in ("mended", "cancelled"):
            low, high = worth["change_mm"][way]["interval95"]
            self.assertTrue(low < worth["change_mm"][way]["mean"] < high < 0.0, way)
        self.assertIn(worth["advice"], ("mend", "cancel"))
        self.judge_model_as_a_file()

    def judge_model_as_a_file(self):
        """A session refuses a model file that was changed."""
        good = self.out / "control_model.json"
        text = good.read_text()
        edited = json.loads(text)
        edited["denominator"][1:3] = [-2.2, 1.3]
        for name, content, word in (("unstable", json.dumps(edited), "unit circle"),
                                    ("rig", text.replace('"rig": 1', '"rig": 2'), "rig"),
                                    ("newer", text.replace('"version": 2', '"version": 9'), "version"),
                                    ("forged", text.replace('"rig": 1', '"max_force_n": 90, "rig": 1'), "max_force_n"),
                                    ("cut", text[:200], "JSON"),
                                    ("diagnosed", (self.out / "model.json").read_text(), "control-model")):
            file = self.out.parent / f"{name}.json"
            file.write_text(content)
            lab = self.out.parent / "lab"
            line = self.refused("lab", "--model", file, "--conditions", "C", "--headless", "--out", lab)
            self.assertIn(str(file), line)
            self.assertIn(word, line)
            self.assertFalse(lab.exists())
        pipe = self.out.parent / "pipe"
        os.mkfifo(pipe)  # no process writes to it, so that reading it would never end
        for verb in (["lab", "--out", lab, "--headless", "--model"], ["diagnose"], ["info"], ["identify"]):
            self.refused_for("not a regular file", *verb, pipe, timeout=20)

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
        self.assert_sealed(self.out)

    def test_wrong_words_are_refused_before_anything_runs(self):
        taken = self.out.parent / "file"
        taken.write_text("mine\n")
        recorded = self.out.parent / "recorded"
        recorded.mkdir()
        (recorded / "session.mcap").write_text("mine\n")
        self.assert_all_refused(([*SHORT, "--out", taken], "--out"),
                                (["--trial-seconds", "1", "--out", self.out], "trial"),
                                (["--identify-seconds", "nan", "--out", self.out], "identif"),
                                (["--seed", "-4", "--out", self.out], "--seed"),
                                (["--undeclared-effect", "x", "--out", self.out], "--undeclared-effect"),
                                ([*SHORT, "--domain", 5, "--out", self.out], "--live"),
                                ([*SHORT, "--out", recorded], "recording"),
                                (["--repeats", 0, "--out", self.out], "--repeats"),
                                (["--repeats", 3, "--live", "--out", self.out], "--live"),
                                (["--off-catalogue", "--out", self.out], "--undeclared-effect"),
                                (["--subject", -1, "--out", self.out], "--subject"),
                                (["--threads", 999, "--out", self.out], "--threads"),
                                ([*SHORT], "--out"))
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


class FromRecordingsTest(LoopCase):
    """`--pegged`: two recordings of a stand that this test computes. f = body(a_y) + 1.5 kg body(a_x) + noise, body a
    second-order system of 3 Hz and damping ratio 0.4 with 3 N at 0 Hz for 1 m/s^2.
    """
    SECONDS, RATE_HZ, STEPS = 60, 100, 10
    CROSS_KG = 1.5

    def stand(self, name, seed):
        chance = random.Random(seed)
        motions = [[(chance.uniform(0.5, 4.0), chance.uniform(0.0, 6.28)) for _ in range(12)] for _ in range(2)]

        def motion(lines, t_s):
            return sum(0.5 * math.sin(2.0 * math.pi * hz * t_s + phase) for hz, phase in lines)
        natural_rad_s = 2.0 * math.pi * 3.0
        x = v = 0.0
        step_s = 1.0 / self.RATE_HZ / self.STEPS
        rows = ["t [s],a_y [m/s^2],a_x [m/s^2],f [N]"]
        for n in range(self.SECONDS * self.RATE_HZ):
            t_s = n / self.RATE_HZ
            a_y, a_x = (motion(lines, t_s) for lines in motions)
            force_n = -3.0 * x + chance.gauss(0.0, 0.2)
            rows.append(f"{t_s:.2f},{a_y:.6f},{a_x:.6f},{force_n:.6f}")
            for k in range(self.STEPS):
                drive = motion(motions[0], t_s + k * step_s) + self.CROSS_KG / 3.0 * motion(motions[1], t_s + k * step_s)
                v += step_s * (natural_rad_s ** 2 * (drive - x) - 0.8 * natural_rad_s * v)
                x += step_s * v
        path = self.folder / name
        path.write_text("\n".join(rows) + "\n")
        return path

    def constant(self):
        path = self.folder / "constant.csv"
        rows = (f"{n / 100.0:.2f},{math.sin(0.1 * n):.4f},{math.cos(0.13 * n):.4f},2.0" for n in range(3000))
        path.write_text("t [s],a_y [m/s^2],a_x [m/s^2],f [N]\n" + "\n".join(rows) + "\n")
        return path

    def test_the_effect_is_found_and_leaves_less_of_a_record_that_no_fit_has_seen(self):
        first, second = self.stand("first.csv", 1), self.stand("second.csv", 2)
        self.run_verb("close-the-loop", "--pegged", first, second, "--out", self.out)
        summary = json.loads((self.out / "summary.json").read_text())
        self.assertEqual((summary["verdict"]["kind"], summary["verdict"]["channel"]), ("coupled_input", "a_x"))
        self.assertTrue(summary["kept"])
        self.assertEqual(summary["decided_on"], "motor")
        self.assertGreater(summary["decision"]["less_interval95"][0], 0.0)
        self.assertEqual([record["source"] for record in summary["unseen"]], ["second.csv"])
        left = {name: summary["unseen"][0][name]["left"]["rms"] for name in ("linear", "augmented", "motor_augmented")}
        # The noise of 0.2 N is left in any case; the motor is 2 ms late, 5 % of a sine of 4 Hz.
        self.assertLess(left["augmented"], 0.25)
        self.assertGreater(left["linear"], 1.0)
        self.assertLess(left["motor_augmented"], 0.3)
        low, high = summary["unseen"][0]["augmented"]["cut_interval95"]
        self.assertTrue(low < summary["unseen"][0]["augmented"]["cut"] < high)
        self.assertEqual(json.loads((self.out / "control_model.json").read_text())["rate_hz"], 1000.0)
        self.assertEqual((self.out / "report.html").read_text().count("<svg"), 2)

        # With both accelerations as inputs the linear model lacks nothing.
        self.run_verb("close-the-loop", "--pegged", first, second, "--input", "a_y,a_x", "--out", self.folder / "both")
        both = json.loads((self.folder / "both" / "summary.json").read_text())
        self.assertEqual(both["inputs"], ["a_y", "a_x"])
        self.assertEqual(both["verdict"]["kind"], "none")
        self.assertLess(both["unseen"][0]["linear"]["left"]["rms"], 0.25)

    def test_one_file_has_one_verdict_in_diagnose_and_in_the_loop(self):
        first, second = self.stand("first.csv", 1), self.stand("second.csv", 2)
        for options, conclusion in (((), "effects found"), (("--least-force", 50), "nothing missing")):
            out, verdict = self.folder / f"loop{len(options)}", self.folder / f"verdict{len(options)}.json"
            self.run_verb("diagnose", first, "--json", verdict, *options)
            self.run_verb("close-the-loop", "--pegged", first, "--unseen", second, "--out", out, *options)
            alone = json.loads(verdict.read_text())
            summary = json.loads((out / "summary.json").read_text())
            loop = summary["verdict"]
            self.assertEqual((alone["verdict"], loop["conclusion"]), (conclusion, conclusion))
            same = ("kind", "channel", "heldout_rmse_before", "heldout_rmse_after", "force_n", "counts")
            self.assertEqual([[each[name] for name in same] for each in loop["findings"]],
                             [[each[name] for name in same] for each in alone["effects"]])
            self.assertEqual(len(loop["findings"]), 1)
        # What does not count is not put into the canceller.
        self.assertEqual(summary["treatments"], [])
        self.assertEqual(summary["unseen"][0]["motor_augmented"], summary["unseen"][0]["motor_linear"])

    def test_what_the_motor_leaves_decides_and_not_the_prediction(self):
        rides = [pathlib.Path(DATA) / "field" / f"arm_friction_ride_{each}.csv" for each in "ab"]
        if not all(ride.exists() for ride in rides):
            self.skipTest(f"no {rides[0]}; set STILLHAND_DATA")
        ran = self.run_verb("close-the-loop", "--pegged", rides[0], "--unseen", rides[1], "--map", "Time (s)=t [s]",
                            "Acc Y (g)=a_y [g]", "Force (lbf)=f [lbf]", "--out", self.out)
        summary = json.loads((self.out / "summary.json").read_text())
        self.assertEqual(summary["decided_on"], "motor")
        # Three springs explain this ride equally well, and rounding decides which is named; the canceller refuses one.
        linear, augmented = (summary["unseen"][0][name] for name in ("motor_linear", "motor_augmented"))
        interval = summary["decision"]["less_interval95"] if augmented else None
        self.assertEqual(summary["kept"], interval is not None and interval[0] > 0.0)
        if summary["kept"]:
            self.assertLess(augmented["left"]["rms"], linear["left"]["rms"])
        self.assertEqual(augmented is None, "did not run" in ran.stdout)
        self.assertIn("C+ is kept" if summary["kept"] else "C+ is not kept", ran.stdout)
        self.assertIn("C+ is kept" if summary["kept"] else "C+ is not kept", (self.out / "report.html").read_text())

    def test_wrong_words_are_refused_and_leave_nothing(self):
        first = self.stand("first.csv", 1)
        empty = self.folder / "empty.csv"
        empty.write_text("")
        copy = pathlib.Path(shutil.copy(first, self.folder / "copy.csv"))
        self.assert_all_refused((["--pegged", first, first], "--pegged"),
                                (["--pegged", first, "--unseen", first], "--unseen"),
                                (["--pegged", first, "--unseen", copy], "the same samples"),
                                (["--pegged", self.folder / "none.csv"], "--pegged"),
                                (["--pegged", empty], "empty.csv"),
                                (["--pegged", first, "--moving", first], "1000 Hz"),
                                (["--pegged", first, "--input", "a_q"], "a_q"),
                                (["--pegged", first, "--output", "g"], "--output"),
                                (["--pegged", first, "--unseen", self.constant()], "constant"),
                                (["--pegged", first, "--least-force", "nan"], "--least-force"),
                                (["--pegged", first, "--live"], "--live"),
                                (["--pegged", first, "--undeclared-effect", 3], "--undeclared-effect"),
                                (["--cancelled", first], "--pegged"), then=("--out", self.out))


if __name__ == "__main__":
    lab_process.main()
