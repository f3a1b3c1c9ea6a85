#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""An experiment with participants over real processes: short trials, kill -9 in the middle, resumed, complete.

The campaign conducts twelve simulated participants, two of them killed and resumed, one excluded, and keeps the folder
in STILLHAND_EXPERIMENT, if that is set.
"""
import hashlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess

from dashboard_test import Dashboard
from lab_process import (INSPECT, STILLHAND, LabTestCase, campaign, loose_settings, main, next_domain, running,
                         wait_for)
from sample_experiment import rows, stillhand

SESSION_LIMIT_S = 300.0
END_LIMIT_S = 60.0


def experiment(*words, status=0, typed=""):
    """Runs `stillhand experiment` to its end; returns (standard output, standard error)."""
    return stillhand("experiment", *words, status=status, input=typed)


def journal(folder, code):
    return [json.loads(line) for line in (folder / "participants" / code / "journal.jsonl").read_text().splitlines()]


def of_kind(entries, what):
    return [entry for entry in entries if entry["what"] == what]


def tree(folder):
    """Digest of every file, {path: SHA-256}."""
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(folder.rglob("*")) if path.is_file()}


class ExperimentTestCase(LabTestCase):
    def setUp(self):
        super().setUp()
        self.study = self.folder / "study"
        self.settings = loose_settings(self.folder / "settings")

    def new(self, *words):
        return experiment("new", self.study, "--trial-seconds", 5, "--identify-seconds", 5, "--seed", 11, *words)

    def edit(self, **values):
        """Changes every key of these names in experiment.yaml."""
        file = self.study / "experiment.yaml"
        text = file.read_text()
        for key, value in values.items():
            text, count = re.subn(rf"(?m)^( *){key}: .*$", rf"\g<1>{key}: {value}", text)
            self.assertGreaterEqual(count, 1, key)
        file.write_text(text)

    def augmented_model(self):
        """A file for C+: of an effect that the rig of close-the-loop holds, and that of the experiment does not."""
        loop = self.folder / "loop"
        self.run_verb("close-the-loop", "--undeclared-effect", 9, "--seed", 3, "--trial-seconds", 5, "--identify-seconds", 30,
                      "--out", loop)
        return loop / "control_model.json"

    def start(self, *words):
        """Starts `experiment run`; returns (process, domain)."""
        domain = next_domain()
        process = subprocess.Popen([str(STILLHAND), "experiment", "run", str(self.study), "--headless", "--domain",
                                    str(domain), "--config", str(self.settings), *map(str, words)],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   start_new_session=True)

        def end():
            if process.poll() is None:
                process.kill()
            process.communicate()
        self.addCleanup(end)
        return process, domain

    def run_to_the_end(self, *words):
        process, _ = self.start(*words)
        out, errors = process.communicate(timeout=SESSION_LIMIT_S)
        self.assertEqual(process.returncode, 0, errors)
        return out + errors

    def kill_in_a_trial(self, code, ended, *words):
        """Starts a session and kills it with signal 9 while the trial after `ended` completed ones runs."""
        process, domain = self.start("--participant", code, *words)
        file = self.study / "participants" / code / "journal.jsonl"

        def in_a_trial():
            entries = journal(self.study, code) if file.exists() else []
            done = [entry for entry in of_kind(entries, "trial ended") if entry["completed"] and "step" in entry]
            return len(done) >= ended and entries[-1]["what"] == "trial began"
        wait_for(f"{code} in a trial", in_a_trial, SESSION_LIMIT_S, ended=lambda: process.poll() is not None and
                 f"the session ended: {process.communicate()[1]}")
        process.send_signal(signal.SIGKILL)
        process.wait()
        wait_for("the end of the processes", lambda: not running(domain), END_LIMIT_S)


class SessionTest(ExperimentTestCase):
    def test_a_participant_who_is_killed_in_the_middle_is_resumed_and_completed(self):
        self.new("--conditions", "B,C", "--participants", 3, "--blocks", 2)
        self.edit(rest_s=0, break_s=1, trial_s=5, most_trials=1, dwell_ratio=1)
        self.kill_in_a_trial("P02", 2)
        before = tree(self.study)
        shown = self.run_to_the_end("--participant", "P02")
        self.assertIn("4 of 4 trials", shown)
        self.judge_journal()
        self.judge_recordings(before)
        self.judge_blinding(shown)
        self.judge_bad_folders()

    def judge_journal(self):
        entries = journal(self.study, "P02")
        self.assertEqual([entry["session"] for entry in of_kind(entries, "session began")], [1, 2])
        first_end = of_kind(entries, "session ended")[0]
        self.assertFalse(first_end["completed"])
        self.assertIn("no end in the journal", first_end["text"])
        self.assertTrue(of_kind(entries, "session ended")[1]["completed"])
        done = [entry["step"] for entry in of_kind(entries, "trial ended") if entry["completed"] and "step" in entry]
        # Practice (its criterion cannot be reached), then every trial once and in the plan's order.
        self.assertEqual(done[0], 0)
        self.assertEqual(len(set(done[1:])), 4)
        self.assertEqual(done[1:], sorted(done[1:]))
        labels = [entry["label"] for entry in of_kind(entries, "trial ended") if entry.get("label")]
        self.assertEqual(sorted(labels[:2]), ["X", "Y"])
        self.assertEqual(sorted(labels[2:]), ["X", "Y"])
        self.assertIn("dwell_ratio", of_kind(entries, "trial ended")[1])

    def judge_recordings(self, before):
        digest = hashlib.sha256((self.study / "experiment.yaml").read_bytes()).hexdigest()
        for session in ("01", "02"):
            file = self.study / "participants" / "P02" / "sessions" / session / "session.mcap"
            records = {record["name"]: record["texts"] for record in self.info(file)["metadata"]}
            self.assertEqual(records["stillhand.experiment"], {"participant": "P02", "digest": digest, "session": session})
        # The second session changes no file of the first.
        after = tree(self.study)
        for path, content in before.items():
            if "/sessions/01/" in path:
                self.assertEqual(after[path], content, path)

    def judge_blinding(self, shown):
        """No shown line, journal, log or file name has a condition until `unblind`."""
        word = re.compile(r"condition|cancelled|stationary|\bmoving\b|trial_label|\b[ABC]\b")
        self.assertIsNone(word.search(shown), shown)
        texts = [path for path in (self.study / "participants").rglob("*")
                 if path.suffix in (".jsonl", ".log") and path.is_file()]
        self.assertGreater(len(texts), 10)
        for path in texts:
            self.assertIsNone(word.search(path.read_text()), path)
        self.assertNotIn("assignment.json", os.listdir(self.study))
        self.refused_for("an experiment that is still blinded", "study", "--sessions", self.study, "--out",
                            self.folder / "report")
        self.assertIn("blinded", experiment("status", self.study)[0])
        self.assertIn("P01 (not begun), P03 (not begun)",
                      experiment("unblind", self.study, "--reason", "the end", status=2)[1])
        opened = json.loads(experiment("unblind", self.study, "--reason", "the end", "--incomplete", typed="study\n")[0])
        self.assertEqual([sorted(labels.values()) for labels in opened["labels"].values()],
                         [["B", "C"]] * len(opened["orders"]))
        trace = [json.loads(line) for line in (self.study / "journal.jsonl").read_text().splitlines()]
        self.assertEqual((trace[0]["what"], trace[0]["text"], trace[0]["complete"]), ("unblinded", "the end", 1))
        self.judge_conditions(opened)

    def judge_conditions(self, opened):
        """The opened assignment is what ran: B and C move, and the order is the one of the journal."""
        labels = [entry["label"] for entry in of_kind(journal(self.study, "P02"), "trial ended")
                  if entry["completed"] and entry.get("label")]
        self.assertEqual([opened["labels"]["P02"][label] for label in labels], opened["orders"]["P02"])
        self.judge_data_set(opened)

    def judge_data_set(self, opened):
        """The data set has practice, the killed trial and its repetition; the report is about the measured trials."""
        out = self.folder / "set"
        experiment("export", self.study, "--out", out, "--bids")

        def trials(task):
            files = sorted(out.glob(f"sub-P02/ses-*/beh/*_task-{task}_beh.tsv"))
            return [row for file in files for row in rows(file, "\t")]
        completed = [row["condition"] for row in trials("tracking") if row["completed"] == "yes"]
        self.assertEqual(completed, opened["orders"]["P02"])
        journaled = [entry["dwell_ratio"] for entry in of_kind(journal(self.study, "P02"), "trial ended")
                     if "dwell_ratio" in entry]
        # The journal has every tick of a trial of 5 s, the data set's result every tenth: each way into the box or out
        # of it moves the share by at most 10 of 5000 ticks, and in 5 s there are less than 25.
        for row, dwell_ratio in zip(trials("practice"), journaled, strict=True):
            self.assertAlmostEqual(float(row["dwell_ratio"]), dwell_ratio, delta=0.05)
        runs = {path.name for path in out.glob("sub-P02/ses-*/motion/*_motion.tsv")}
        self.assertEqual(sum("task-identification" in name for name in runs), 2)
        self.assertEqual(sum("task-tracking" in name for name in runs), len(trials("tracking")))
        experiment("report", self.study)
        summary = json.loads((self.study / "report" / "summary.json").read_text())
        self.assertEqual(summary["recorded"]["participants"], ["P02"])
        self.assertEqual(summary["recorded"]["trials"], 4)
        self.assertEqual(summary["registered"]["excluded"], [])
        self.assertEqual(summary["operator"], "simulated")
        self.assertEqual(summary["registered"]["standing"]["incomplete"], {"P01": "not begun", "P03": "not begun"})

    def judge_bad_folders(self):
        """Each is named in one line with status 2, and no file is changed."""
        def refused(words, *expected):
            before = tree(self.study)
            _, errors = experiment(*words, status=2)
            self.assertEqual(tree(self.study), before)
            self.assertEqual(len(errors.splitlines()), 1, errors)
            for word in expected:
                self.assertIn(word, errors)
        run = ("run", self.study, "--headless", "--config", self.settings)
        refused((*run, "--participant", "P02"), "complete")
        refused((*run, "--participant", "P04"), "P01 to P03")
        refused((*run, "--participant", "Ann"), "never a name")
        sessions = self.study / "participants" / "P02" / "sessions"
        (sessions / "01").rename(self.folder / "away")
        refused(("status", self.study), "sessions/01/session.mcap", "missing")
        shutil.copytree(sessions / "02", sessions / "01")
        refused(("status", self.study), "the recording of session 02")
        shutil.rmtree(sessions / "01")
        (self.folder / "away").rename(sessions / "01")
        shutil.copytree(sessions, self.study / "participants" / "P03" / "sessions")
        shutil.copy(sessions.parent / "journal.jsonl", self.study / "participants" / "P03")
        _, errors = experiment("status", self.study, status=2)
        self.assertIn("a recording of participant P02", errors)
        shutil.rmtree(self.study / "participants" / "P03")
        (self.study / "participants" / "p02").mkdir()
        refused(("status", self.study), "each code once")
        (self.study / "participants" / "p02").rmdir()
        file = self.study / "experiment.yaml"
        whole = file.read_text()
        file.write_text(whole.replace("alpha: 0.05", "alpha: 0.06"))
        refused(("status", self.study), "the pre-registration changed")
        # What a desktop or an editor of Windows leaves is no change.
        file.write_bytes(whole.replace("\n", "\r\n").encode())
        left = [folder / ".DS_Store" for folder in (sessions, sessions.parent.parent)]
        for each in left:
            each.write_bytes(b"\0")
        experiment("status", self.study)
        for each in left:
            each.unlink()
        file.write_text(whole)
        other = self.folder / "other"
        experiment("new", other, "--seed", 12, "--participants", 3)
        shutil.copytree(self.study / "participants" / "P02", other / "participants" / "P02")
        # Its sealed file and digest are others; the recordings show it.
        _, errors = experiment("status", other, status=2)
        self.assertIn("another experiment", errors)


class SteeredTest(ExperimentTestCase):
    @campaign
    def test_the_dashboard_notes_repeats_and_aborts_and_the_reasons_are_in_the_journal(self):
        self.new("--conditions", "A,C", "--participants", 1)
        self.edit(rest_s=6, order="latin")
        process, domain = self.start()
        dashboard = Dashboard("--domain", domain)
        self.addCleanup(dashboard.close)
        file = self.study / "participants" / "P01" / "journal.jsonl"

        def entries(what):
            return of_kind(journal(self.study, "P01"), what) if file.exists() else []

        def wait(what, condition):
            wait_for(what, condition, SESSION_LIMIT_S, ended=lambda: process.poll() is not None and "it ended")

        def ask(path):
            status, answer, _ = dashboard.ask("POST", path)
            self.assertEqual(status, 204, answer)

        wait("the first trial", lambda: len(entries("trial began")) == 2)
        self.assertEqual(dashboard.ask("POST", "/session/repeat")[0], 409)  # without a reason
        ask("/session/note?text=window%20open")
        wait("its end", lambda: len(entries("trial ended")) == 2)
        ask("/session/repeat?text=coughed")  # during the rest before the next one
        wait("the repeated trial", lambda: len(entries("trial began")) == 3)
        wait("its measured part", lambda: dashboard.snapshot()["session"]["tick"] >
             dashboard.snapshot()["session"]["start_tick"] + 1000)
        ask("/session/repeat?text=slipped")
        wait("its end", lambda: len(entries("trial ended")) == 3)
        wait("a pause", lambda: dashboard.snapshot()["session"]["paused"])
        ask("/session/start")
        wait("the trial again", lambda: len(entries("trial began")) == 4)
        ask("/session/abort?text=fire%20alarm")
        self.assertEqual(process.wait(timeout=END_LIMIT_S), 1)
        began = [entry["step"] for entry in entries("trial began") if "step" in entry]
        self.assertEqual(began, [0, 0, 0])
        self.assertEqual([entry["trial"] for entry in entries("trial began")], [0, 1, 2, 3])
        self.assertRegex(entries("note")[0]["text"], "^dashboard on .*: window open$")
        self.assertEqual(entries("repeat asked")[0]["text"], "coughed")
        self.assertRegex(entries("trial ended")[2]["text"], "^repeated, asked by dashboard on .*: slipped$")
        self.assertRegex(entries("session ended")[0]["text"], "^aborted, asked by dashboard on .*: fire alarm$")
        self.run_to_the_end()


class ChosenModelTest(ExperimentTestCase):
    def cancelled_shares(self):
        """Of each trial of the only session, by its number: Eq. SN-1, from the rig's truth."""
        file = self.study / "participants" / "P01" / "sessions" / "01" / "session.mcap"
        seen = json.loads(subprocess.run([str(INSPECT), str(file), str(10**9), "signals"], capture_output=True,
                                         text=True, check=True).stdout)
        motor = dict(zip(seen["rig"]["tick"], seen["rig"]["motor_force_n"]))
        feedthrough = {row[0]: row[3] for row in seen["signals"]["truth"]}
        shares = {}
        for trial in seen["trials"]:
            ticks = range(trial["start_tick"], trial["start_tick"] + trial["duration_ticks"])
            pairs = [(feedthrough[tick], motor[tick]) for tick in ticks if tick in motor and tick in feedthrough]
            moved = sum(force ** 2 for force, _ in pairs)
            left = sum((force + push) ** 2 for force, push in pairs)
            shares[trial["number"]] = 1 - (left / moved) ** 0.5 if moved > 0 else None
        return shares

    @campaign
    def test_the_model_of_the_folder_runs_in_c_plus_and_in_no_other_trial(self):
        self.new("--conditions", "B,C,C',C+", "--participants", 1, "--control-model", self.augmented_model())
        self.edit(rest_s=0, identify_s=20)
        shown = self.run_to_the_end()
        self.assertIn("4 of 4 trials", shown)
        self.assertNotIn("C+", shown)
        opened = json.loads(experiment("unblind", self.study, "--reason", "the test's end")[0])
        ran = [entry["trial"] for entry in of_kind(journal(self.study, "P01"), "trial ended")
               if entry["completed"] and "step" in entry]
        shares = self.cancelled_shares()
        by_condition = {condition: shares[trial] for condition, trial in zip(opened["orders"]["P01"], ran)}
        print("cancelled share:", {name: round(share, 3) for name, share in by_condition.items()}, flush=True)
        self.assertEqual(by_condition["B"], 0.0)
        for condition in ("C", "C'", "C+"):
            self.assertGreater(by_condition[condition], 0.4, condition)
        self.assertEqual(len(set(by_condition.values())), 4)  # a model of its own in each
        experiment("export", self.study, "--out", self.folder / "set", "--csv")
        exported = rows(self.folder / "set" / "trials.csv")
        self.assertEqual([row["condition [-]"] for row in exported if row["task [-]"] == "tracking"],
                         opened["orders"]["P01"])


