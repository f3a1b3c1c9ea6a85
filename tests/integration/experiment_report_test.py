#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The study of an experiment's recordings: `experiment report`, exclusion rules, planned comparisons, --plan, and every
test next to NumPy, SciPy and statsmodels on the exported tables.
"""
import itertools
import json
import math
import shutil
import warnings

import numpy
from scipy import integrate, special, stats

import lab_process
from sample_experiment import (WRITE_SAMPLE, SampleExperimentCase, conduct, new_experiment, number, rows, stillhand,
                               unblind)

PARTICIPANTS = 12
METRICS = {"rms_error_mm": "rms error [mm]", "dwell_ratio": "dwell ratio [-]", "crossover_hz": "crossover [Hz]"}
EXACT = 1e-9


def tree(folder):
    """{name: bytes} of all files."""
    return {file.name: file.read_bytes() for file in folder.iterdir() if file.is_file()}


def power_by_definition(size, n, alpha):
    """Of a t-test of n pairs, two-sided. SciPy's noncentral t, and so statsmodels, has no value in its far tails."""
    df, shift = n - 1, size * math.sqrt(n)
    edge = stats.t.ppf(1 - alpha / 2, df)

    def refused_given(chi_squared):
        scale = math.sqrt(chi_squared / df)
        return stats.norm.sf(edge * scale - shift) + stats.norm.cdf(-edge * scale - shift)
    return integrate.quad(lambda x: refused_given(x) * stats.chi2.pdf(x, df), 0, stats.chi2.isf(1e-15, df),
                          epsabs=1e-12, limit=200)[0]


