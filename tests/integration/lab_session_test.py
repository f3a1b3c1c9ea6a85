# SPDX-License-Identifier: Apache-2.0
"""A whole session over DDS, once, and the results that it leaves in <build>/tests/lab_run.

This is ctest's fixture `lab_run`: other tests read this session's recording.
"""
import json
import math
import pathlib
import shutil
import tempfile
import unittest

import lab_process
from dashboard_test import PAGE, Dashboard
from lab_process import BUILD, SERVICES, LabProcess, running
from verb_case import stillhand

SEED = 1
TRIAL_S = 20
METRICS = ("rms_error_mm", "dwell_ratio", "crossover_hz")
STREAMS = {f"stillhand/{name}" for name in ("platform_command", "raw_sample", "rig_truth", "sensed", "motor_command",
                                           "tracking_sample", "operator_force")}
# The share of the feedthrough force that condition C cancels. In one process it is 0.674 to 0.712 with four
# lengths of the ramps: the involuntary force goes on over the trials. A millisecond of delay leaves at most
# 2 pi x 2 Hz x 1 ms = 0.013 of the force. The tolerance holds both.
CANCELLED_SHARE, CANCELLED_TOLERANCE = 0.70, 0.04
# Two digits of the page.
SHOWN_N = 0.01
# 40 s and 3 x 20 s measured, ramps and lead of each, matching, two fits, the evaluation: 125 s on two cores.
SESSION_LIMIT_S = 240


class LabSessionTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(BUILD / "tests" / "lab_run", ignore_errors=True)
        cls.lab = LabProcess(BUILD / "tests" / "lab_run", "--conditions", "A,B,C", "--trial-seconds", TRIAL_S,
                             "--seed", SEED)
        cls.addClassCleanup(cls.lab.close)
        cls.seen = {}

        def over():
            cls.seen.update(running(cls.lab.domain))
            return cls.lab.process.poll() is not None
        cls.lab.wait_for("the end", over, SESSION_LIMIT_S, poll_s=0.5)
        cls.left = cls.lab.wait_until_alone(limit_s=1.0)

    def setUp(self):
        self.assertEqual(self.lab.process.returncode, 0, self.lab.errors())
        self.summary = self.lab.summary()

    def metric(self, condition, metric):
        return self.summary["conditions"][condition][metric]["mean"]

    def test_every_service_is_a_process_of_its_own(self):
        self.assertEqual(sorted(self.seen.values()), sorted(["stillhand", *(f"stillhand-{s}" for s in SERVICES)]))
        self.assertGreaterEqual(len(self.seen), 8)

    def test_nothing_is_left_but_the_results(self):
        self.assertEqual(self.left, {})
        self.assertEqual(self.lab.shared_memory_left(), set())
        self.assertEqual({path.name for path in self.lab.out.iterdir()},
                         {"session.mcap", "summary.json", "model.json", "session.png", "session.svg", "session.csv",
                          "session.html", "logs"})
        self.assertEqual(self.lab.errors(), [])

    def test_summary_has_the_contract_s_shape(self):
        self.assertEqual(set(self.summary["conditions"]), {"A", "B", "C"})
        for condition in "ABC":
            for metric in METRICS:
                entry = self.summary["conditions"][condition][metric]
                self.assertEqual(set(entry), {"mean", "std", "per_subject"})
                self.assertTrue(math.isfinite(entry["mean"]))
                self.assertEqual(entry["per_subject"], [entry["mean"]])
        self.assertEqual(set(self.summary["restoration"]), {"rms_error", "dwell_ratio", "crossover"})
        # Tests over subjects need subjects.
        self.assertIsNone(self.summary["t_tests"])
        self.assertIsNone(self.summary["manova"])

    def test_every_trial_is_completed(self):
        conditions = [trial["condition"] for trial in self.summary["trials"]]
        self.assertEqual(conditions[0], "I")
        self.assertEqual(sorted(conditions[1:]), ["A", "B", "C"])
        for trial in self.summary["trials"]:
            self.assertTrue(trial["completed"], trial["aborted"])
            self.assertIsNone(trial["aborted"])

    # Crossover too: at this seed B's is near half of A's and C's, and a trial's own harmonics keep the lowest lines.
    def test_motion_disturbs_tracking_and_cancellation_restores_it(self):
        self.assertGreater(self.metric("B", "rms_error_mm"), self.metric("A", "rms_error_mm"))
        self.assertLess(self.metric("C", "rms_error_mm"), self.metric("B", "rms_error_mm"))
        for metric in ("dwell_ratio", "crossover_hz"):
            self.assertLess(self.metric("B", metric), self.metric("A", metric), metric)
            self.assertGreater(self.metric("C", metric), self.metric("B", metric), metric)

    def test_model_predicts_unseen_data_and_cancels_most_of_the_force(self):
        self.assertTrue(self.summary["identification"]["usable"])
        # What measured feedthrough studies report (services/core/rig/METHOD.md): no model of a_y explains a hand to the last.
        self.assertGreater(self.summary["identification"]["heldout_vaf_percent"], 88.0)
        self.assertLess(self.summary["identification"]["heldout_vaf_percent"], 97.0)
        self.assertAlmostEqual(self.summary["conditions"]["C"]["cancelled_share"], CANCELLED_SHARE,
                               delta=CANCELLED_TOLERANCE)
        # The motor is off in B.
        self.assertEqual(self.summary["conditions"]["B"]["cancelled_share"], 0.0)
        self.assertIsNone(self.summary["conditions"]["A"]["cancelled_share"])
        sensed = self.summary["conditions"]["C"]["cancelled_share_sensed"]
        self.assertLess(sensed["interval95"][0], sensed["mean"])
        # Of short trials; SN-7 sees the part that follows the acceleration alone.
        self.assertAlmostEqual(sensed["mean"], self.summary["conditions"]["C"]["cancelled_share"], delta=0.3)
        model = json.loads((self.lab.out / "model.json").read_text())
        self.assertTrue(model)

    # How many, a busy machine decides; a rig that does not wait, or never sees its answer, uses none.
    def test_ticks_use_the_command_that_answers_their_own_sample(self):
        self.assertGreater(self.summary["conditions"]["C"]["same_tick_share"], 0.0)
        self.assertLess(self.summary["conditions"]["C"]["sensor_to_force_us"]["p50"], 1000.0)

    def test_what_c_leaves_has_causes_that_add_up_to_it(self):
        for trial in self.summary["trials"]:
            if trial["condition"] != "C":
                self.assertIsNone(trial["lateness"])
                continue
            causes = {name: part["force_n"] for name, part in trial["lateness"].items()}
            left_n = causes.pop("left")
            self.assertEqual(set(causes), {"model", "lateness", "limits", "involuntary", "sensor"})
            self.assertAlmostEqual(sum(causes.values()), left_n, delta=1e-9)
            self.assertGreater(causes["model"], 0.0)

    def test_diagnose_and_the_page_say_the_same_of_lateness(self):
        want = next(trial for trial in self.summary["trials"] if trial["condition"] == "C")
        recording = self.lab.out / "session.mcap"
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "out.json"
            done = stillhand("diagnose", recording, "--trial", "C", "--most-effects", 0, "--json", file)
            self.assertEqual(done.returncode, 0, done.stderr)
            found, = json.loads(file.read_text())["lateness"]
        self.assertEqual(found, {"recording": str(recording), "trial": want["number"], **want["lateness"]})
        self.assertIn(f"leaves {want['lateness']['left']['force_n']:.2f} N", done.stdout)
        if not PAGE.is_file():
            self.skipTest("npm installed no page")
        dashboard = Dashboard("--recording", recording, "--unblinded")
        self.addCleanup(dashboard.close)
        cost = dashboard.snapshot()["cost"]
        self.assertEqual((cost["trial"], cost["length_s"]), (want["number"], TRIAL_S))
        for part in ("left", "lateness", "limits", "sensor"):
            at_the_end_n = want["lateness"][part]["force_n"]
            self.assertAlmostEqual(cost[f"{part}_n"], at_the_end_n, delta=max(0.05 * abs(at_the_end_n), SHOWN_N))
        self.assertAlmostEqual(sum(cost[f"{part}_n"] for part in ("lateness", "limits", "sensor", "rest")), cost["left_n"],
                               delta=1e-9)

    def test_lost_ticks_are_those_of_the_recording(self):
        recording = self.lab.recording(1)
        self.assertEqual(recording["damage"], [])
        self.assertEqual(set(self.summary["lost_ticks"]), STREAMS)
        self.assertEqual(self.summary["lost_ticks"], recording["lost_ticks"])
        measured = sum(trial["duration_ticks"] for trial in self.summary["trials"])
        for stream in STREAMS:
            self.assertGreater(recording["messages"][stream], measured, stream)


if __name__ == "__main__":
    lab_process.main()
