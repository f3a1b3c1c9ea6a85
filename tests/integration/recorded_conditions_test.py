#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The study of an experiment with C, C' and C+ in two blocks: several trials of a condition are averaged, C' and C+
are in tables, figures and planned comparisons, each participant has a page. Every number next to NumPy and SciPy on the
exported tables.
"""
import html
import html.parser
import itertools
import json
import subprocess
import sys

import numpy
from scipy import stats

import lab_process
from sample_experiment import (LIMIT_S, WRITE_SAMPLE, SampleExperimentCase, conduct, new_experiment, number, rows,
                               stillhand, unblind)

PARTICIPANTS = 7
CONDITIONS = ("A", "B", "C", "C'", "C+")
PAIRS = (("A", "B"), ("B", "C"), ("B", "C'"), ("B", "C+"), ("C", "C'"), ("C'", "C+"), ("C", "C+"))
METRICS = {"rms_error_mm": "rms error [mm]", "dwell_ratio": "dwell ratio [-]", "crossover_hz": "crossover [Hz]"}
RESTORATIONS = {"C": "restoration", "C'": "restoration_c_prime", "C+": "restoration_c_plus"}
EXACT = 1e-9


def control_model(folder):
    """A model for C+: the filter of a simulated subject, which follows a hand."""
    stillhand("study", "--subjects", 1, "--seed", 5, "--trial-seconds", 5, "--identify-seconds", 20, "--conditions", "B",
              "--out", folder / "model")
    row = next(row for row in rows(folder / "model" / "models.csv") if row["model"] == "1 kHz filter")
    return json.dumps({
        "format": "stillhand control model", "version": 1, "rig": 1, "rate_hz": 1000,
        "denominator": [1.0] + [float(row[f"d{i} [-]"]) for i in range(1, 5)],
        "inputs": [{"channel": "a_y", "map": None, "numerator": [float(row[f"c{i} [N s^2/m]"]) for i in range(5)]}],
        "loop": None, "output": None, "paths": [], "waves": [],
        "adapts": {"mass_kg": 1.5, "damping_n_s_m": 15.0, "stiffness_n_m": 200.0, "lever_m": 0.1}})


class Links(html.parser.HTMLParser):
    """References of a page."""

    def __init__(self, file):
        super().__init__()
        self.found = []
        self.feed(file.read_text())

    def handle_starttag(self, tag, attrs):
        self.found += [value for name, value in attrs if name == "href" and not value.startswith("#")]


class RecordedConditionsTest(SampleExperimentCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        new_experiment(cls.experiment, PARTICIPANTS, "--conditions", ",".join(CONDITIONS[:3]), "--trial-seconds", 10,
                       "--identify-seconds", 20, conditions="[A, B, C, C', C+]", blocks=2, break_s=0,
                       control_model="plus.json", comparisons="[A-B, B-C, C-C', C'-C+]")
        (cls.experiment / "plus.json").write_text(control_model(cls.folder))
        conduct(cls.experiment)
        unblind(cls.experiment)
        cls.said = stillhand("experiment", "report", cls.experiment)[0]
        cls.out = cls.experiment / "report"
        cls.summary = json.loads((cls.out / "summary.json").read_text())
        cls.trials = rows(cls.out / "trials.csv")
        cls.people = cls.summary["recorded"]["participants"]

    def values(self, metric):
        """{condition: one mean for each participant}, of the trials in the tables that have the metric."""
        found = {}
        for condition, person in itertools.product(CONDITIONS, self.people):
            own = [number(row[METRICS[metric]]) for row in self.trials if row["participant"] == person and
                   row["condition"] == condition and row["in tables"] == "1"]
            own = [value for value in own if not numpy.isnan(value)]
            found.setdefault(condition, []).append(numpy.mean(own) if own else numpy.nan)
        return {condition: numpy.array(each) for condition, each in found.items()}

    def test_every_trial_has_a_row_and_a_repetition_takes_the_place_of_its_trial(self):
        # P04 lacks the trial that lost too many samples, so the rules exclude it; P05 is excluded by hand.
        self.assertEqual(self.people, ["P01", "P02", "P03", "P06", "P07"])
        for person in self.people:
            own = [row for row in self.trials if row["participant"] == person]
            self.assertEqual(len(own), 11 if person == "P06" else 10)
            self.assertEqual(sum(row["in tables"] == "1" for row in own), 10)
            for condition in CONDITIONS:
                self.assertEqual(sum(row["condition"] == condition and row["in tables"] == "1" for row in own), 2)
        repeated = [row for row in self.trials if row["participant"] == "P06" and row["place in plan"] == "1"]
        self.assertEqual([row["in tables"] for row in repeated], ["0", "1"])
        self.assertEqual({row["block"] for row in self.trials}, {"1", "2"})

    def test_means_deviations_and_tests_are_those_of_numpy_and_scipy_on_the_exported_table(self):
        checked = 0
        for metric in METRICS:
            values = self.values(metric)
            for condition in CONDITIONS:
                found = self.summary["conditions"][condition][metric]
                numpy.testing.assert_allclose(numpy.array(found["per_subject"], dtype=float), values[condition],
                                              atol=EXACT, rtol=0)
                self.assertAlmostEqual(found["mean"], numpy.nanmean(values[condition]), delta=EXACT)
                self.assertAlmostEqual(found["std"], numpy.nanstd(values[condition], ddof=1), delta=EXACT)
            for first, second in PAIRS:
                p = self.summary["t_tests"][f"{first}-{second}"][metric]
                if p is None:
                    continue
                details = self.summary["t_test_details"][f"{first}-{second}"][metric]
                judge = stats.ttest_rel(values[second], values[first])
                self.assertAlmostEqual(p, judge.pvalue, delta=EXACT)
                self.assertAlmostEqual(details["t"] / judge.statistic, 1.0, delta=EXACT)
                checked += 1
        self.assertGreaterEqual(checked, 14)
        self.assertEqual(set(self.summary["t_tests"]), {f"{first}-{second}" for first, second in PAIRS})

    def test_the_manova_over_all_conditions_is_that_of_statsmodels(self):
        import pandas
        from statsmodels.multivariate.manova import MANOVA
        found = self.summary["manova_all"]
        self.assertTrue(found["design"].startswith("A, B, C, C', C+: "), found)
        self.assertTrue(self.summary["manova"]["design"].startswith("main effects"))
        values = [self.values(metric) for metric in METRICS]
        frame = pandas.DataFrame([{"person": person, "condition": condition,
                                   **{f"m{k}": value[condition][i] for k, value in enumerate(values)}}
                                  for i, person in enumerate(self.people) for condition in CONDITIONS])
        self.assertFalse(frame.isna().any().any())
        test = MANOVA.from_formula("m0 + m1 + m2 ~ C(condition, Sum) + C(person, Sum)", frame).mv_test()
        for effect, term in (("condition", "C(condition, Sum)"), ("subject", "C(person, Sum)")):
            table = test.results[term]["stat"]
            self.assertAlmostEqual(found[effect]["wilks_lambda"], table.loc["Wilks' lambda", "Value"], delta=EXACT)
            self.assertAlmostEqual(found[effect]["f"] / table.loc["Wilks' lambda", "F Value"], 1.0, delta=EXACT)
        self.assertIn("The conditions A, B, C, C', C+", html.unescape((self.out / "report.html").read_text()))
        self.assertIn("30 s", self.summary["manova_all_thirds"]["reason"])

    def test_the_mixed_models_are_numpy_s_generalised_least_squares(self):
        """SU-11: given both variances, the effects are (X' V^-1 X)^-1 X' V^-1 y, over the trials in the tables."""
        script = lab_process.SOURCE / "apps" / "study" / "mixed_models.py"
        models = json.loads(subprocess.run([sys.executable, script, self.out / "trials.csv"], capture_output=True,
                                           text=True, check=True, timeout=LIMIT_S).stdout)
        for metric, column in METRICS.items():
            used = [row for row in self.trials if row["in tables"] == "1" and row[column]]
            model = models[metric]
            self.assertEqual(model["trials"], len(used))
            y = numpy.array([number(row[column]) for row in used])
            x = numpy.array([[1.0, *(row["condition"] == each for each in CONDITIONS if each != "B"),
                              number(row["place"])] for row in used])
            person = numpy.array([row["participant"] for row in used])
            v = (model["participant_variance"] * (person[:, None] == person[None, :]) +
                 model["residual_variance"] * numpy.eye(len(used)))
            weighted = numpy.linalg.solve(v, x)
            wanted = numpy.linalg.solve(x.T @ weighted, weighted.T @ y)
            names = ["intercept", *(f"{each}-B" for each in CONDITIONS if each != "B"), "place"]
            for name, value in zip(names, wanted):
                self.assertAlmostEqual(model["effects"][name]["estimate"] / value, 1.0, delta=1e-6, msg=(metric, name))

    def test_each_canceller_has_its_restoration_with_fieller_s_interval(self):
        for metric, key in (("rms_error_mm", "rms_error"), ("dwell_ratio", "dwell_ratio")):
            values = self.values(metric)
            for condition, name in RESTORATIONS.items():
                gained, lost = values["B"] - values[condition], values["B"] - values["A"]
                self.assertAlmostEqual(self.summary[name][key], gained.mean() / lost.mean(), delta=EXACT)
                edges = self.summary["restoration_interval95" if condition == "C" else f"{name}_interval95"][key]
                if edges is None:
                    continue
                n = len(lost)
                q = stats.t.ppf(0.975, n - 1) ** 2 / n
                c = numpy.cov(gained, lost)
                roots = numpy.roots([lost.mean() ** 2 - q * c[1, 1], -2 * (gained.mean() * lost.mean() - q * c[0, 1]),
                                     gained.mean() ** 2 - q * c[0, 0]])
                numpy.testing.assert_allclose(edges, sorted(roots), atol=EXACT, rtol=0)

    def test_planned_comparisons_name_c_prime_and_c_plus(self):
        planned = self.summary["registered"]["comparisons"]
        self.assertEqual(list(planned), ["A-B", "B-C", "C-C'", "C'-C+"])
        for pair, cells in planned.items():
            for metric, cell in cells.items():
                self.assertEqual(cell["p"], self.summary["t_tests"][pair][metric])

    def test_windows_and_open_loop_are_those_of_numpy_over_single_trials(self):
        """The study of one session alone with each condition once has the single trials: block 1 and block 2."""
        single = self.folder / "single"
        person = self.experiment / "participants" / "P03" / "sessions"
        # P03 was killed after its first trial: session 01 holds that trial alone.
        stillhand("study", "--sessions", person / "01", "--out", single)
        first = rows(single / "open_loop.csv")
        condition = first[0]["condition"]
        self.assertEqual({row["condition"] for row in first}, {condition})
        whole = [row for row in rows(self.out / "open_loop.csv")
                 if row["subject"] == "P03" and row["condition"] == condition]
        rest = self.folder / "rest"
        stillhand("study", "--sessions", person / "02", "--out", rest)
        trials = rows(rest / "trials.csv")
        self.assertEqual(sum(row["condition"] == condition for row in trials), 1)
        second = [row for row in rows(rest / "open_loop.csv") if row["condition"] == condition]
        for one, two, both in zip(first, second, whole, strict=True):
            gains = [number(row["gain [-]"]) for row in (one, two)]
            self.assertAlmostEqual(numpy.log(number(both["gain [-]"])), numpy.mean(numpy.log(gains)), delta=EXACT)
            phases = numpy.exp(1j * numpy.array([number(row["phase [rad]"]) for row in (one, two)]))
            self.assertAlmostEqual(number(both["phase [rad]"]), numpy.angle(phases.sum()), delta=EXACT)
            self.assertAlmostEqual(number(both["remnant share of error power [-]"]),
                                   numpy.mean([number(row["remnant share of error power [-]"]) for row in (one, two)]),
                                   delta=EXACT)
        windows = [[number(row["rms error [mm]"]) for row in rows(place / "moving_averages.csv")
                    if row["condition"] == condition and (place != self.out or row["subject"] == "P03")]
                   for place in (single, rest, self.out)]
        numpy.testing.assert_allclose(windows[2], numpy.mean(windows[:2], axis=0), atol=EXACT, rtol=0)

    def test_figures_and_tables_name_participants_and_conditions(self):
        report = (self.out / "report.html").read_text()
        self.assertIn("Cancellers that go beyond the paper", report)
        for person in self.people:
            self.assertIn(person, (self.out / "fig06_feedthrough_models.svg").read_text())
        self.assertNotIn("subject 1<", (self.out / "fig06_feedthrough_models.svg").read_text())
        self.assertIn("C+ augmented", (self.out / "fig10_rms_error.svg").read_text())
        self.assertEqual({row["subject"] for row in rows(self.out / "metrics.csv")}, set(self.people))
        self.assertIn("each metric is their mean", report)

    def test_each_participant_has_a_page_that_the_report_leads_to_and_back(self):
        pages = sorted(file.name for file in self.out.glob("participant_*.html"))
        # Who was excluded by hand has none.
        self.assertEqual(pages, [f"participant_P{n:02}.html" for n in (1, 2, 3, 4, 6, 7)])
        self.assertEqual(sorted(link.removeprefix("./") for link in Links(self.out / "report.html").found), pages)
        for page in pages:
            text = (self.out / page).read_text()
            self.assertEqual(Links(self.out / page).found, ["./report.html"])
            self.assertNotIn("Anna", text)
        person = (self.out / "participant_P04.html").read_text()
        self.assertIn("not in the tables and figures", person)
        self.assertIn("Excluded by a rule", person)
        own = [row for row in self.trials if row["participant"] == "P01"]
        person = (self.out / "participant_P01.html").read_text()
        for row in own:
            self.assertIn(f"{number(row['rms error [mm]']):.1f}", person)

    def test_a_page_of_an_earlier_report_goes(self):
        out = self.folder / "again"
        sessions = self.experiment / "participants"
        folders = [sessions / person / "sessions" / "01" for person in ("P01", "P02", "P07")]
        stillhand("study", "--sessions", *folders, "--out", out)
        self.assertTrue((out / "participant_P07.html").exists())
        stillhand("study", "--sessions", *folders[:2], "--out", out)
        self.assertFalse((out / "participant_P07.html").exists())
        self.assertTrue((out / "participant_P01.html").exists())

    def test_an_export_checks_which_canceller_a_recording_holds(self):
        stillhand("experiment", "export", self.experiment, "--out", self.folder / "tables", "--csv")
        exported = {(row["participant [-]"], row["session [-]"], row["trial [-]"]): row for row in
                    rows(self.folder / "tables" / "trials.csv") if row["task [-]"] == "tracking"}
        for row in self.trials:
            self.assertEqual(exported[row["participant"], row["session"], row["trial"]]["condition [-]"],
                             row["condition"])

    def test_a_model_that_changed_after_the_first_participant_is_named(self):
        model, digests = self.experiment / "plus.json", self.experiment / "experiment.sha256"
        whole, lines = model.read_text(), digests.read_text()
        self.addCleanup(model.write_text, whole)
        self.addCleanup(digests.write_text, lines)
        subprocess.run(["sha256sum", "--check", "--quiet", digests.name], cwd=self.experiment, check=True)
        calls = (("status",), ("run", "--headless"), ("report",), ("export", "--csv", "--out", self.folder / "none"),
                 ("exclude", "--participant", "P01", "--reason", "none"), ("unblind", "--reason", "again"))

        def all_refuse(said):
            for verb, *words in calls:
                self.refused_for(said, "experiment", verb, self.experiment, *words)
        model.write_text(whole.replace("1.5", "1.6", 1))
        all_refuse("plus.json: got SHA-256")
        self.refused_for("the model of condition C+ changed after the first", "experiment", "status", self.experiment)
        model.unlink()
        all_refuse("plus.json: got no file")
        model.write_text(whole)
        digests.write_text(lines.splitlines(keepends=True)[0])  # as one that did not register the model
        all_refuse("experiment.sha256: got no line of plus.json")
        digests.write_text(lines)
        stillhand("experiment", "status", self.experiment)


class RefusedModelTest(SampleExperimentCase):
    def test_a_trial_whose_model_was_refused_is_named_and_in_no_table(self):
        new_experiment(self.experiment, 3, "--conditions", "B,C", "--identify-seconds", 20, conditions="[B, C, C+]",
                       control_model="plus.json", comparisons="[B-C, C-C+]")
        (self.experiment / "plus.json").write_text(control_model(self.folder))
        conduct(self.experiment, 0, 1, 0, 2)
        unblind(self.experiment)
        stillhand("experiment", "report", self.experiment, "--simulated")
        summary = json.loads((self.experiment / "report" / "summary.json").read_text())
        self.assertEqual(summary["simulated"]["failed"], {})  # the model of C+ runs in the simulation, too
        self.assertIn("C+", summary["simulated"]["paired"])
        recorded = summary["recorded"]
        self.assertEqual(recorded["participants"], ["P01", "P03"])
        named = [line for line in recorded["left_out"] if "model" in line]
        self.assertEqual(len(named), 1, recorded["left_out"])
        self.assertRegex(named[0], r"^P02, session 01, trial \d \(C, 5 s\): ran model \d+ in place of model \d+ in 100 % "
                                   "of it; the canceller refused it: it is not stable$")
        self.assertTrue(any(line.startswith("P02: ") and "C+" in line for line in recorded["left_out"]), recorded)
        self.assertIn("the canceller refused it", (self.experiment / "report" / "report.html").read_text())
        in_report = rows(self.experiment / "report" / "trials.csv")
        self.assertEqual([row for row in in_report if row["participant"] == "P02" and row["condition"] == "C+"], [])
        stillhand("experiment", "export", self.experiment, "--out", self.folder / "tables", "--csv")
        other = [row for row in rows(self.folder / "tables" / "trials.csv") if row["condition [-]"] == "n/a"]
        self.assertEqual([row["participant [-]"] for row in other], ["P02"])
        self.assertEqual(other[0]["rms_error [mm]"], "")


if __name__ == "__main__":
    lab_process.main(WRITE_SAMPLE)
