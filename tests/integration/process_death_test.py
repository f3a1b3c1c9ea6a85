# SPDX-License-Identifier: Apache-2.0
"""kill -9 of each service during a moving, cancelled trial: the motor force goes to zero, the lab names what died.

Detection is the first tick from which on the rig uses no motor command any more: the interlock is open
(motor_permitted false), the command is absent (motor_tick -1), or it answers a sample older than the rig's
max_motor_age_ticks. From there the force must be exactly zero within 50 ms, and stay zero to the recording's end.

Prints two times for each service: from the kill to the detection, and from there to zero. By default the display is
killed, whose absence only its life sign shows; `--campaign` kills each of the others.
"""
import os
import signal
import time

import lab_process
from lab_process import TICKS_PER_S, TRIAL_LIMIT_S, LabTestCase, campaign, quick_session

FORCE_LIMIT_TICKS = 50
MAX_MOTOR_AGE_TICKS = 10  # deploy/config/rig.yaml, motor.max_motor_age_ticks
# A life sign lasts for its lease, 300 ms (qos/README.md). In addition: the killed process's last sign may be on its way
# (the DDS deadline, 5 ms), the lease's timer counts in whole milliseconds (1 ms), and the rig, the interlock's event
# thread and the recorded tick are each at most as late as the rig may be before it shifts its schedule (3 x 5 ms).
DETECTION_LIMIT_NS = (300 + 5 + 1 + 3 * 5) * 1_000_000
# The recorder writes what it has every 500 ms (services/processes/recording/README.md), in batches of 50 ms.
RECORDER_LOSS_NS = 600_000_000


def motor_usable(rig, i):
    age = rig["tick"][i] - rig["motor_tick"][i]
    return rig["motor_permitted"][i] and rig["motor_tick"][i] >= 0 and age <= MAX_MOTOR_AGE_TICKS


def detection_index(rig):
    """Index of the first sample of the unusable ones that the recording ends with."""
    index = len(rig["tick"])
    while index > 0 and not motor_usable(rig, index - 1):
        index -= 1
    return index


