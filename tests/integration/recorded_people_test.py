#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`--diagnose` and `--simulated` of `experiment report`: what the model lacks in each person, what C+ would have gained,
and the same people simulated in one process. Every figure next to NumPy and SciPy on the exported tables; a diagnosis
next to `stillhand close-the-loop` on the same recording.
"""
import json
import shutil
import warnings

import numpy
from scipy import stats

import lab_process
from sample_experiment import (WRITE_SAMPLE, SampleExperimentCase, conduct, new_experiment, number, rows, stillhand,
                               unblind)

METRICS = {"rms_error_mm": "rms error [mm]", "dwell_ratio": "dwell ratio [-]", "crossover_hz": "crossover [Hz]"}
EXACT = 1e-9


def signed_rank_p(differences):
    """ST-15: zeros go, ties have no exact distribution."""
    kept = differences[differences != 0]
    if not kept.size:
        return 1.0
    if len(numpy.unique(abs(kept))) == len(kept):
        return stats.wilcoxon(kept, method="exact").pvalue
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # SciPy finds a normal approximation of few differences unwise
        return stats.wilcoxon(kept, correction=True, method="approx").pvalue


def summary_of(folder):
    return json.loads((folder / "summary.json").read_text())


class RecordedPeopleTest(SampleExperimentCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        new_experiment(cls.experiment, 6, "--trial-seconds", 10, "--identify-seconds", 40, least_completed_share=0.5,
                       most_lost_tick_share=0.1)
        conduct(cls.experiment, 1)  # other remnants than those of the simulation
        unblind(cls.experiment)
        cls.said = stillhand("experiment", "report", cls.experiment, "--diagnose", "--simulated")[0]
        cls.out = cls.experiment / "report"
        cls.summary = summary_of(cls.out)
        cls.people = cls.summary["recorded"]["participants"]

    def test_everybody_in_the_tables_has_a_diagnosis_or_a_reason(self):
        diagnoses = self.summary["diagnoses"]
        self.assertEqual(self.people, ["P01", "P02", "P03", "P04", "P06"])
        self.assertEqual(sorted([*diagnoses["participants"], *diagnoses["failed"]]), self.people)
        self.assertGreaterEqual(len(diagnoses["participants"]), 4)
        table = {row["participant"]: row for row in rows(self.out / "diagnoses.csv")}
        self.assertEqual(sorted(table), self.people)
        report = (self.out / "report.html").read_text()
        self.assertIn("What the model lacks", report)
        for code in self.people:
            self.assertIn("What the model lacks", (self.out / f"participant_{code}.html").read_text())

    def test_a_diagnosis_is_that_of_close_the_loop_on_the_same_recording(self):
        out = self.folder / "loop"
        # P01: one session, each condition once.
        file = self.experiment / "participants" / "P01" / "sessions" / "01" / "session.mcap"
        stillhand("close-the-loop", "--pegged", file, "--moving", file, "--cancelled", file, "--out", out)
        theirs = summary_of(out)
        ours = self.summary["diagnoses"]["participants"]["P01"]
        judged = theirs["unseen"][0]
        motor = judged["motor_linear"]
        self.assertAlmostEqual(ours["without"]["rms_n"], motor["left"]["rms"] / (1 - motor["cut"]), delta=EXACT)
        self.assertEqual(ours["left_by_c"]["rms_n"], judged["motor_linear"]["left"]["rms"])
        self.assertEqual(ours["left_by_c_plus"]["rms_n"], judged["motor_augmented"]["left"]["rms"])
        self.assertEqual([(each["kind"], each["channel"]) for each in ours["findings"]],
                         [(each["kind"], each["channel"]) for each in theirs["verdict"]["findings"]])

    def test_the_gain_and_the_counts_are_numpy_s_on_the_exported_tables(self):
        self.check_diagnoses(self.summary["diagnoses"], self.out)

    def check_diagnoses(self, diagnoses, out):
        table = [row for row in rows(out / "diagnoses.csv") if row["left by C+ [N]"] and row["left by C [N]"]]
        gain = numpy.array([number(row["left by C [N]"]) - number(row["left by C+ [N]"]) for row in table])
        if diagnoses["gain"] is not None:
            judge = stats.ttest_1samp(gain, 0.0)
            self.assertEqual(diagnoses["gain"]["people"], len(gain))
            self.assertAlmostEqual(diagnoses["gain"]["mean_n"], gain.mean(), delta=EXACT)
            self.assertAlmostEqual(diagnoses["gain"]["p"], judge.pvalue, delta=EXACT)
            numpy.testing.assert_allclose(diagnoses["gain"]["ci95"], judge.confidence_interval(), atol=EXACT, rtol=EXACT)
        else:
            self.assertTrue(len(gain) < 2 or numpy.ptp(gain) < 1e-12)
        found = {}
        for row in rows(out / "findings.csv"):
            found.setdefault((row["kind"], row["channel"], row["where"]), {}).setdefault(
                row["participant"], number(row["explained [N]"]))
        self.assertEqual(len(diagnoses["recurring"]), len(found))
        for effect in diagnoses["recurring"]:
            people = found[effect["kind"], effect["channel"] or "", effect["where"]]
            self.assertEqual(effect["people"], len(people))
            self.assertEqual(effect["participants"], sorted(people))
            self.assertAlmostEqual(effect["explained_n"], numpy.median(list(people.values())), delta=EXACT)
            self.assertTrue(effect["people"] <= effect["able"] <= len(diagnoses["participants"]))
        for code, left in diagnoses["left_out"].items():
            self.assertEqual(left["found"], len(diagnoses["participants"][code]["findings"]))
            self.assertLessEqual(left["forecast"], left["found"])

    def test_neither_threads_nor_other_people_change_a_diagnosis(self):
        again = self.folder / "one_thread"
        sessions = [self.experiment / "participants" / code / "sessions" / "01" for code in ("P01", "P04")]
        stillhand("study", "--sessions", *sessions, "--out", again, "--diagnose", "--threads", 1)
        ours, theirs = (summary["diagnoses"]["participants"] for summary in (self.summary, summary_of(again)))
        self.assertEqual({code: ours.get(code) for code in theirs}, theirs)

    def test_an_effect_that_every_rig_holds_recurs_and_c_plus_would_have_gained(self):
        place = self.folder / "effect"
        new_experiment(place, 3, "--trial-seconds", 10, "--identify-seconds", 40)
        conduct(place, 0, 1.0, 9)  # an acceleration that the paper's model does not read
        unblind(place)
        out = place / "report"
        stillhand("experiment", "report", place, "--diagnose")
        diagnoses = summary_of(out)["diagnoses"]
        strongest = diagnoses["recurring"][0]
        self.assertEqual((strongest["kind"], strongest["channel"], strongest["where"]), ("coupled_input", "a_x", "body"))
        self.assertGreaterEqual(strongest["people"], 2)
        for code in strongest["participants"]:
            person = diagnoses["participants"][code]
            self.assertEqual(person["verdict"], "effects found")
            self.assertGreater(person["gain_n"], 0.05)  # [N] of 1 N that the effect takes
        self.check_diagnoses(diagnoses, out)
        self.assertIn("coupled input (a_x)", (out / "report.html").read_text())

    def pairs(self, summary, out):
        """(condition, metric, check, differences) of the same people, from the exported tables."""
        people = summary["recorded"]["participants"]
        tables = [{(row["subject"], row["condition"]): row for row in rows(out / name)}
                  for name in ("metrics.csv", "simulated.csv")]
        for condition, cells in summary["simulated"]["paired"].items():
            for metric, check in cells.items():
                both = [[number(table[person, condition][METRICS[metric]]) for person in people] for table in tables]
                differences = numpy.subtract(*both)
                yield condition, metric, check, differences[~numpy.isnan(differences)]

    def check_pairs(self, summary, out):
        from statsmodels.stats.multitest import multipletests
        tested = []
        for _, _, check, differences in self.pairs(summary, out):
            self.assertEqual(check["people"], len(differences))
            self.assertAlmostEqual(check["mean_difference"], differences.mean(), delta=EXACT)
            judge = stats.ttest_1samp(differences, 0.0)
            self.assertAlmostEqual(check["p"], judge.pvalue, delta=EXACT)
            self.assertAlmostEqual(check["t"] / judge.statistic, 1.0, delta=EXACT)
            numpy.testing.assert_allclose(check["ci95"], judge.confidence_interval(), atol=EXACT, rtol=EXACT)
            self.assertAlmostEqual(check["p_signed_rank"], signed_rank_p(differences), delta=EXACT)
            tested.append(check)
        self.assertEqual(len(tested), 9)
        adjusted = multipletests([check["p"] for check in tested], method="holm")[1]
        for check, p in zip(tested, adjusted):
            self.assertAlmostEqual(check["p_holm"], p, delta=EXACT)
        self.assertEqual(summary["simulated"]["more_than_chance"], int((adjusted < 0.05).sum()))

    def test_the_same_people_with_other_remnants_differ_by_no_more_than_chance(self):
        self.assertTrue(self.summary["simulated"]["same_people"])
        self.check_pairs(self.summary, self.out)
        self.assertEqual(self.summary["simulated"]["more_than_chance"], 0)
        self.assertIn("no more than chance", (self.out / "report.html").read_text())
        self.assertIn("no more than chance", self.said)

    def test_the_same_remnants_leave_no_difference_and_another_motor_one_that_is_more_than_chance(self):
        for gain in (1.0, 0.2):
            place = self.folder / f"gain{gain}"
            new_experiment(place, 8, "--trial-seconds", 10, "--identify-seconds", 20)
            conduct(place, 0, gain)
            unblind(place)
            out = self.folder / f"report{gain}"
            printed = stillhand("study", "--sessions", place, "--out", out, "--simulated")[0]
            summary = summary_of(out)
            if gain < 1.0:
                self.assertIn("more than chance in", printed)
                self.check_pairs(summary, out)
                self.assertLess(summary["simulated"]["paired"]["C"]["rms_error_mm"]["p_holm"], 0.05)
                continue
            # They ran as planned: the same bits.
            recorded, simulated = ({(row["subject"], row["condition"]): row for row in rows(out / name)}
                                   for name in ("metrics.csv", "simulated.csv"))
            for code in ("P01", "P08"):
                for condition in "ABC":
                    for column in METRICS.values():
                        self.assertEqual(recorded[code, condition][column], simulated[code, condition][column])

    def test_other_people_are_not_compared_person_by_person(self):
        out = self.folder / "alone"
        sessions = [self.experiment / "participants" / code / "sessions" / "01" for code in ("P01", "P04")]
        stillhand("study", "--sessions", *sessions, "--out", out, "--simulated")
        simulated = summary_of(out)["simulated"]
        self.assertFalse(simulated["same_people"])
        self.assertNotIn("paired", simulated)
        self.assertEqual(simulated["subjects"], 2)
        self.assertEqual({row["subject"] for row in rows(out / "simulated.csv")}, {"1", "2"})

    def test_options_without_recordings_are_refused(self):
        self.refused_for("--sessions", "study", "--diagnose", "--out", self.folder / "none")
        self.refused_for("--sessions", "study", "--simulated", "--out", self.folder / "none")
        population = self.folder / "population.yaml"
        population.write_text("body_mass_kg: 60\n")
        words = ("study", "--sessions", self.experiment, "--population", population, "--out", self.folder / "none")
        self.refused_for("--simulated", *words)
        self.refused_for("an experiment draws its participants", *words, "--simulated")
        self.assertFalse((self.folder / "none").exists())

    def test_a_session_without_a_and_a_condition_that_comes_once_are_named(self):
        """Single sessions: P03's first one holds one trial, so it lacks what the others have."""
        out = self.folder / "lacking"
        folders = [self.experiment / "participants" / code / "sessions" / "01" for code in ("P01", "P02", "P03")]
        said = stillhand("study", "--sessions", *folders, "--out", out)[0]
        self.assertIn("left out: P03: no complete trial of condition", said)
        self.assertEqual(summary_of(out)["recorded"]["participants"], ["P01", "P02"])
        self.assertTrue((out / "participant_P03.html").exists())
        self.assertIn("not in the tables", (out / "participant_P03.html").read_text())

    def test_two_participants_of_one_code_are_named_and_nothing_is_overwritten(self):
        person = self.experiment / "participants" / "P01" / "sessions" / "01"
        other = self.folder / "other" / "01"
        shutil.copytree(person, other)
        out = self.folder / "kept"
        stillhand("study", "--sessions", person, self.experiment / "participants" / "P02" / "sessions" / "01", "--out", out)
        before = {file.name: file.read_bytes() for file in out.iterdir() if file.is_file()}
        self.refused_for("each code for one participant", "study", "--sessions", person, other, "--out", out)
        self.assertEqual({file.name: file.read_bytes() for file in out.iterdir() if file.is_file()}, before)


if __name__ == "__main__":
    lab_process.main(WRITE_SAMPLE)
