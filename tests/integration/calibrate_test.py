# SPDX-License-Identifier: Apache-2.0
"""`stillhand calibrate` on an emulated drive and platform; a session then asks for the calibration. About 70 s.

The emulator's amplifiers are those of tests/emulators/laboratory.cpp; their numbers in sensing.yaml are what the verb
has to find again from numbers that are wrong by up to 20 %.
"""
import cmath
import math
import os
import shutil
import subprocess
import unittest

import yaml
from emulated_laboratory import PROFILES, SENSING, EmulatedLaboratory
from lab_process import SOURCE, STILLHAND, LabTestCase, next_domain, wait_for

PROGRAMS = STILLHAND.parent
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
        """Makes the steps of a person; `quantities` are what the emulator's `order` gets at each step.

        A quantity that is a tuple is an order of its own.
        """
        person, terminal = os.openpty()
        process = subprocess.Popen(
            [str(STILLHAND), "calibrate", signal, "--config", str(self.config), "--person", "kl", "--seconds", "0.5",
             *map(str, words)], stdin=terminal, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        os.close(terminal)
        said = []
        try:
            for line in process.stdout:
                said.append(line)
                if line.startswith("step ") and quantities:
                    wanted = quantities.pop(0)
                    self.laboratory.order(*(wanted if isinstance(wanted, tuple) else (order, wanted)))
                    os.write(person, b"\n")
                elif line.startswith("step "):
                    os.write(person, b"\x04")  # the end of the input
        finally:
            status = process.wait(60)
            errors = process.stderr.read()
            process.stdout.close()
            process.stderr.close()
            os.close(person)
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
        # Nothing but the force changed, and the input holds 82 N: (3.3 - 1.651) V at 0.02 V/N.
        self.assertLess(kept["force"]["cross_acceleration_m_s2"], 0.02)
        self.assertLess(kept["force"]["cross_angle_rad"], 0.01)
        self.assertGreater(kept["force"]["input_high"], 50)
        status, line = self.session_says()
        self.assertEqual(status, 2, line)
        self.assertIn("calibration.yaml: platform: got no calibration of plain_udp at 127.0.0.1", line)

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

    def test_nobody_but_a_person_at_a_terminal_confirms_a_step(self):
        for signal in ("force", "platform", "check"):
            refused = subprocess.run(
                [str(STILLHAND), "calibrate", signal, "--config", str(self.config), "--person", "kl"], input="\n" * 100,
                capture_output=True, text=True, timeout=60, check=False)
            self.assertEqual((refused.returncode, refused.stdout), (2, ""))
            self.assertIn("standard input: got no terminal", refused.stderr)

    def test_a_simulated_sensor_is_refused(self):
        devices = self.config / "devices.yaml"
        devices.write_text(devices.read_text().replace("force: drive", "force: simulated"))
        status, _, errors = self.calibrate("force", "pull", [])
        self.assertEqual(status, 2)
        self.assertIn("signals.force: got simulated, want a device", errors)

    PLATFORM = {"loop_frequency_hz": 3.0, "loop_damping": 0.8, "acceleration_feedforward": 0.0, "torque_lag_s": 0.002}

    def other_rig(self, **groups):
        """The emulators again, with another body or platform behind them."""
        self.laboratory.close()
        settings = {"body": {"neuromuscular": {"involuntary_force_n": 0, "tremor_force_n": 0}}} | groups
        (self.config / "rig.yaml").write_text(yaml.safe_dump(settings))
        self.laboratory = EmulatedLaboratory(self.config)
        self.addCleanup(self.laboratory.close)

    def response(self, frequency_hz):
        """Closed form of the emulated platform (services/processes/rig, Eq. RG-1)."""
        s = 2j * math.pi * frequency_hz
        w, z = 2 * math.pi * self.PLATFORM["loop_frequency_hz"], self.PLATFORM["loop_damping"]
        return (2 * z * w * s + w * w) / (self.PLATFORM["torque_lag_s"] * s ** 3 + s * s + 2 * z * w * s + w * w)

    def test_a_platforms_lag_and_bandwidth_are_those_of_its_closed_form(self):
        self.other_rig(platform=self.PLATFORM)
        status, said, errors = self.calibrate("platform", "mark", [0], "--periods", 3)
        self.assertEqual((status, errors), (0, ""), said)
        found = self.settings("calibration.yaml")["platform"]
        self.assertEqual((found["person"], found["device"].split(",")[0]), ("kl", "plain_udp at 127.0.0.1"))
        low, high = 0.5, 20.0
        while high - low > 1e-6:
            middle = math.sqrt(low * high)
            below = abs(self.response(middle)) < abs(self.response(0.5)) / math.sqrt(2)
            low, high = (low, middle) if below else (middle, high)
        # Between two lines of the test the response is taken as straight in the logarithms.
        self.assertAlmostEqual(found["bandwidth_hz"] / low, 1.0, delta=0.05)
        lines = [0.5, 1, 1.5, 2, 3, 4]
        lag_s = sum(-cmath.phase(self.response(f)) * f for f in lines) / (2 * math.pi * sum(f * f for f in lines))
        # The exchange itself: a set-point leaves in one tick, and its state is read in the next one or two.
        self.assertGreater(found["lag_s"], lag_s)
        self.assertLess(found["lag_s"], lag_s + 0.004)
        self.assertAlmostEqual(found["seat_gain"], 1.0, delta=0.05)
        self.assertLess(self.laboratory.report()["platform_most_step_m"], 0.001)
        # An accelerometer that is turned round.
        self.laboratory.order("turned", 1)
        status, said, errors = self.calibrate("platform", "mark", [0], "--periods", 2)
        self.assertEqual(errors.count("\n"), 1)
        self.assertNotEqual(status, 0)
        self.assertIn("the accelerometer moves against the platform", errors)

    STEPS = [("turn", 0.5236), ("turn", -0.5236), ("turn", 0), ("pull", 1), ("pull", 0), ("mark", 0)]
    # A light hand, which the rig cannot be without.
    SOFT = {"shoulder_stiffness_n_m": 50, "shoulder_damping_n_s_m": 1, "grip_stiffness_n_m": 200, "arm_mass_kg": 0.3,
            "cocontraction_stiffness_factor": 1, "cocontraction_damping_factor": 1,
            "neuromuscular": {"involuntary_force_n": 0, "tremor_force_n": 0}}

    def test_the_check_with_the_hand_off(self):
        self.other_rig(body=self.SOFT)
        status, said, errors = self.calibrate("check", "", list(self.STEPS))
        self.assertEqual((status, errors), (0, ""), said)
        found = self.settings("calibration.yaml")["check"]
        self.assertIn("AUX1", found["devices"])
        for name in ("force_gain", "torque_gain", "platform_gain", "seat_gain"):
            self.assertAlmostEqual(found[name], 1.0, delta=0.25, msg=name)
        self.assertGreater(found["pushed_right_m"], 0.001)
        self.assertLess(found["pushed_left_m"], -0.001)
        seen = self.laboratory.report()
        self.assertEqual((seen["first_torque_n_m"], seen["mode"]), (0.0, 0))
        self.assertLess(seen["most_torque_n_m"], 0.11)
        for rule in ("other_modes", "without_watchdog", "with_gains", "without_bound"):
            self.assertEqual(seen[rule], 0, rule)
        self.judge_session()
        self.judge_wrong_signs()

    def rig_refuses(self):
        """The line with which the session's rig process refuses these devices; None: it goes on to query them."""
        asked = self.laboratory.report()["queries"]
        words = [str(PROGRAMS / "stillhand-device_rig"), "--config", str(self.config), "--domain", str(next_domain()),
                 "--profiles", str(PROFILES)]
        with subprocess.Popen(words, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as rig:
            self.addCleanup(rig.kill)
            wait_for("a refusal, or queries",
                     lambda: rig.poll() is not None or self.laboratory.report()["queries"] > asked + 50, 20)
            if rig.poll() is None:
                rig.terminate()
                self.assertEqual(rig.wait(10), 0)
                return None
            self.assertEqual(rig.returncode, 2)
            return rig.stderr.read().strip()

    def judge_session(self):
        """Behind a good check a session's rig refuses another sign or lever."""
        kept = self.settings("calibration.yaml")
        # The other calibrations, as their verbs would write them: the same names, and what sensing.yaml holds.
        _, *names = kept["check"]["devices"].split("; ")
        made = {"date": kept["check"]["date"], "person": "kl"}
        sensing = self.settings("sensing.yaml")
        numbers = {"force": ("load_cell_sensitivity_v_n", "load_cell_offset_v"),
                   "acceleration": ("accel_sensitivity_v_m_s2", "accel_y_offset_v"), "angle": (None, None)}
        for signal, device in zip(("force", "acceleration", "angle", "platform"), names, strict=True):
            gain, zero = numbers.get(signal, (None, None))
            values = {"sensitivity": sensing.get(gain, 1), "zero": sensing.get(zero, 0)} if signal != "platform" else {}
            kept[signal] |= made | {"device": device} | values
        (self.config / "calibration.yaml").write_text(yaml.safe_dump(kept))
        devices, rig = self.config / "devices.yaml", self.config / "rig.yaml"
        devices.write_text(devices.read_text().replace("max_age_days: 0", "max_age_days: 90"))
        self.assertIsNone(self.rig_refuses())

        plain = {devices: devices.read_text(), rig: rig.read_text()}
        for file, text, record, name in (
                (devices, "drive:\n  torque_sign: -1\n", "check", "torque sign -1"),
                (devices, "drive:\n  angle_sign: -1\n", "angle", "encoder, sign -1"),
                (rig, "stick:\n  lever_m: 0.12\n", "check", "lever 0.12 m")):
            with self.subTest(name):
                file.write_text(plain[file].replace("drive:\n", text) if file == devices else plain[file] + text)
                line = self.rig_refuses()
                file.write_text(plain[file])
                self.assertIsNotNone(line)
                self.assertIn(f"calibration.yaml: {record}: got a calibration of", line)
                self.assertIn(name, line.split("want one of")[1])

    def judge_wrong_signs(self):
        devices = self.config / "devices.yaml"
        plain = devices.read_text()
        for name, steps, text, why in (
                ("the other side", [("turn", -0.5236), ("turn", 0.5236)], plain, "change drive.angle_sign"),
                ("wires the wrong way round", [*self.STEPS[:3], ("pull", -1)], plain, "the sign is wrong"),
                ("torque", self.STEPS[:5], plain.replace("drive:\n  port", "drive:\n  torque_sign: -1\n  port"),
                 "change drive.torque_sign")):
            with self.subTest(name):
                devices.write_text(text)
                status, said, errors = self.calibrate("check", "", list(steps))
                self.assertEqual(status, 1, said)
                self.assertIn(why, errors)
                self.laboratory.order("pull", 0)
        # What was right before does not count any more.
        self.assertEqual(self.settings("calibration.yaml")["check"]["date"], "")


if __name__ == "__main__":
    unittest.main()