class MitigationsTest(ExperimentTestCase):
    @campaign
    def test_mitigations_are_conditions_with_tables_comparisons_and_a_data_set(self):
        conditions = ["A", "B", "C", "signal", "damping+force"]
        self.new("--conditions", ",".join(conditions), "--participants", 2)
        self.edit(rest_s=0, trial_s=8, identify_s=15, comparisons="[B-signal, C-damping+force]")
        for code in ("P01", "P02"):
            shown = self.run_to_the_end("--participant", code)
            self.assertIn("5 of 5 trials", shown)
            for text in (shown, *(path.read_text() for path in (self.study / "participants").rglob("*")
                                  if path.suffix in (".jsonl", ".log") and path.is_file())):
                self.assertNotIn("signal", text)  # blinded
                self.assertNotIn("damping", text)
        experiment("unblind", self.study, "--reason", "the test's end")
        experiment("report", self.study)
        summary = json.loads((self.study / "report" / "summary.json").read_text())
        self.assertEqual(set(summary["conditions"]), set(conditions))
        self.assertEqual(summary["recorded"]["left_out"], [])
        page = (self.study / "report" / "report.html").read_text()
        self.assertIn("damping+force: as C, and the motor adds damping", page)
        errors = {name: summary["conditions"][name]["rms_error_mm"]["mean"] for name in conditions}
        print("RMS error [mm]:", {name: round(error, 1) for name, error in errors.items()}, flush=True)
        for name in ("signal", "damping_force"):
            self.assertIsNotNone(summary[f"restoration_{name}"]["rms_error"])
        # Two people and trials of 8 s: only that what a mitigation takes away is not nothing.
        self.assertLess(errors["signal"], errors["B"])
        experiment("export", self.study, "--out", self.folder / "set", "--csv")
        exported = rows(self.folder / "set" / "trials.csv")
        self.assertEqual({row["condition [-]"] for row in exported if row["task [-]"] == "tracking"}, set(conditions))
        self.assertEqual(sum(row["task [-]"] == "freestick" for row in exported), 2)


