#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`stillhand study --sessions` of a session over DDS (ctest's fixture lab_run), and of two that were made without a
bus (write_sample_experiment.cpp).
"""
import json
import pathlib
import shutil
import subprocess
import tempfile
import unittest

import numpy
from scipy import stats

import lab_process
from lab_process import BUILD, STILLHAND
from sample_experiment import conduct, new_experiment, rows

LIVE = BUILD / "tests" / "lab_run"
COLUMNS = {"rms_error_mm": "rms error [mm]", "dwell_ratio": "dwell ratio [-]", "crossover_hz": "crossover [Hz]"}


def study(*arguments):
    return subprocess.run([STILLHAND, "study", *map(str, arguments)], capture_output=True, text=True, timeout=300)


class RecordedStudyTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.folder = pathlib.Path(holder.name)
        cls.sessions = []
        new_experiment(cls.folder / "experiment", 7, "--conditions", "A,B,C")
        conduct(cls.folder / "experiment")
        for code in ("P01", "P07"):  # the sample spoils a trial of each other participant
            (cls.folder / "experiment" / "participants" / code / "sessions" / "01").rename(cls.folder / code)
            cls.sessions.append(cls.folder / code)
        cls.run_result = study("--sessions", *cls.sessions, "--out", cls.folder / "study")

    def setUp(self):
        self.assertEqual(self.run_result.returncode, 0, self.run_result.stderr)
        self.out = self.folder / "study"
        self.summary = json.loads((self.out / "summary.json").read_text())
        self.trials = rows(self.out / "trials.csv")

    def values(self, metric, condition):
        """Of the exported table, in the order of the participants; NaN where there is none."""
        column = COLUMNS[metric]
        return numpy.array([float(row[column] or "nan") for row in self.trials if row["condition"] == condition])

    def test_the_participants_are_the_folders_and_the_report_is_there(self):
        self.assertEqual(self.summary["recorded"]["participants"], ["P01", "P07"])
        self.assertEqual(self.summary["recorded"]["left_out"], [])
        self.assertIn("Table I", (self.out / "report.html").read_text())
        self.assertFalse((self.out / "subjects.csv").exists())

    def test_each_trial_has_the_error_that_its_session_found(self):
        result = study("--sessions", LIVE, "--out", self.folder / "live")
        self.assertEqual(result.returncode, 0, result.stderr)
        found = {row["condition"]: float(row[COLUMNS["rms_error_mm"]])
                 for row in rows(self.folder / "live" / "trials.csv")}
        own = json.loads((LIVE / "summary.json").read_text())["conditions"]
        self.assertEqual(set(found), set("ABC"))
        for condition, error_mm in found.items():
            # The study takes every tenth sample: the error changes by far less than a thousandth.
            wanted = own[condition]["rms_error_mm"]["mean"]
            self.assertAlmostEqual(error_mm, wanted, delta=1e-3 * wanted)

    def test_the_figures_are_those_of_scipy_on_the_exported_table(self):
        for metric in COLUMNS:
            for condition in "ABC":
                values = self.values(metric, condition)
                if numpy.isnan(values).any():
                    continue
                found = self.summary["conditions"][condition][metric]
                self.assertAlmostEqual(found["mean"], numpy.mean(values), delta=1e-9)
                self.assertAlmostEqual(found["std"], numpy.std(values, ddof=1), delta=1e-9)
            for first, second in ("AB", "BC"):
                before, after = self.values(metric, first), self.values(metric, second)
                p = self.summary["t_tests"][f"{first}-{second}"][metric]
                if p is not None:
                    self.assertAlmostEqual(p, stats.ttest_rel(after, before).pvalue, delta=1e-9)
        self.assertIsNotNone(self.summary["t_tests"]["A-B"]["rms_error_mm"])

    def refused(self, said, *folders):
        result = study("--sessions", *folders, "--out", self.folder / "none")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(len(result.stderr.splitlines()), 1)
        self.assertIn(said, result.stderr)
        self.assertFalse((self.folder / "none").exists())

    def test_wrong_folders_are_refused(self):
        empty = self.folder / "empty"
        empty.mkdir()
        self.refused("without session.mcap", empty)
        (self.folder / "hollow" / "participants").mkdir(parents=True)
        self.refused("without a session", self.folder / "hollow")
        again = self.folder / "copies" / "P01"
        again.mkdir(parents=True)
        shutil.copy(self.sessions[0] / "session.mcap", again)
        self.refused("participant P01, session 01", self.sessions[0], again)
        result = study("--sessions", self.sessions[0], "--out", self.sessions[0])
        self.assertEqual(result.returncode, 2)
        self.assertIn("another folder", result.stderr)


if __name__ == "__main__":
    lab_process.main()
