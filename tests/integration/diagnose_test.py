#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`stillhand diagnose` and `stillhand predict` as a user runs them: a planted effect is named and predicted from the
recording's inputs; the report; wrong input."""
import csv
import hashlib
import json
import math
import random
import subprocess

import lab_process
from verb_case import FolderCase

PLANTED = lab_process.BUILD / "tests" / "planted_recordings"


def columns(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    return {title.split(" [")[0]: [float(row[i]) for row in rows[1:]] for i, title in enumerate(rows[0])}


class DiagnoseTest(FolderCase):
    def planted(self, kind):
        subprocess.run([str(PLANTED), "--out", str(self.folder / kind), "--count", "1", "--seed", "7", "--kind", kind,
                        "--strength", "0.25", "--snr", "40", "--length", "60"], check=True, capture_output=True, timeout=120)
        return next((self.folder / kind).glob("*.csv"))

    def test_a_planted_effect_is_named_saved_and_predicted(self):
        recording = self.planted("coupled_input")
        out, model, report = self.folder / "out.json", self.folder / "model.json", self.folder / "report"
        self.run_verb("diagnose", recording, "--json", out, "--save", model, "--report", report)
        verdict = json.loads(out.read_text())
        self.assertEqual(verdict["verdict"], "effects found")
        self.assertEqual(verdict["effects"][0]["kind"], "coupled_input")
        self.assertIsNotNone(verdict["effects"][0]["channel"])
        self.assertLess(verdict["effects"][0]["heldout_rmse_after"], verdict["effects"][0]["heldout_rmse_before"])
        low, high = verdict["effects"][0]["ci95"]
        self.assertLess(low, high)
        self.assertTrue(list(report.glob("*.html")))
        prediction = self.folder / "pred.csv"
        self.run_verb("predict", model, recording, "--out", prediction)
        measured, predicted = columns(recording), columns(prediction)
        force = dict(zip(measured["t"], measured["f"]))
        self.assertEqual(list(predicted), ["t", "f_model", "f"])
        # The first five seconds carry the start from rest.
        errors = [f - force[t] for t, f in zip(predicted["t"], predicted["f_model"]) if t > 5.0 and t in force]
        self.assertGreater(len(errors), 5000)
        rms = math.sqrt(sum(e * e for e in errors) / len(errors))
        self.assertLess(rms, 1.1 * verdict["final"]["heldout_rmse"])
        # The inputs alone do: no column f, or one that is called otherwise.
        with open(recording, newline="") as file:
            rows = list(csv.reader(file))
        at = [title.split(" [")[0] for title in rows[0]].index("f")
        bare = self.folder / "bare.csv"
        bare.write_text("\n".join(",".join(row[:at] + row[at + 1:]) for row in rows) + "\n")
        self.run_verb("predict", model, bare, "--out", self.folder / "bare_pred.csv")
        alone = columns(self.folder / "bare_pred.csv")
        self.assertEqual(alone, {name: predicted[name] for name in ("t", "f_model")})

    def test_nothing_planted_nothing_found(self):
        out = self.folder / "out.json"
        self.run_verb("diagnose", self.planted("none"), "--json", out)
        verdict = json.loads(out.read_text())
        self.assertEqual((verdict["verdict"], verdict["effects"], verdict["unexplained"]), ("nothing missing", [], None))

    def test_what_cannot_be_diagnosed_is_refused_in_one_line(self):
        rows = [(n / 100, math.sin(n * 0.37), math.cos(n * 0.11)) for n in range(3000)]
        texts = {
            "constant": ("t [s],a_y [m/s^2],f [N]\n" + "".join(f"{t},1,{f}\n" for t, _, f in rows), "constant"),
            "output_is_input": ("t [s],a_y [m/s^2],f [N]\n" + "".join(f"{t},{a},{2 * a}\n" for t, a, _ in rows), "itself"),
            "without_input": ("t [s],f [N]\n" + "".join(f"{t},{f}\n" for t, _, f in rows), "a_y"),
            "constant_output": ("t [s],a_y [m/s^2],f [N]\n" + "".join(f"{t},{a},2\n" for t, a, _ in rows), "constant"),
        }
        for name, (text, said) in texts.items():
            with self.subTest(name):
                path = self.folder / f"{name}.csv"
                path.write_text(text)
                out = self.folder / f"{name}.json"
                self.refused_for(said, "diagnose", path, "--json", out)
                self.assertFalse(out.exists())

    def test_times_in_milliseconds_are_refused_by_every_verb(self):
        path, model = self.folder / "ms.csv", self.folder / "model.json"
        self.run_verb("diagnose", self.planted("none"), "--most-effects", 0, "--save", model)
        path.write_text("t [s],a_y [m/s^2],f [N]\n" + "".join(
            f"{10 * n},{math.sin(n * 0.37)},{math.cos(n * 0.11)}\n" for n in range(3000)))
        for words in (("diagnose", path), ("identify", path), ("predict", model, path, "--out", self.folder / "p.csv")):
            with self.subTest(words[0]):
                said = self.refused(*words)
                self.assertIn("ms.csv, time", said)
                self.assertIn("=t [ms]", said)  # the line that mends it
        self.run_verb("diagnose", path, "--most-effects", 0, "--map", "t [s]=t [ms]", "a_y=a_y", "f=f")

    def test_places_that_cannot_be_written_are_refused_before_anything_is_read(self):
        file, gone = self.folder / "file", self.folder / "gone.csv"
        file.write_text("earlier")
        wrong = [("--report", file), ("--report", file / "below"), ("--report", "/proc/none"), ("--report", ""),
                 ("--json", self.folder), ("--json", self.folder / "no" / "out.json"), ("--json", ""),
                 ("--save", self.folder), ("--save", self.folder / "no" / "model.json"), ("--save", "")]
        # A recording that isn't there would be refused instead, were it read first.
        for option, place in wrong:
            with self.subTest(f"diagnose {option} {place}"):
                self.refused_for(option, "diagnose", gone, option, place)
        for option, place in wrong[4:]:
            with self.subTest(f"identify {option} {place}"):
                self.refused_for(option, "identify", gone, option, place)
        for place in (self.folder, self.folder / "no" / "p.csv", ""):
            with self.subTest(f"predict {place}"):
                self.refused_for("--out", "predict", gone, gone, "--out", place)
        self.assertEqual(file.read_text(), "earlier")
        self.assertEqual([path.name for path in self.folder.iterdir()], ["file"])

    def test_a_recording_given_twice_is_refused(self):
        recording = self.planted("none")
        self.refused_for("the same file", "diagnose", recording, recording.parent / "." / recording.name)

    def test_a_plan_of_other_recordings_is_refused(self):
        before, run = self.planted("coupled_input"), self.planted("delay")
        digests = [hashlib.sha256(path.read_bytes()).hexdigest() for path in (before, run)]
        plan = self.folder / "plan.json"

        def refused(sources):
            plan.write_text(json.dumps({"provenance": {
                "version": "1", "date": "2026-11-27T00:00:00Z", "command": "stillhand plan-run",
                "sources": [{"name": "a.csv", "sha256": digest} for digest in sources]}}))
            return self.refused("diagnose", before, run, "--plan", plan)

        self.assertIn("a plan of other recordings", refused(digests[1:]))
        self.assertIn("a plan of other recordings", refused(digests))
        # Of these recordings, it is read on.
        self.assertIn("a file without candidates", refused(digests[:1]))

    def test_an_input_that_moves_nothing_explains_nothing(self):
        noise = random.Random(3)
        inputs = {
            "unrelated": lambda n: noise.gauss(0.0, 1.0),
            "far_too_slow": lambda n: 1e-3 * math.sin(2.0 * math.pi * n / 2500),
            "every_other_sample": lambda n: (-1.0) ** n,
        }
        for name, of_sample in inputs.items():
            with self.subTest(name):
                path, out = self.folder / f"{name}.csv", self.folder / f"{name}.json"
                path.write_text("t [s],a_y [m/s^2],f [N]\n" + "".join(
                    f"{n / 100},{of_sample(n)},{noise.gauss(0.0, 1.0)}\n" for n in range(6000)))
                self.run_verb("diagnose", path, "--json", out)
                self.assertEqual(json.loads(out.read_text())["effects"], [])

    def test_wrong_channels_and_models_are_refused(self):
        recording = self.planted("none")
        self.refused_for("a_q", "diagnose", recording, "--input", "a_q")
        self.refused_for("the output", "diagnose", recording, "--input", "f")
        for name, text in {"broken.json": "{", "other.json": '{"format": "stillhand model"}', "list.json": "[]"}.items():
            with self.subTest(name):
                (self.folder / name).write_text(text)
                self.refused("predict", self.folder / name, recording, "--out", self.folder / "p.csv")
                self.assertFalse((self.folder / "p.csv").exists())

    def test_a_control_model_is_made_with_the_recording_that_was_diagnosed_alone(self):
        recording, other, model = self.planted("none"), self.folder / "other.csv", self.folder / "model.json"
        self.run_verb("diagnose", recording, "--most-effects", "0", "--save", model)
        other.write_text("\n".join(recording.read_text().splitlines()[:-1]) + "\n")
        line = self.refused("control-model", model, other, "--save", self.folder / "control.json")
        self.assertIn(recording.name, line)
        self.run_verb("control-model", model, recording, "--save", self.folder / "control.json")


if __name__ == "__main__":
    lab_process.main(PLANTED)
