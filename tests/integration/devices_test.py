# SPDX-License-Identifier: Apache-2.0
"""`stillhand lab --rig devices` over an emulated servo drive and an emulated platform.

By default: a session whose rig process is stopped while the motor pushes, so that the drive's own watchdog has to end
the torque; a platform that takes its time; a drive and a port that are refused before the session.
`--campaign`: conditions A, B and C, admittance and feedthrough, each next to the simulated rig; a mixture. The faults
are in tests/faults/device_faults.py.
STILLHAND_WATCHDOG_MS and STILLHAND_MAX_AGE_MS set the two limits, for figures of an idle machine.
"""
import json
import os
import re
import signal
import socket
import statistics
import struct
import threading
import time

import lab_process
from emulated_laboratory import MAX_AGE_MS, PROGRAM, WATCHDOG_MS, EmulatedLaboratory
from lab_process import TRIAL_LIMIT_S, LabTestCase, campaign, loose_settings, \
    next_domain, quick_session, wait_for

# From a fault to the end of the torque. A host that lives notices by the age of the newest reply or by the drive's
# counter (20 ms more), and stops the drive, or its force ramps down in 40 ticks. A host that does not live leaves it to
# the watchdog. 5 ms: the emulator looks each millisecond, and a command may be under way.
HOST_LIMIT_MS = MAX_AGE_MS + 20 + 40 + 5
DRIVE_LIMIT_MS = WATCHDOG_MS + 5
PUSH_N_M = 0.1  # 1 N at the hand


class DevicesCase(LabTestCase):
    def laboratory(self, config=None, **keywords):
        laboratory = EmulatedLaboratory(config or self.folder / "config", **keywords)
        self.addCleanup(laboratory.close)
        return laboratory

    def pushing_session(self, **keywords):
        """A session in condition C, in which the emulated drive pushes.

        A host that stalls makes samples too old, and devices silent: the interlock rightly ends that session, and
        another one begins.
        """
        for left in (2, 1, 0):
            folder = self.folder / f"pushing-{left}"
            domain = next_domain()
            arguments = quick_session(folder / "config")
            laboratory = self.laboratory(folder / "config", domain=domain, **keywords)
            lab = self.lab("--rig", "devices", *arguments, domain=domain, out=folder / "run")
            try:
                lab.wait_for_tick(1, 1, TRIAL_LIMIT_S)
                self.wait_for_push(lab, laboratory)
            except AssertionError as why:
                if left == 0 or not re.search("come too late|is silent", str(why)):
                    raise
                print(f"another session: {why}", flush=True)
                laboratory.close()
                continue
            return lab, laboratory

    @staticmethod
    def wait_for_push(lab, laboratory):
        lab.wait_for("a torque of the drive", lambda: abs(laboratory.report()["torque_n_m"]) > PUSH_N_M, 10, 0.002)

    def assert_torque_ended(self, laboratory, limit_ms, what):
        """The torque ended in time and stays away; every command kept the rules."""
        wait_for("end of the torque", lambda: laboratory.report()["since_fault_ms"] > 500, 10)
        seen = laboratory.report()
        print(f"{what}: torque until {seen['torque_after_fault_ms']:.1f} ms after the fault, mode {seen['mode']}, "
              f"watchdog {seen['timeouts']}, last torque {seen['torque_after_command_ms']:.1f} ms after its command, "
              f"slowest step of the emulator {seen['worst_step_ms']:.1f} ms", flush=True)
        self.assertEqual(seen["torque_n_m"], 0.0)
        self.assertLess(seen["torque_after_fault_ms"], limit_ms + seen["worst_step_ms"])
        self.assertLess(seen["torque_after_command_ms"], DRIVE_LIMIT_MS + seen["worst_step_ms"])
        self.assert_rules(seen)
        return seen

    def assert_rules(self, seen):
        self.assertGreater(seen["commands"], 100)
        for rule in ("other_modes", "without_watchdog", "with_gains", "without_bound"):
            self.assertEqual(seen[rule], 0, rule)
        self.assertLessEqual(seen["most_torque_n_m"], 2.5)
        self.assertEqual(seen["first_torque_n_m"], 0.0)  # of the command that arms

    def assert_like_the_simulated_rig(self, **keywords):
        """A whole session, conditions A, B and C, over the devices and over the simulated rig."""
        session = ["--conditions", "A,B,C", "--trial-seconds", 20, "--identify-seconds", 40, "--seed", 5]
        simulated = self.lab(*session, out=self.folder / "simulated")
        self.assertEqual(simulated.end_status(200), 0, simulated.errors())
        domain = next_domain()
        laboratory = self.laboratory(domain=domain, **keywords)
        devices = self.lab("--rig", "devices", *session, "--config", self.folder / "config",
                           out=self.folder / "devices", domain=domain)
        self.assertEqual(devices.end_status(200), 0, devices.errors())
        seen = laboratory.report()
        self.assert_rules(seen)
        self.assertEqual(seen["timeouts"], 0)
        for name, key in (("RMS error [mm]", "rms_error_mm"), ("dwell ratio", "dwell_ratio"), ("f_c [Hz]", "crossover_hz")):
            rows = [[lab.summary()["conditions"][each][key]["mean"] for each in "ABC"] for lab in (simulated, devices)]
            print(f"{name}: simulated {rows[0]}, devices {rows[1]}", flush=True)
        print("held-out VAF:", [lab.summary()["identification"]["heldout_vaf_percent"] for lab in (simulated, devices)],
              "latency [us]:", [lab.summary()["conditions"]["C"]["sensor_to_force_us"] for lab in (simulated, devices)],
              flush=True)
        for each in "ABC":
            errors = [lab.summary()["conditions"][each]["rms_error_mm"]["mean"] for lab in (simulated, devices)]
            self.assertLess(abs(errors[1] / errors[0] - 1.0), RMS_TOLERANCE, each)