class RefusalTest(ExperimentTestCase):
    def test_what_cannot_run_is_one_line(self):
        for words, expected in ((("--conditions", "A,D"), "in one process alone"),
                                (("--conditions", "A,Q"), "A, B, C, C' or C+"),
                                (("--operator", "cat"), "simulated, mouse or gamepad"),
                                (("--trials", "99"), "the experiment.yaml that these options give:10:9: experiment.trials")):
            _, errors = experiment("new", self.study, *words, status=2)
            self.assertEqual(len(errors.splitlines()), 1)
            self.assertIn(expected, errors)
            self.assertFalse(self.study.exists())
        # What the system refuses, in the words of the system.
        _, errors = experiment("new", self.folder / ("x" * 300), status=2)
        self.assertEqual(len(errors.splitlines()), 1)
        self.assertIn("xxx: got File name too long, want a file or folder", errors)
        self.new()
        self.assertIn("holds something", experiment("new", self.study, status=2)[1])
        _, errors = experiment("new", self.folder / "plus", "--conditions", "A,C+", "--control-model",
                               self.folder / "none.json", status=2)
        self.assertIn("--control-model", errors)
        other = self.folder / "model.json"
        other.write_text('{"format": "stillhand model", "version": 1}')
        _, errors = experiment("new", self.folder / "plus", "--conditions", "A,C+", "--control-model", other, status=2)
        self.assertIn('model.json.format: got "stillhand model", want "stillhand control model"', errors)
        self.assertFalse((self.folder / "plus").exists())
        pad = self.folder / "pad"
        experiment("new", pad, "--operator", "gamepad")
        for folder, words in ((pad, ()), (self.study, ("--gamepad", "/dev/input/event0"))):
            self.assertIn("--gamepad", experiment("run", folder, *words, status=2)[1])
            self.assertEqual(os.listdir(folder / "participants"), [])
        self.assertIn("without experiment.yaml", experiment("run", self.folder, status=2)[1])
        (self.study / "assignment.json").write_text("{}\n")
        self.assertIn("assignment.json: differs from assignment.sealed", experiment("status", self.study, status=2)[1])
        for verb in (("report",), ("export", "--csv", "--out", self.folder / "set")):
            self.assertIn("differs from assignment.sealed", experiment(verb[0], self.study, *verb[1:], status=2)[1])
        (self.study / "assignment.sealed").write_text("00\n")
        self.assertIn("assignment.sealed", experiment("status", self.study, status=2)[1])


