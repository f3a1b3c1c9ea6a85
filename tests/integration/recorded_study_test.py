#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`stillhand study --sessions` of a session over DDS (ctest's fixture lab_run), and of two that were made without a
bus (write_sample_experiment.cpp).
"""
import json
import shutil

import lab_process
from lab_process import BUILD
from sample_experiment import conduct, new_experiment, rows, stillhand
from verb_case import SharedFolderCase

LIVE = BUILD / "tests" / "lab_run"


class RecordedStudyTest(SharedFolderCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sessions = []
        new_experiment(cls.folder / "experiment", 7, "--conditions", "A,B,C")
        conduct(cls.folder / "experiment")
        for code in ("P01", "P07"):  # the sample spoils a trial of each other participant
            (cls.folder / "experiment" / "participants" / code / "sessions" / "01").rename(cls.folder / code)
            cls.sessions.append(cls.folder / code)
        cls.out = cls.folder / "study"
        stillhand("study", "--sessions", *cls.sessions, "--out", cls.out)

    def test_the_participants_are_the_folders_and_the_report_is_there(self):
        recorded = json.loads((self.out / "summary.json").read_text())["recorded"]
        self.assertEqual(recorded["participants"], ["P01", "P07"])
        self.assertEqual(recorded["left_out"], [])
        self.assertIn("Table I", (self.out / "report.html").read_text())
        self.assertFalse((self.out / "subjects.csv").exists())

    def test_each_trial_has_the_error_that_its_session_found(self):
        stillhand("study", "--sessions", LIVE, "--out", self.folder / "live")
        found = {row["condition"]: float(row["rms error [mm]"])
                 for row in rows(self.folder / "live" / "trials.csv")}
        own = json.loads((LIVE / "summary.json").read_text())["conditions"]
        self.assertEqual(set(found), set("ABC"))
        for condition, error_mm in found.items():
            # The study takes every tenth sample: the error changes by far less than a thousandth.
            wanted = own[condition]["rms_error_mm"]["mean"]
            self.assertAlmostEqual(error_mm, wanted, delta=1e-3 * wanted)

    def not_studied(self, said, *folders):
        self.refused_for(said, "study", "--sessions", *folders, "--out", self.folder / "none")
        self.assertFalse((self.folder / "none").exists())

    def test_wrong_folders_are_refused(self):
        empty = self.folder / "empty"
        empty.mkdir()
        self.not_studied("without session.mcap", empty)
        (self.folder / "hollow" / "participants").mkdir(parents=True)
        self.not_studied("without a session", self.folder / "hollow")
        again = self.folder / "copies" / "P01"
        again.mkdir(parents=True)
        shutil.copy(self.sessions[0] / "session.mcap", again)
        self.not_studied("participant P01, session 01", self.sessions[0], again)
        self.refused_for("another folder", "study", "--sessions", self.sessions[0], "--out", self.sessions[0])


if __name__ == "__main__":
    lab_process.main()