def marked_and_stopped(laboratory, pid):
    """Marks the fault and stops the process; the time that both took [ms], in which it still commands."""
    began = time.monotonic()
    laboratory.order("mark")
    os.kill(pid, signal.SIGSTOP)
    return 1e3 * (time.monotonic() - began)


class SlowMoog(threading.Thread):
    """The lateral axis of a Moog that rises for some time, as far as its packets say (emulators/moog_emulator.hpp).

    It is where it was asked to be. Eight words come, ten go back, of four bytes each, big-endian.
    """
    ENGAGE, PARK, IDLE, STANDBY, ENGAGED = 180, 210, 1, 2, 3

    def __init__(self, rises_s):
        super().__init__(daemon=True)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", 0))
        self.port = self.socket.getsockname()[1]
        self.rises_s = rises_s
        self.rose = []  # when it was asked to engage, and when it was engaged

    def run(self):
        state, position_m = self.IDLE, 0.0
        while True:
            packet, client = self.socket.recvfrom(64)
            words = struct.unpack(">I6fI", packet)
            if words[0] == self.ENGAGE and state != self.ENGAGED:
                self.rose = self.rose or [time.monotonic()]
                if time.monotonic() - self.rose[0] > self.rises_s:
                    state = self.ENGAGED
                    self.rose.append(time.monotonic())
            elif words[0] == self.PARK:
                state = self.STANDBY
            elif state == self.ENGAGED:
                position_m = words[6]
            self.socket.sendto(struct.pack(">4I6f", 0, 0, state, 0, 0, 0, 0, 0, position_m, 0), client)


