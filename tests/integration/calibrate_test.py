# SPDX-License-Identifier: Apache-2.0
"""`stillhand calibrate` reads the sensors of an emulated drive; a session then asks for the calibration. About 30 s.

The emulator's amplifiers are those of tests/emulators/laboratory.cpp; their numbers in sensing.yaml are what the verb
has to find again from numbers that are wrong by up to 20 %.
"""
import shutil
import subprocess
import unittest

import yaml
from emulated_laboratory import SENSING, EmulatedLaboratory
from lab_process import SOURCE, STILLHAND, LabTestCase, next_domain

TRUE = yaml.safe_load(SENSING)
WRONG = """load_cell_sensitivity_v_n: 0.024   # typed
# accel_y_offset_v: 0.01               # [V] voltage at 0 m/s^2
accel_sensitivity_v_m_s2: 0.09
adc_range_v: 3.3
"""


class CalibrateTest(LabTestCase):
    def setUp(self):
        super().setUp()
        self.config = self.folder / "config"
        shutil.copytree(SOURCE / "deploy" / "config", self.config)
        # Nobody holds the stick.
        (self.config / "rig.yaml").write_text("body:\n  neuromuscular:\n    involuntary_force_n: 0\n    tremor_force_n: 0\n")
        self.laboratory = EmulatedLaboratory(self.config)
        self.addCleanup(self.laboratory.close)

    def calibrate(self, signal, order, quantities, *words):
        """Makes the steps of a person; `quantities` are what the emulator's `order` gets at each step."""
        process = subprocess.Popen(
            [str(STILLHAND), "calibrate", signal, "--config", str(self.config), "--person", "kl", "--seconds", "0.5",
             *map(str, words)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        said = []
        try:
            for line in process.stdout:
                said.append(line)
                if line.startswith("step ") and quantities:
                    self.laboratory.order(order, quantities.pop(0))
                    process.stdin.write("\n")
                    process.stdin.flush()
                elif line.startswith("step "):
                    process.stdin.close()
        finally:
            status = process.wait(30)
            errors = process.stderr.read()
            for stream in (process.stdin, process.stdout, process.stderr):
                stream.close()
        return status, "".join(said), errors

    def settings(self, name):
        return yaml.safe_load((self.config / name).read_text())

    def session_says(self):
        domain = next_domain()
        lab = self.lab("--rig", "devices", "--config", self.config, domain=domain)
        return lab.end_status(), lab.errors()[-1]

    def test_three_sensors_are_calibrated_and_a_session_asks_for_it(self):
        (self.config / "sensing.yaml").write_text(WRONG)
        devices = self.config / "devices.yaml"
        devices.write_text(devices.read_text().replace("max_age_days: 0", "max_age_days: 90"))
        status, line = self.session_says()
        self.assertEqual(status, 2, line)
        self.assertIn("calibration.yaml: force: got no calibration of drive, serial", line)
        self.assertIn("stillhand calibrate force", line)

        status, said, errors = self.calibrate("force", "pull", [0, 5, 10, -5, -10, 0], "--sensor", "LC-7")
        self.assertEqual((status, errors), (0, ""), said)
        self.assertIn("AUX1", said)
        status, said, errors = self.calibrate("acceleration", "tilt", [0, 9.80665, -9.80665, 0])
        self.assertEqual((status, errors), (0, ""), said)
        status, said, errors = self.calibrate("angle", "turn", [0.2, 0.4, -0.4, 0.2], "--known", "0.2,0.4,-0.4")
        self.assertEqual((status, errors), (0, ""), said)

        found = self.settings("sensing.yaml")
        for key in ("load_cell_sensitivity_v_n", "accel_sensitivity_v_m_s2"):
            self.assertAlmostEqual(found[key] / TRUE[key], 1.0, delta=0.01, msg=key)
        # The drive's converters have steps of 0.8 mV.
        for key in ("load_cell_offset_v", "accel_y_offset_v"):
            self.assertAlmostEqual(found[key], TRUE[key], delta=0.002, msg=key)
        self.assertIn("# typed", (self.config / "sensing.yaml").read_text())
        kept = self.settings("calibration.yaml")
        self.assertEqual(kept["force"]["person"], "kl")
        self.assertEqual(kept["force"]["sensor"], "LC-7")
        self.assertEqual(kept["force"]["sensitivity"], found["load_cell_sensitivity_v_n"])

        # A number that somebody types over, and another drive.
        text = (self.config / "sensing.yaml").read_text()
        (self.config / "sensing.yaml").write_text(text.replace("load_cell_sensitivity_v_n: 0.", "load_cell_sensitivity_v_n: 0.1"))
        status, line = self.session_says()
        self.assertEqual(status, 2, line)
        self.assertIn("sensing.yaml: load_cell_sensitivity_v_n: got 0.1", line)
        (self.config / "sensing.yaml").write_text(text)
        self.laboratory.order("serial", 77)
        status, line = self.session_says()
        self.assertEqual(status, 2, line)
        self.assertRegex(line, r'got a calibration of "drive, serial \w+-\w+-001d003a, AUX1", want one of '
                               r'"drive, serial \w+-\w+-0000004d, AUX1"')

    def test_what_is_wrong_is_said_and_nothing_is_written(self):
        before = (self.config / "sensing.yaml").read_text()
        for name, quantities, words, why in (
                ("wires the wrong way round", [0, -5, -10, 5, 10, 0], (), "the reading falls where it must grow"),
                ("one wrong weight", [0, 5, 20, -5, -10, 0], (), "off the straight line"),
                ("a slip", [0, 5, 10, -5, -10, 3], (), "something slipped"),
                ("broken off", [0, 5], (), "broken off"),
                ("one side alone", [], ("--known", "0,5,10"), "to both sides of 0"),
                ("a unit of something else", [], ("--known", "0,5deg"), "--known: got 5deg")):
            with self.subTest(name):
                quantities = quantities or [0, 5, 10, 0] if "--known" in words else quantities
                status, said, errors = self.calibrate("force", "pull", quantities, *words)
                self.assertIn(why, errors, said)
                self.assertEqual(status, 2 if "--known" in words else 1)
                self.assertEqual(errors.count("\n"), 1)
        self.assertEqual((self.config / "sensing.yaml").read_text(), before)
        self.assertFalse((self.config / "calibration.yaml").exists())

    def test_a_simulated_sensor_is_refused(self):
        devices = self.config / "devices.yaml"
        devices.write_text(devices.read_text().replace("force: drive", "force: simulated"))
        status, _, errors = self.calibrate("force", "pull", [])
        self.assertEqual(status, 2)
        self.assertIn("signals.force: got simulated, want a device", errors)


if __name__ == "__main__":
    unittest.main()