class CampaignTest(ExperimentTestCase):
    def judge_study(self):
        """The study of the recordings alone: eleven people, each with one trial of each condition."""
        out = self.study.parent / "report"
        print(self.run_verb("study", "--sessions", self.study, "--out", out).stdout)
        summary = json.loads((out / "summary.json").read_text())
        self.assertEqual(summary["recorded"]["left_out"], ["P05: excluded, felt sick"])
        studied = rows(out / "trials.csv")
        self.assertEqual({condition: sum(row["condition"] == condition for row in studied) for condition in "ABC"},
                         {"A": 11, "B": 11, "C": 11})  # without practice
        experiment("report", self.study)
        for name in ("summary.json", "trials.csv"):
            self.assertEqual((self.study / "report" / name).read_bytes(), (out / name).read_bytes())
        experiment("export", self.study, "--out", self.study.parent / "set", "--bids")

    @campaign
    def test_twelve_participants_two_killed_and_resumed_one_excluded(self):
        kept = os.environ.get("STILLHAND_EXPERIMENT")
        if kept:
            self.study = pathlib.Path(kept)
        self.new("--participants", 12, "--conditions", "A,B,C")
        self.edit(rest_s=0)
        for n in range(1, 13):
            code = f"P{n:02}"
            if n in (3, 8):
                self.kill_in_a_trial(code, 1)
            self.run_to_the_end()  # without a code: the next one, who is `code`
            self.assertTrue(of_kind(journal(self.study, code), "session ended")[-1]["completed"], code)
        experiment("exclude", self.study, "--participant", "P05", "--reason", "felt sick")
        out, _ = experiment("status", self.study)
        self.assertEqual(out.count("complete"), 11)
        self.assertIn("excluded: felt sick", out)
        for code in ("P03", "P08"):
            self.assertEqual(len(of_kind(journal(self.study, code), "session began")), 2)
        opened = json.loads(experiment("unblind", self.study, "--reason", "all are complete")[0])
        self.judge_study()
        # Williams over twelve: every condition four times at each place.
        for place in range(3):
            at = [order[place] for order in opened["orders"].values()]
            self.assertEqual({condition: at.count(condition) for condition in "ABC"}, {"A": 4, "B": 4, "C": 4})