class DevicesTest(DevicesCase):
    @campaign
    def test_a_platform_that_rises_for_three_seconds_delays_the_trial_and_ends_nothing(self):
        config = loose_settings(self.folder / "config")
        moog = SlowMoog(3.0)
        moog.start()
        parts = {name: "simulated" for name in ("acceleration", "force", "angle", "motor")} | {"platform": "moog_udp"}
        (config / "devices.yaml").write_text("\n".join(
            ["signals:"] + [f"  {name}: {part}" for name, part in parts.items()] +
            ["platform:", f"  port: {moog.port}", "  period_ticks: 16", "  max_age_ticks: 200",
             "calibration:", "  max_age_days: 0"]) + "\n")
        lab = self.lab("--rig", "devices", "--conditions", "A", "--identify-seconds", 5, "--trial-seconds", 5,
                       "--seed", 2, "--config", config)
        self.assertEqual(lab.end_status(TRIAL_LIMIT_S), 0, lab.errors())
        self.assertGreater(moog.rose[-1] - moog.rose[0], 3.0)
        self.assertTrue(all(trial["completed"] for trial in lab.summary()["trials"]), lab.summary()["trials"])
        self.assertIn(["experiment", "trial 0 begins later: not everything is prepared yet"], lab.recording(1)["notes"])

    def test_a_rig_process_that_stops_leaves_no_torque(self):
        lab, laboratory = self.pushing_session()
        pid = lab.pid_of("device_rig")
        seen = self.assert_torque_ended(laboratory, DRIVE_LIMIT_MS + marked_and_stopped(laboratory, pid),
                                        "SIGSTOP of the rig's process")
        self.assertEqual(seen["timeouts"], 1)
        self.assertEqual(lab.end_status(), 1, lab.errors())
        self.assert_nothing_left(lab)
        parts = {"acceleration": "drive", "force": "drive", "angle": "drive", "motor": "drive", "platform": "plain_udp"}
        self.assertEqual(lab.summary()["rig"], {"kind": "devices", "parts": parts})

    def test_a_drive_that_damps_after_a_timeout_is_refused_with_the_command_that_mends_it(self):
        self.laboratory(settings=["servo.timeout_mode=12"])
        lab = self.lab("--rig", "devices", "--config", self.folder / "config")
        self.assertEqual(lab.end_status(), 2, lab.errors())
        self.assertIn("servo.timeout_mode: got 12, want 0: the driver is off after a timeout; this mends it: "
                      "conf set servo.timeout_mode 0, then conf write", lab.errors()[-1])

    def test_a_load_cell_of_the_wrong_sign_gives_no_model_and_no_force(self):
        arguments = quick_session(self.folder / "config")
        domain = next_domain()
        laboratory = self.laboratory(domain=domain)
        laboratory.order("swapped", 1)
        lab = self.lab("--rig", "devices", *arguments, domain=domain)
        self.assertEqual(lab.end_status(TRIAL_LIMIT_S), 1, lab.errors())
        self.assertIn("an idle hand stays behind the seat", lab.errors()[-1])
        self.assertEqual(laboratory.report()["most_torque_n_m"], 0.0)

    def test_two_sensors_of_the_wrong_sign_end_the_session_before_any_force(self):
        arguments = quick_session(self.folder / "config")
        domain = next_domain()
        laboratory = self.laboratory(domain=domain)
        laboratory.order("swapped", 1)
        laboratory.order("turned", 1)
        lab = self.lab("--rig", "devices", *arguments, domain=domain)
        self.assertEqual(lab.end_status(TRIAL_LIMIT_S), 1, lab.errors())
        self.assertIn("the accelerometer moves against the platform", lab.summary()["trials"][-1]["aborted"])
        self.assertEqual(laboratory.report()["most_torque_n_m"], 0.0)

    def test_a_port_that_is_not_there_is_refused(self):
        laboratory = self.laboratory()
        laboratory.close()
        (self.folder / "drive").unlink(missing_ok=True)
        lab = self.lab("--rig", "devices", "--config", self.folder / "config")
        self.assertEqual(lab.end_status(), 2, lab.errors())
        self.assertIn(f"devices.yaml: devices.drive.port: serial port {self.folder / 'drive'}: "
                      "got No such file or directory", lab.errors()[-1])

    # A stick on a desk, its power stage off: condition B with a simulated platform.
    @campaign
    def test_a_mixture_runs_and_is_named_and_a_motor_that_is_off_is_never_driven(self):
        domain = next_domain()
        arguments = quick_session(self.folder / "config")
        laboratory = self.laboratory(domain=domain, acceleration="simulated", platform="simulated", motor="off")
        (self.folder / "config" / "sensing.yaml").write_text(
            "load_cell_sensitivity_v_n: 0.02\nload_cell_offset_v: 1.651\n")
        lab = self.lab("--rig", "devices", *arguments, "--conditions", "B", "--trial-seconds", 5, domain=domain)
        self.assertEqual(lab.end_status(TRIAL_LIMIT_S), 0, lab.errors())
        seen = laboratory.report()
        self.assertEqual((seen["commands"], seen["most_torque_n_m"]), (0, 0.0))
        self.assertGreater(seen["queries"], 1000)
        words = "force drive, angle drive, motor off; simulated: acceleration, platform"
        self.assertIn(f"rig: {words}\n", lab.output())
        self.assertIn(["rig", f"rig of devices: {words}"], lab.recording(1)["notes"])
        self.assertIn(f"rig of devices: {words}", (lab.out / "session.html").read_text())
        self.assertIsNone(lab.summary()["conditions"]["B"]["cancelled_share"])

    @campaign
    def test_a_session_over_the_devices_is_like_one_of_the_simulated_rig(self):
        self.assert_like_the_simulated_rig()

    # Motor and platform move the free stick at once. The arm's stiffness wanders by some 10 %; the median difference of
    # the lines was 0.14 to 0.22.
    @campaign
    def test_admittance_and_feedthrough_over_the_devices_are_like_those_of_the_simulated_rig(self):
        session = ["--identify", "admittance,feedthrough", "--perturb-period-s", 10, "--trial-seconds", 60,
                   "--identify-seconds", 10, "--seed", 5]
        simulated = self.lab(*session, out=self.folder / "simulated")
        self.assertEqual(simulated.end_status(200), 0, simulated.errors())
        domain = next_domain()
        laboratory = self.laboratory(domain=domain)
        devices = self.lab("--rig", "devices", *session, "--config", self.folder / "config",
                           out=self.folder / "devices", domain=domain)
        self.assertEqual(devices.end_status(200), 0, devices.errors())
        self.assert_rules(laboratory.report())
        found = []
        for lab in (simulated, devices):
            file = lab.out / "admittance.json"
            self.run_verb("identify", lab.out / "session.mcap", "--admittance", "--json", file)
            found.append(json.loads(file.read_text()))
        self.assertLessEqual(found[1]["largest_motor_force_n"], PERTURBATION_PEAK_N)
        for name in ("admittance_m_n", "feedthrough_to_force_n_s2_m", "feedthrough_to_position_s2"):
            first, second = ([complex(line["real"], line["imaginary"]) for line in each[name]
                              if line["frequency_hz"] > 2] for each in found)
            errors = [abs(theirs / own - 1) for own, theirs in zip(first, second)]
            print(f"{name}: median difference {statistics.median(errors):.2f} of {len(errors)} lines", flush=True)
            self.assertGreater(len(errors), 10)
            self.assertLess(statistics.median(errors), 0.3)  # as admittance_test from the closed form


# The bound of the perturbation, services/core/admittance, ExcitationConfig::peak_force_n.
PERTURBATION_PEAK_N = 8.0
# The RMS error of a trial of 20 s varies from repeat to repeat; see tests/emulators/README.md.
RMS_TOLERANCE = 0.15

if __name__ == "__main__":
    lab_process.main(PROGRAM)