class ReportTest(SampleExperimentCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # Trials of 31 s have thirds; people differ enough that a rule of 1.5 deviations finds one.
        new_experiment(cls.experiment, PARTICIPANTS, "--trial-seconds", 31, "--identify-seconds", 20,
                       most_rms_deviations=1.5, alpha=0.01)
        conduct(cls.experiment)
        cls.blinded = stillhand("experiment", "report", cls.experiment, status=2)[1]
        unblind(cls.experiment)
        cls.said = stillhand("experiment", "report", cls.experiment, "--plan", "--plan-effect", 0.5, 1.25)[0]
        cls.out = cls.experiment / "report"
        cls.summary = json.loads((cls.out / "summary.json").read_text())
        cls.trials = rows(cls.out / "trials.csv")

    def values(self, participants):
        """{metric: [participants x conditions]}: of each condition the last complete trial, from trials.csv."""
        last = {(row["participant"], row["condition"]): row for row in self.trials}
        return {metric: numpy.array([[number(last[person, condition][column]) for condition in "ABC"]
                                     for person in participants]) for metric, column in METRICS.items()}

    def test_a_blinded_experiment_has_no_report(self):
        self.assertIn("still blinded", self.blinded)

    def test_the_report_is_the_study_of_the_folder_bit_for_bit(self):
        out = self.folder / "study"
        stillhand("study", "--sessions", self.experiment, "--out", out, "--plan", "--plan-effect", 0.5, 1.25)
        ours, theirs = tree(self.out), tree(out)
        self.assertEqual(ours.keys(), theirs.keys())
        # The page states its command line.
        self.assertEqual({name for name in ours if ours[name] != theirs[name]}, {"report.html"})

    def test_the_rules_exclude_who_meets_them_and_both_results_are_given(self):
        registered = self.summary["registered"]
        excluded = registered["excluded"]
        # P04 lost 2.0 % of a trial's samples, more than 2 %: one trial less, and so less than all of the planned ones.
        self.assertTrue(any(line.startswith("P04, session 01, trial 1: 0.02") for line in excluded), excluded)
        self.assertTrue(any(line.startswith("P04: 0.6667 of the planned trials") for line in excluded), excluded)
        self.assertEqual(self.summary["recorded"]["left_out"][-1], "P05: excluded, Anna felt sick")
        everybody = [f"P{n:02}" for n in range(1, PARTICIPANTS + 1) if n != 5]
        self.assertEqual(registered["without_rules"]["participants"], everybody)
        # The rule of deviations, by NumPy, over all but P04.
        people = [code for code in everybody if code != "P04"]
        errors = self.values(people)["rms_error_mm"]
        far = abs(errors - errors.mean(axis=0)) / errors.std(axis=0, ddof=1) > 1.5
        self.assertTrue(far.any())
        left = [code for code, out in zip(people, far.any(axis=1)) if not out]
        self.assertEqual(self.summary["recorded"]["participants"], left)
        for code in set(people) - set(left):
            self.assertTrue(any(line.startswith(f"{code}: RMS error") for line in excluded), excluded)
        for conditions, group in ((self.summary["conditions"], left),
                                  (registered["without_rules"]["conditions"], everybody)):
            for place, condition in enumerate("ABC"):
                expected = self.values(group)["rms_error_mm"][:, place].mean()
                self.assertAlmostEqual(conditions[condition]["rms_error_mm"]["mean"], expected, delta=EXACT)

    def comparisons(self):
        """(first, second, metric, details, differences) with the rules and without."""
        registered = self.summary["registered"]["without_rules"]
        for details, group in ((self.summary["t_test_details"], self.summary["recorded"]["participants"]),
                               (registered["t_test_details"], registered["participants"])):
            values = self.values(group)
            for (first, second), metric in itertools.product(("AB", "BC"), METRICS):
                both = values[metric][:, "ABC".index(second)] - values[metric][:, "ABC".index(first)]
                if not numpy.isnan(both).any():
                    yield details[f"{first}-{second}"][metric], both

    def test_effect_sizes_and_intervals_are_those_of_numpy(self):
        checked = 0
        for found, differences in self.comparisons():
            n = len(differences)
            mean, deviation = differences.mean(), differences.std(ddof=1)
            half = stats.t.ppf(0.975, n - 1) * deviation / numpy.sqrt(n)
            correction = numpy.exp(special.gammaln((n - 1) / 2) - special.gammaln((n - 2) / 2)) / numpy.sqrt((n - 1) / 2)
            self.assertAlmostEqual(found["t"], stats.ttest_1samp(differences, 0.0).statistic, delta=EXACT)
            self.assertAlmostEqual(found["cohen_dz"], mean / deviation, delta=EXACT)
            self.assertAlmostEqual(found["hedges_gz"], correction * mean / deviation, delta=EXACT)
            for edge, expected in zip(found["ci95"], (mean - half, mean + half)):
                self.assertAlmostEqual(edge, expected, delta=EXACT)
            checked += 1
        self.assertGreaterEqual(checked, 8)

    def test_planned_comparisons_are_holm_s_over_all_of_them(self):
        from statsmodels.stats.multitest import multipletests
        planned = self.summary["registered"]["comparisons"]
        cells = [planned[pair][metric] for pair in ("A-B", "B-C") for metric in METRICS if metric in planned[pair]]
        self.assertGreaterEqual(len(cells), 4)
        rejected, adjusted = multipletests([cell["p"] for cell in cells], alpha=0.01, method="holm")[:2]
        for cell, p, found in zip(cells, adjusted, rejected):
            self.assertAlmostEqual(cell["p_holm"], p, delta=EXACT)
            self.assertEqual(cell["found"], found)
        self.assertEqual(self.summary["registered"]["alpha"], 0.01)

    def manova(self, frame, formula, metrics, found):
        from statsmodels.multivariate.manova import MANOVA
        test = MANOVA.from_formula(f"{' + '.join(metrics)} ~ {formula}", frame).mv_test()
        # Sums to zero, so that a main effect is that of the mean over the other factor.
        for effect, term in (("condition", "C(condition, Sum)"), ("subject", "C(person, Sum)"),
                             ("interaction", "C(condition, Sum):C(person, Sum)")):
            if found[effect] is None:
                continue
            table = test.results[term]["stat"]
            self.assertAlmostEqual(found[effect]["wilks_lambda"], table.loc["Wilks' lambda", "Value"], delta=EXACT)
            self.assertAlmostEqual(found[effect]["f"] / table.loc["Wilks' lambda", "F Value"], 1.0, delta=EXACT)
            self.assertAlmostEqual(found[effect]["p"], table.loc["Wilks' lambda", "Pr > F"], delta=EXACT)
            self.assertAlmostEqual(found[effect]["pillai_trace"], table.loc["Pillai's trace", "Value"], delta=EXACT)

    def test_the_manova_is_that_of_statsmodels(self):
        import pandas
        people = self.summary["recorded"]["participants"]
        values = self.values(people)
        frame = pandas.DataFrame([{"person": code, "condition": condition,
                                   **{f"m{k}": values[metric][i, j] for k, metric in enumerate(METRICS)}}
                                  for i, code in enumerate(people) for j, condition in enumerate("ABC")])
        self.assertFalse(frame.isna().any().any())
        self.manova(frame, "C(condition, Sum) + C(person, Sum)", ("m0", "m1", "m2"), self.summary["manova"])

    def test_the_manova_of_thirds_is_that_of_statsmodels(self):
        import pandas
        moving = {}
        for row in rows(self.out / "moving_averages.csv"):
            moving.setdefault((row["subject"], row["condition"]), []).append(row)
        frame = []
        for (subject, condition), windows in moving.items():
            for third in range(3):
                at = windows[third * 10]  # one whole window of 10 s each
                frame.append({"person": subject, "condition": condition, "rms": number(at["rms error [mm]"]),
                              "dwell": number(at["dwell ratio [-]"])})
        self.manova(pandas.DataFrame(frame), "C(condition, Sum) * C(person, Sum)", ("rms", "dwell"), self.summary["manova_thirds"])

    def test_the_plan_s_power_is_that_of_statsmodels_and_its_number_the_smallest(self):
        from statsmodels.stats.power import TTestPower
        plan = self.summary["plan"]
        self.assertEqual(plan["alpha"], 0.01)
        effects = {entry["effect"] for entry in plan["participants_needed"]}
        self.assertEqual(effects, {"observed", "half of it", "given"})
        checked = 0
        for entry in plan["participants_needed"]:
            if entry["effect"] == "observed":
                details = self.summary["t_test_details"][entry["comparison"]][entry["metric"]]
                self.assertEqual(entry["effect_dz"], details["hedges_gz"])
            for at in entry["at"]:
                def power(n, size=abs(entry["effect_dz"])):
                    with warnings.catch_warnings():  # SciPy's noncentral t warns in its far tails
                        warnings.simplefilter("ignore", RuntimeWarning)
                        known = TTestPower().power(size, n, 0.01)
                    return power_by_definition(size, n, 0.01) if numpy.isnan(known) else known
                n = at["participants"]
                self.assertAlmostEqual(at["power"], power(n), delta=1e-6)
                self.assertGreaterEqual(power(n), at["wanted_power"])
                if n > 2:
                    self.assertLess(power(n - 1), at["wanted_power"])
                checked += 1
        self.assertGreaterEqual(checked, 20)

    def test_the_definition_of_power_is_that_of_statsmodels(self):
        from statsmodels.stats.power import TTestPower
        for size, n in ((0.3, 20), (0.8, 12), (1.5, 5)):
            self.assertAlmostEqual(power_by_definition(size, n, 0.01), TTestPower().power(size, n, 0.01), delta=1e-9)

    def test_a_changed_registration_and_a_changed_folder_are_named(self):
        copy = self.folder / "copy"
        shutil.copytree(self.experiment, copy)
        shutil.rmtree(copy / "report")
        file = copy / "experiment.yaml"
        whole = file.read_text()
        file.write_text(whole.replace("most_rms_deviations: 1.5", "most_rms_deviations: 1.6"))
        self.refused_for("pre-registration changed", "experiment", "report", copy)
        self.refused_for("pre-registration changed", "study", "--sessions", copy, "--out", self.folder / "none")
        file.write_text(whole)
        shutil.rmtree(copy / "participants" / "P02" / "sessions" / "01")
        self.refused_for("missing", "experiment", "report", copy)
        self.refused_for("--plan-effect", "experiment", "report", self.experiment, "--plan", "--plan-effect", 0)
        self.refused_for("--plan", "study", "--plan", "--out", self.folder / "none")
        self.assertFalse((copy / "report").exists())


if __name__ == "__main__":
    lab_process.main(WRITE_SAMPLE)
