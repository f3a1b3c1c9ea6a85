# SPDX-License-Identifier: Apache-2.0
"""A load cell indicator on a serial port, emulated: its calibration. `--campaign`: a session whose indicator falls
silent; by default `faults/device_faults.py --alone` does that without a session.
"""
import calibrate_test
import devices_test
import lab_process
import yaml


class IndicatorTest(devices_test.DevicesCase):
    calibrate = calibrate_test.CalibrateTest.calibrate

    def test_a_calibration_finds_gain_and_zero(self):
        self.config = self.folder / "config"
        self.laboratory = self.laboratory(indicator=True)  # as the borrowed calibrate() names it
        # Nobody holds the stick.
        (self.config / "rig.yaml").write_text("body:\n  neuromuscular:\n    involuntary_force_n: 0\n    tremor_force_n: 0\n")
        (self.config / "sensing.yaml").write_text("load_cell_sensitivity_v_n: 0.12\n")
        status, said, errors = self.calibrate("force", "pull", [0, 5, 10, -5, -10, 0])
        self.assertEqual((status, errors), (0, ""), said)
        found = yaml.safe_load((self.config / "sensing.yaml").read_text())
        self.assertAlmostEqual(found["load_cell_sensitivity_v_n"], 0.1, delta=0.001)
        kept = yaml.safe_load((self.config / "calibration.yaml").read_text())["force"]
        self.assertIn(f"indicator at {self.folder / 'indicator'}, serial unknown", kept["device"])

    @lab_process.campaign
    def test_an_indicator_that_falls_silent_ends_the_torque_and_is_named(self):
        lab, laboratory = self.pushing_session(indicator=True)
        laboratory.order("indicator_silent", 1)
        self.assert_torque_ended(laboratory, devices_test.HOST_LIMIT_MS, "silence of the indicator")
        self.assertEqual(lab.end_status(), 1, lab.errors())
        summary = lab.summary()
        self.assertEqual(summary["rig"]["parts"]["force"], "indicator")
        self.assertIn("the load cell is silent, or at its end", summary["trials"][-1]["aborted"])
        self.assert_nothing_left(lab)


if __name__ == "__main__":
    lab_process.main()
