#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`stillhand experiment export`: the data set of an experiment, next to its recordings and its study.

The validator of BIDS (npm package bids-validator) judges it in the campaign, or wherever the program is on the path.
"""
import hashlib
import importlib
import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import tarfile

import numpy

import lab_process
from lab_process import BUILD, campaign
from sample_experiment import (WRITE_SAMPLE, SampleExperimentCase, conduct, new_experiment, rows, stillhand,
                               unblind)

PARTICIPANTS = 5
VALIDATOR = "bids-validator@1.15.0"
VALIDATOR_LIMIT_S = 300
# Columns of a motion file, as the recording's own table names them: topic's table, column.
SENSED = {"a_x": "accel_x_m_s2", "a_y": "accel_y_m_s2", "a_z": "accel_z_m_s2", "roll": "roll_rad", "theta": "theta_rad",
          "omega": "omega_rad_s", "f": "force_n"}


def tab_rows(file):
    return rows(file, "\t")


def motion(file):
    """Samples [rows x channels] of a motion file; NaN where it has n/a."""
    return numpy.genfromtxt(file, delimiter="\t", missing_values="n/a", filling_values=numpy.nan, ndmin=2)


def held(samples):
    """A lost sample is the one before it, as in the study."""
    lost = numpy.isnan(samples).any(axis=1)
    return samples[numpy.maximum.accumulate(numpy.where(lost, 0, numpy.arange(len(samples))))]


def channels(file):
    return [row["name"] for row in tab_rows(str(file).replace("_motion.tsv", "_channels.tsv"))]


class ExportTestCase(SampleExperimentCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        new_experiment(cls.experiment, PARTICIPANTS, "--title", "Five people")
        conduct(cls.experiment)
        cls.blinded = stillhand("experiment", "export", cls.experiment, "--out", cls.folder / "early", "--bids",
                                status=2)
        unblind(cls.experiment)
        cls.set = cls.folder / "set"
        cls.said = stillhand("experiment", "export", cls.experiment, "--out", cls.set, "--bids", "--license", "CC0-1.0",
                             "--author", "The Laboratory")[0]

    def files(self, pattern):
        found = sorted(self.set.glob(pattern))
        self.assertTrue(found, pattern)
        return found


class BidsTest(ExportTestCase):
    def test_a_blinded_experiment_is_refused(self):
        self.assertIn("still blinded", self.blinded[1])
        self.assertEqual(len(self.blinded[1].splitlines()), 1)
        self.assertFalse((self.folder / "early").exists())

    def test_every_recorded_trial_is_a_run_with_its_channels(self):
        # A pegged trial and A, B, C of each; P02 has one more, which was ended early; P03 two pegged trials.
        found = self.files("sub-*/ses-*/motion/*_motion.tsv")
        self.assertEqual(len(found), 4 * PARTICIPANTS + 2)
        for file in found:
            samples = motion(file)
            side = json.loads(pathlib.Path(str(file).replace(".tsv", ".json")).read_text())
            self.assertEqual(samples.shape[1], len(channels(file)))
            self.assertEqual(side["MotionChannelCount"], samples.shape[1])
            self.assertEqual(side["RecordingDuration"] * side["SamplingFrequency"], samples.shape[0])
            self.assertEqual(samples.shape[0], 2500 if "sub-P02" in file.name and "run-01" in file.name else 5000)

    def test_the_samples_are_those_of_the_recording_bit_for_bit(self):
        for code, session, run in (("P01", "01", "00"), ("P01", "01", "02"), ("P04", "01", "01")):
            with self.subTest(code=code, run=run):
                recording = self.experiment / "participants" / code / "sessions" / session / "session.mcap"
                tables = self.folder / f"tables-{code}-{run}"
                stillhand("export", recording, "--csv", tables)
                control = rows(tables / "stillhand_trial_control.csv")
                start = next(int(row["start_tick [ticks]" if "start_tick [ticks]" in row else "start_tick [-]"])
                             for row in control if int(row["trial [-]"]) == int(run))
                recorded = {int(row["tick [-]"]): row for row in rows(tables / "stillhand_sensed.csv")}
                [file] = self.files(f"sub-{code}/ses-{session}/motion/*_run-{run}_motion.tsv")
                samples, names = motion(file), channels(file)
                lost = 0
                for n, sample in enumerate(samples):
                    row = recorded.get(start + n)
                    lost += row is None
                    for name, column in SENSED.items():
                        value = sample[names.index(name)]
                        if row is None:
                            self.assertTrue(numpy.isnan(value))
                            continue
                        [cell] = [text for key, text in row.items() if key.startswith(column + " ")]
                        self.assertEqual(value, float(cell))
                self.assertEqual(lost, 101 if code == "P04" else 0)

    def test_the_results_are_those_of_the_study_and_of_numpy_on_the_samples(self):
        stillhand("study", "--sessions", self.experiment, "--out", self.folder / "study")
        study = {(row["participant"], row["session"], int(row["trial"])): row
                 for row in rows(self.folder / "study" / "trials.csv")}
        seen = 0
        for file in self.files("sub-*/ses-*/beh/*_task-tracking_beh.tsv"):
            code, session = re.match(r"sub-(P\d\d)_ses-(\d\d)_", file.name).groups()
            for row in tab_rows(file):
                own = study.get((code, session, int(row["run"])))
                if code == "P05":  # excluded: in the data set, and not in the study
                    self.assertIsNone(own)
                elif row["rms_error"] == "n/a":
                    self.assertIsNone(own)
                    self.assertEqual(row["completed"], "no")
                    continue
                else:
                    seen += 1
                    self.assertEqual(row["rms_error"], own["rms error [mm]"])
                    self.assertEqual(row["dwell_ratio"], own["dwell ratio [-]"])
                    self.assertEqual(row["condition"], own["condition"])
                [samples] = self.files(f"sub-{code}/ses-{session}/motion/*_task-tracking_*_run-{row['run']}_motion.tsv")
                names = channels(samples)
                kept = held(motion(samples))[::10]
                error_m = kept[:, names.index("x_r")] - kept[:, names.index("x_p")]
                self.assertAlmostEqual(float(row["rms_error"]), 1e3 * numpy.sqrt(numpy.mean(error_m ** 2)), delta=1e-9)
                self.assertAlmostEqual(float(row["dwell_ratio"]), numpy.mean(abs(error_m) < 0.015), delta=1e-9)
        self.assertEqual(seen, 3 * (PARTICIPANTS - 1))

    def test_participants_are_codes_and_no_text_of_a_person_is_in_the_set(self):
        people = tab_rows(self.set / "participants.tsv")
        self.assertEqual([row["participant_id"] for row in people], [f"sub-P0{n}" for n in range(1, 6)])
        self.assertEqual([row["excluded"] for row in people], ["no"] * 4 + ["yes"])
        self.assertEqual({row["simulated"] for row in people}, {"yes"})
        self.assertEqual([row["sessions"] for row in people], ["1", "1", "2", "1", "1"])
        self.assertEqual({"".join(sorted(row["order"].split())) for row in people}, {"ABC"})
        # Journals and recordings hold "Anna", times of day and this machine's name; the set does not.
        personal = re.compile(rf"Anna|anna|sneezed|felt sick|\d\dT\d\d:|{re.escape(socket.gethostname())}")
        for file in self.files("**/*"):
            if file.is_file():
                self.assertIsNone(personal.search(file.read_text()), file)

    def test_the_checksums_hold_for_every_file(self):
        done = subprocess.run(["sha256sum", "--check", "--quiet", "SHA256SUMS"], cwd=self.set, check=False,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout)
        listed = {line.split("  ")[1] for line in (self.set / "SHA256SUMS").read_text().splitlines()}
        there = {str(file.relative_to(self.set)) for file in self.set.rglob("*") if file.is_file()}
        self.assertEqual(listed, there - {"SHA256SUMS"})

    def test_two_exports_have_the_same_bytes(self):
        again = self.folder / "again"
        stillhand("experiment", "export", self.experiment, "--out", again, "--bids", "--license", "CC0-1.0", "--author",
                  "The Laboratory")
        self.assertEqual((again / "SHA256SUMS").read_text(), (self.set / "SHA256SUMS").read_text())

    def test_the_description_states_licence_authors_and_version(self):
        description = json.loads((self.set / "dataset_description.json").read_text())
        self.assertEqual(description["License"], "CC0-1.0")
        self.assertEqual(description["Authors"], ["The Laboratory"])
        self.assertEqual(description["Name"], "Five people")
        self.assertRegex((self.set / "CHANGES").read_text(), r"^1\.0\.0 \d{4}-\d\d-\d\d\n  - ")
        yaml = (self.set / "sourcedata" / "experiment.yaml").read_bytes()
        self.assertEqual(yaml, (self.experiment / "experiment.yaml").read_bytes())
        self.assertIn(hashlib.sha256(yaml).hexdigest(), (self.set / "README").read_text())

    def test_authors_may_be_several_and_do_not_take_the_folder_for_one(self):
        out = self.folder / "authors"
        stillhand("experiment", "export", "--bids", "--out", out, "--author", "One", "--author", "Two", self.experiment)
        self.assertEqual(json.loads((out / "dataset_description.json").read_text())["Authors"], ["One", "Two"])

    def not_exported(self, said, *words):
        self.refused_for(said, "experiment", "export", *words)

    def test_what_cannot_be_exported_is_one_line(self):
        self.not_exported("which holds something", self.experiment, "--out", self.set, "--bids")
        self.not_exported("without experiment.yaml", self.folder, "--out", self.folder / "none", "--bids")
        self.not_exported("--bids", self.experiment, "--out", self.folder / "none")
        self.not_exported("more than one", self.experiment, "--out", self.folder / "none", "--bids", "--mat")
        copy = self.folder / "copy"
        shutil.copytree(self.experiment, copy)
        session = copy / "participants" / "P01" / "sessions" / "01"
        # Cut off behind its session: the last trials are gone, and the journal knows them.
        os.truncate(session / "session.mcap", (session / "session.mcap").stat().st_size // 2)
        self.not_exported("in session.mcap", copy, "--out", self.folder / "none", "--bids")
        (session / "session.mcap").unlink()
        self.not_exported("missing", copy, "--out", self.folder / "none", "--bids")
        shutil.copy(self.experiment / "participants" / "P02" / "sessions" / "01" / "session.mcap", session)
        self.not_exported("a recording of participant P02", copy, "--out", self.folder / "none", "--bids")
        shutil.rmtree(copy / "participants")
        (copy / "participants").mkdir()
        self.not_exported("without a recorded trial", copy, "--out", self.folder / "none", "--bids")
        self.assertFalse((self.folder / "none").exists())


class TablesTest(ExportTestCase):
    """The plain tables next to the BIDS data set of the same experiment."""

    def export(self, form):
        out = self.folder / form
        stillhand("experiment", "export", self.experiment, "--out", out, f"--{form}", "--license", "CC0-1.0")
        done = subprocess.run(["sha256sum", "--check", "--quiet", "SHA256SUMS"], cwd=out, check=False)
        self.assertEqual(done.returncode, 0)
        columns = json.loads((out / "columns.json").read_text())
        return out, columns

    def runs(self):
        """(name of the table, samples of BIDS without lost ones, names) of every trial."""
        for file in self.files("sub-*/ses-*/motion/*_motion.tsv"):
            code, session, run = re.match(r"sub-(P\d\d)_ses-(\d\d)_.*_run-(\d\d)_", file.name).groups()
            samples = motion(file)
            kept = ~numpy.isnan(samples).any(axis=1)
            times = numpy.arange(len(samples))[kept] / 1000
            yield f"{code}_session_{session}_trial_{run}", times, samples[kept], channels(file)

    def judge_trials(self, rms_errors):
        """RMS errors of all trials; NaN where there is none."""
        expected = [number for file in self.files("sub-*/ses-*/beh/*_task-tracking_beh.tsv")
                    for number in (row["rms_error"] for row in tab_rows(file))]
        found = [repr(float(value)) for value in rms_errors if not numpy.isnan(value)]
        self.assertEqual(found, [text for text in expected if text != "n/a"])

    def test_csv_has_the_same_numbers_and_every_verb_reads_it(self):
        out, columns = self.export("csv")
        for name, times, samples, names in self.runs():
            table = rows(out / f"{name}.csv")
            self.assertEqual([key.split(" [")[0] for key in table[0]], ["t", *names])
            values = numpy.array([[float(cell) for cell in row.values()] for row in table])
            numpy.testing.assert_array_equal(values, numpy.column_stack([times, samples]))
        trials = rows(out / "trials.csv")
        self.assertEqual({key.split(" [")[0] for key in trials[0]}, set(columns["trials"]) - {"run"})
        self.judge_trials([float(row["rms_error [mm]"] or "nan") for row in trials])
        stillhand("identify", out / "P01_session_01_trial_00.csv", "--json", self.folder / "found.json")
        self.assertIn("model", json.loads((self.folder / "found.json").read_text()))

    def test_matlab_has_the_same_numbers(self):
        scipy_io = self.import_or_skip("scipy.io")
        out, _ = self.export("mat")
        read = scipy_io.loadmat(out / "experiment.mat", squeeze_me=True)
        for name, times, samples, names in self.runs():
            table = read[name]
            numpy.testing.assert_array_equal(table["t"].item(), times)
            for column, channel in enumerate(names):
                numpy.testing.assert_array_equal(table[channel].item(), samples[:, column])
            self.assertEqual(table["meta"].item()["units"].item()["f"].item(), "N")
        self.judge_trials(read["trials"]["rms_error"].item())

    def test_hdf5_has_the_same_numbers(self):
        h5py = self.import_or_skip("h5py")
        out, _ = self.export("hdf5")
        with h5py.File(out / "experiment.h5") as read:
            for name, times, samples, names in self.runs():
                numpy.testing.assert_array_equal(read[name]["t"][()], times)
                for column, channel in enumerate(names):
                    numpy.testing.assert_array_equal(read[name][channel][()], samples[:, column])
                self.assertEqual(read[name]["a_y"].attrs["unit"], "m/s^2")
            self.judge_trials(read["trials"]["rms_error"][()])
            self.assertEqual([text.decode() for text in read["participants"]["participant"][()]],
                             [f"P0{n}" for n in range(1, 6)])

    def import_or_skip(self, name):
        try:
            return importlib.import_module(name)
        except ImportError:
            self.skipTest(f"{name} is not installed")


class ValidatorTest(ExportTestCase):
    def validator(self):
        """The program: on the path, or of the package from npm; its tarball is complete, so nothing else is installed."""
        if shutil.which("bids-validator"):
            return ["bids-validator"]
        place = BUILD / "tests" / "bids_validator"
        program = place / "package" / "bin" / "bids-validator"
        if not program.is_file():
            if shutil.which("npm") is None:
                self.skipTest("neither bids-validator nor npm is installed")
            place.mkdir(parents=True, exist_ok=True)
            packed = subprocess.run(["npm", "pack", VALIDATOR, "--json"], cwd=place, capture_output=True, text=True,
                                    timeout=VALIDATOR_LIMIT_S, check=False)
            if packed.returncode != 0:
                self.skipTest("npm cannot fetch " + VALIDATOR)
            with tarfile.open(place / json.loads(packed.stdout)[0]["filename"]) as package:
                package.extractall(place)
        return ["node", str(program)]

    def issues(self, program, folder):
        done = subprocess.run([*program, str(folder), "--json"], capture_output=True, text=True,
                              timeout=VALIDATOR_LIMIT_S, check=False)
        issues = json.loads(done.stdout)["issues"]
        return [[issue["key"] for issue in issues[kind]] for kind in ("errors", "warnings")]

    @campaign
    def test_the_validator_of_the_standard_finds_no_error(self):
        program = self.validator()
        errors, warnings = self.issues(program, self.set)
        self.assertEqual(errors, [])
        # It takes the first row of a motion file, which has no header, for one. P02 has more runs, P03 more sessions.
        self.assertEqual(set(warnings) - {"CUSTOM_COLUMN_WITHOUT_DESCRIPTION", "INCONSISTENT_SUBJECTS",
                                          "MISSING_SESSION", "TOO_FEW_AUTHORS"}, set())
        # It can find one: a motion file without its rate, and a file that the standard does not know.
        spoilt = self.folder / "spoilt"
        shutil.copytree(self.set, spoilt)
        side = next(spoilt.glob("sub-P01/ses-01/motion/*_motion.json"))
        side.write_text(side.read_text().replace('"SamplingFrequency"', '"Rate"'))
        (spoilt / ".bidsignore").unlink()
        errors, _ = self.issues(program, spoilt)
        self.assertIn("JSON_SCHEMA_VALIDATION_ERROR", errors)
        self.assertIn("NOT_INCLUDED", errors)


if __name__ == "__main__":
    lab_process.main(WRITE_SAMPLE)