class CancellersTest(ExperimentTestCase):
    PEOPLE = 3

    @campaign
    def test_people_with_c_prime_and_c_plus_are_conducted_reported_and_diagnosed(self):
        """Pegged trials of 40 s, of which 12 s judge a diagnosis."""
        kept = os.environ.get("STILLHAND_EXPERIMENT")
        if kept:
            self.study = pathlib.Path(kept)
        self.new("--conditions", "A,B,C,C',C+", "--participants", self.PEOPLE, "--control-model",
                 self.augmented_model())
        self.edit(rest_s=0, identify_s=40)
        for _ in range(self.PEOPLE):
            self.assertIn("5 of 5 trials", self.run_to_the_end())
        experiment("unblind", self.study, "--reason", "all are complete")
        print(experiment("report", self.study, "--plan", "--diagnose", "--simulated")[0], flush=True)
        summary = json.loads((self.study / "report" / "summary.json").read_text())
        self.assertEqual(list(summary["conditions"]), ["A", "B", "C", "C'", "C+"])
        self.assertEqual(summary["recorded"]["participants"], ["P01", "P02", "P03"])
        self.assertEqual(summary["recorded"]["left_out"], [])  # each model was the one that the trial was given
        for key in ("restoration", "restoration_c_prime", "restoration_c_plus"):
            self.assertIsNotNone(summary[key]["rms_error"], key)
        self.assertTrue(summary["manova_all"]["design"].startswith("A, B, C, C', C+"), summary["manova_all"])
        diagnoses = summary["diagnoses"]
        self.assertEqual(diagnoses["failed"], {})
        self.assertEqual(sorted(diagnoses["participants"]), summary["recorded"]["participants"])
        self.assertTrue(summary["simulated"]["same_people"])
        self.assertEqual(summary["simulated"]["failed"], {})
        self.assertIn("C+", summary["simulated"]["paired"])


if __name__ == "__main__":
    main()
