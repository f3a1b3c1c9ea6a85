#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Motor and platform move the free stick at once in a session over DDS; the recording gives admittance and feedthrough.

A minute: a pegged trial of 5 s, then six periods of 4 s, and the start of a session. `--campaign`: for each task three
sessions with six periods of 10 s, and what they say of the relation AD-16; 11 minutes.
"""
import json
import math
import re
import shutil
import statistics

from lab_process import BUILD, LabProcess, campaign, main
from verb_case import VerbCase

PERIOD_S = 4
PERIODS = 6
SESSION_LIMIT_S = 120
# Bound of the perturbation, services/core/admittance, ExcitationConfig::peak_force_n.
PEAK_N = 8.0


def admittance(settings, frequency_hz):
    """-X/F of the idle hand of the rig with these settings [m/N]; services/processes/rig, RG-3 and RG-5."""
    values = {name: float(value) for name, value in re.findall(r"^ +(\w+): ([-+.e\d]+)$", settings, re.M)}
    s = 2j * math.pi * frequency_hz
    shoulder = values["shoulder_stiffness_n_m"] + s * values["shoulder_damping_n_s_m"]
    grip = values["grip_stiffness_n_m"] + s * values["grip_damping_n_s_m"]
    trunk = values["trunk_mass_kg"] * s ** 2 + values["seat_stiffness_n_m"] + s * values["seat_damping_n_s_m"]
    # From the seat to the hand: springs in series, masses in parallel.
    at_arm = values["arm_mass_kg"] * s ** 2 + 1 / (1 / trunk + 1 / shoulder)
    at_hand = (values["hand_mass_kg"] + values["handle_mass_kg"]) * s ** 2 + 1 / (1 / at_arm + 1 / grip)
    return 1 / at_hand


def perturbed(test, out, period_s, periods, *words):
    """A session of one perturbed trial, to its end."""
    lab = LabProcess(out, "--identify", "admittance,feedthrough", "--perturb-period-s", period_s, "--trial-seconds",
                     period_s * periods, "--identify-seconds", 5, *words)
    test.addClassCleanup(lab.close)
    lab.wait_for("the end", lambda: lab.process.poll() is not None, SESSION_LIMIT_S, poll_s=0.5)
    return lab


class AdmittanceTest(VerbCase):
    @classmethod
    def setUpClass(cls):
        cls.out = BUILD / "tests" / "admittance_run"
        shutil.rmtree(cls.out, ignore_errors=True)
        cls.lab = perturbed(cls, cls.out, PERIOD_S, PERIODS, "--task", "relax")

    def setUp(self):
        self.assertEqual(self.lab.process.returncode, 0, self.lab.errors())

    def test_the_recording_gives_admittance_and_feedthrough(self):
        files = self.out / "admittance.json", self.out / "admittance.png"
        self.run_verb("identify", self.out / "session.mcap", "--admittance", "--json", files[0], "--picture", files[1])
        found = json.loads(files[0].read_text())
        self.assertEqual(found["periods"], PERIODS - 1)
        self.assertGreater(found["largest_motor_force_n"], 0.5 * PEAK_N)
        self.assertLessEqual(found["largest_motor_force_n"], PEAK_N)
        for name in ("admittance_m_n", "feedthrough_to_force_n_s2_m", "feedthrough_to_position_s2"):
            self.assertGreater(len(found[name]), 5)
            for line in found[name]:
                self.assertTrue(math.isfinite(line["radius95"]))
        # The relaxed body of the session in closed form. Its stiffness wanders by some 10 %, which moves the modes: half of
        # the lines above 2 Hz are within 30 %; a wrong sign, unit or filter is not.
        settings = (self.out / "logs" / "config" / "rig.yaml").read_text()
        errors = [abs(complex(line["real"], line["imaginary"]) / admittance(settings, line["frequency_hz"]) - 1)
                  for line in found["admittance_m_n"] if line["frequency_hz"] > 2]
        self.assertLess(statistics.median(errors), 0.3)
        self.assertEqual(files[1].read_bytes()[:4], b"\x89PNG")

    def test_another_recording_is_refused_in_one_line(self):
        self.refused("identify", self.out / "none.mcap", "--admittance")

    def test_the_trial_is_marked_as_what_it_was(self):
        trials = self.lab.summary()["trials"]
        self.assertEqual([trial["condition"] for trial in trials], ["I", "P"])
        self.assertTrue(all(trial["completed"] for trial in trials), trials)
        self.assertEqual(trials[1]["motion"]["kind"], "interleaved multisines")


class RelationTest(VerbCase):
    MISMATCH = {"relax": (0.0, 0.3), "hold": (0.25, 0.9), "give-way": (0.0, 0.3)}
    KINDS = {"free": [], "held": ["--held-stick"], "swapped": ["--swap-lines"]}

    @campaign
    def test_each_task_over_dds(self):
        out = BUILD / "tests" / "relation_run"
        shutil.rmtree(out, ignore_errors=True)
        for task in ("relax", "hold", "give-way"):
            files = {}
            for kind, words in self.KINDS.items():
                lab = perturbed(type(self), out / task / kind, 10, PERIODS, "--task", task, *words)
                self.assertEqual(lab.process.returncode, 0, lab.errors())
                lab.close()
                files[kind] = out / task / kind / "session.mcap"
            identify = ["identify", files["free"], "--admittance"]
            done = self.run_verb(*identify, "--held", files["held"], "--swapped", files["swapped"], "--json",
                                 out / f"{task}.json")
            print(f"{task}:", done.stdout.splitlines()[-1], flush=True)
            relation = json.loads((out / f"{task}.json").read_text())["relation"]
            # On the peg a hand that holds has no reflex, so the relation fails for it alone. Seen: 13, 47 and 8 %.
            low, high = self.MISMATCH[task]
            self.assertGreater(relation["median_mismatch"], low)
            self.assertLess(relation["median_mismatch"], high)
            self.refused(*identify, "--held", files["swapped"], "--swapped", files["held"])


if __name__ == "__main__":
    main()