class ProcessDeathTest(LabTestCase):
    def kill_during_trial(self, service):
        """Kills a service after a second of the trial; returns the ended lab and the kill's time [ns, monotonic]."""
        lab = self.lab(*quick_session(self.folder / "config"))
        lab.wait_for_tick(1, 1, TRIAL_LIMIT_S)
        pid = lab.pid_of(service)
        self.assertIsNotNone(pid, f"no process of {service}")
        killed_ns = time.monotonic_ns()
        os.kill(pid, signal.SIGKILL)
        status = lab.end_status()
        self.assertEqual(status, 1, lab.errors())
        self.assert_nothing_left(lab)
        self.assert_reported(lab, f"{service} (pid {pid}) ended: signal 9 (Killed)")
        return lab, killed_ns

    # The rig reports that its interlock opens. If the rig itself hangs, only its silence shows it.
    def test_a_rig_that_hangs_ends_the_session_and_is_named(self):
        lab = self.lab(*quick_session(self.folder / "config"))
        lab.wait_for_tick(1, 1, TRIAL_LIMIT_S)
        os.kill(lab.pid_of("rig"), signal.SIGSTOP)
        self.assertEqual(lab.end_status(), 1, lab.errors())
        self.assert_nothing_left(lab)
        self.assert_reported(lab, "rig ended: its life sign is gone")
        self.assertEqual(lab.recording(1)["damage"], [])

    def assert_reported(self, lab, death):
        self.assertEqual(len([line for line in lab.errors() if death in line]), 1, lab.errors())
        trial = lab.summary()["trials"][-1]
        self.assertEqual(trial["condition"], "C")
        self.assertFalse(trial["completed"])
        self.assertIn(death, trial["aborted"])
        self.assertNotIn("C", lab.summary()["conditions"])

    def assert_force_was_zero_in_time(self, service, lab, killed_ns):
        recording = lab.recording(100 * TICKS_PER_S)
        self.assertEqual(recording["damage"], [])
        rig = recording["rig"]
        force = rig["motor_force_n"]
        kill = next(i for i, stamp_ns in enumerate(rig["stamp_ns"]) if stamp_ns >= killed_ns)
        self.assertTrue(any(motor_usable(rig, i) for i in range(kill)))
        # There was a force to take away: a cancelled trial's is several newtons RMS.
        self.assertGreater(max(abs(f) for f in force[kill - TICKS_PER_S:kill]), 1.0)
        detection = detection_index(rig)
        self.assertLess(detection, len(force), "the rig did not notice the death")
        zero = next((i for i in range(detection, len(force)) if force[i] == 0.0), None)
        self.assertIsNotNone(zero, "the recording ends before the force is zero")
        ticks = rig["tick"][zero] - rig["tick"][detection]
        noticed_ns = rig["stamp_ns"][detection] - killed_ns
        print(f"{service}: noticed after {noticed_ns / 1e6:.0f} ms, force {force[detection - 1]:+.2f} N zero "
              f"{ticks} ticks ({(rig['stamp_ns'][zero] - rig['stamp_ns'][detection]) / 1e6:.1f} ms) later, "
              f"{len(force) - zero} ticks of it recorded", flush=True)
        self.assertLessEqual(ticks, FORCE_LIMIT_TICKS)
        self.assertEqual([f for f in force[zero:] if f != 0.0], [])
        # Rig and canceller have an interlock each, and one would hide the other.
        if service not in ("cancellation", "sensing"):  # without samples there is nothing to answer
            self.assertFalse(rig["motor_permitted"][zero], "the rig's interlock is closed")
            command = recording["newest_motor_command"]
            self.assertEqual((command["permitted"], command["force_n"]), (False, 0.0))
        self.assertLessEqual(noticed_ns, DETECTION_LIMIT_NS)

    @campaign
    def test_death_of_motion(self):
        self.assert_force_was_zero_in_time("motion", *self.kill_during_trial("motion"))

    @campaign
    def test_death_of_sensing(self):
        self.assert_force_was_zero_in_time("sensing", *self.kill_during_trial("sensing"))

    @campaign
    def test_death_of_cancellation(self):
        self.assert_force_was_zero_in_time("cancellation", *self.kill_during_trial("cancellation"))

    def test_death_of_display(self):
        self.assert_force_was_zero_in_time("display", *self.kill_during_trial("display"))

    @campaign
    def test_death_of_human_operator(self):
        self.assert_force_was_zero_in_time("human_operator", *self.kill_during_trial("human_operator"))

    @campaign
    def test_death_of_identification(self):
        self.assert_force_was_zero_in_time("identification", *self.kill_during_trial("identification"))

    # The recording ends with the recorder. The rig's events stand in for it: the lab received "interlock opened" and
    # "motor force zero", and writes both as marks of the trial.
    @campaign
    def test_death_of_recorder(self):
        lab, killed_ns = self.kill_during_trial("recorder")
        marks = {(mark["source"], mark["what"]): mark for mark in lab.summary()["trials"][-1]["marks"]}
        self.assertIn(("rig", "interlock opened"), marks)
        zero = marks["rig", "motor force zero after interlock opened"]
        print(f"recorder: force zero {zero['worst_us'] / 1e3:.0f} ticks after the interlock opened", flush=True)
        self.assertLessEqual(zero["worst_us"], FORCE_LIMIT_TICKS * 1000)
        # The file is cut off, and readable up to the part that the recorder had not written yet.
        recording = lab.recording(1)
        self.assertGreater(recording["rig"]["stamp_ns"][-1], killed_ns - RECORDER_LOSS_NS)
        self.assertNotEqual(recording["damage"], [])

    # The simulated rig is the motor, so nothing is left that could report its force. The test shows that the rig sent
    # nothing any more, and that nobody went on commanding it: without samples there are no motor commands.
    @campaign
    def test_death_of_rig(self):
        lab, killed_ns = self.kill_during_trial("rig")
        recording = lab.recording(1)
        self.assertEqual(recording["damage"], [])
        self.assertLess(recording["rig"]["stamp_ns"][-1], killed_ns + DETECTION_LIMIT_NS)
        self.assertLess(recording["newest_motor_command"]["stamp_ns"], killed_ns + DETECTION_LIMIT_NS)


if __name__ == "__main__":
    lab_process.main()
