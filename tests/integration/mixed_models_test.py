#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""mixed_models.py on tables whose effects are known."""
import json
import subprocess
import sys

import numpy

import lab_process
from lab_process import CTEST_SKIPPED, SOURCE
from verb_case import FolderCase

SCRIPT = SOURCE / "apps" / "study" / "mixed_models.py"
HEADER = "participant,session,trial,place,condition,rms error [mm],dwell ratio [-],crossover [Hz]\n"
EFFECT = {"A": -30.0, "B": 0.0, "C": -15.0}
LEARNING = -0.8  # [mm] a trial


def run(path):
    return subprocess.run([sys.executable, str(SCRIPT), str(path)], capture_output=True, text=True, timeout=120)


def table(people, noise):
    """Two blocks in a rotated order for each participant."""
    random = numpy.random.default_rng(7)
    lines = []
    for person in range(people):
        own = random.normal(0.0, 4.0)
        for place in range(1, 7):
            condition = "ABC"[(person + place) % 3]
            error = 55.0 + own + EFFECT[condition] + LEARNING * place + random.normal(0.0, noise)
            lines.append(f"P{person + 1:02},01,{place},{place},{condition},{error},{0.3 + 0.01 * random.normal()},\n")
    return HEADER + "".join(lines)


class MixedModelsTest(FolderCase):
    def setUp(self):
        super().setUp()
        self.path = self.folder / "trials.csv"

    def test_the_effects_of_condition_and_learning_are_found_next_to_people_who_differ(self):
        self.path.write_text(table(12, 0.5))
        result = run(self.path)
        self.assertEqual(result.returncode, 0, result.stderr)
        found = json.loads(result.stdout)["rms_error_mm"]
        wanted = {"A-B": EFFECT["A"], "C-B": EFFECT["C"], "place": LEARNING}
        for name, value in wanted.items():
            effect = found["effects"][name]
            self.assertLess(abs(effect["estimate"] - value), 4 * effect["standard_error"], name)
            self.assertLess(effect["p"], 0.01, name)
        self.assertAlmostEqual(found["residual_variance"], 0.25, delta=0.12)
        self.assertGreater(found["participant_variance"], 4.0)

    def test_a_trial_that_is_not_in_the_tables_has_no_say(self):
        head, *lines = table(6, 0.5).splitlines()
        marked = "\n".join([head + ",in tables", *(line + ",1" for line in lines)]) + "\n"
        self.path.write_text(marked)
        found = run(self.path).stdout
        self.assertIn('"estimate"', found)
        self.path.write_text(marked + lines[0].rsplit(",", 3)[0] + ",900.0,0.9,,0\n")
        self.assertEqual(run(self.path).stdout, found)

    def test_a_metric_without_values_has_a_reason(self):
        self.path.write_text(table(4, 1.0))
        self.assertIn("too few", json.loads(run(self.path).stdout)["crossover_hz"]["reason"])

    def test_another_table_is_refused_with_one_line(self):
        self.path.write_text("a,b\n1,2\n")
        result = run(self.path)
        self.assertEqual((result.returncode, result.stdout), (2, ""))
        self.assertRegex(result.stderr, r"^mixed_models: .*no column .*trials\.csv of a study\n$")


if __name__ == "__main__":
    try:
        import statsmodels  # noqa: F401
    except ImportError:
        print("skipped: python3-statsmodels is not installed")
        sys.exit(CTEST_SKIPPED)
    lab_process.main()
