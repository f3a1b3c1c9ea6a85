# SPDX-License-Identifier: Apache-2.0
"""`stillhand lab --rig devices` with an emulated ODrive on the stick, acceleration and force from IIO devices.

By default: a session of conditions A, B and C whose rig process stops while the motor pushes in C, so that the drive's
own watchdog has to end the torque. `--campaign`: a whole session next to the simulated rig.
"""
import devices_test
import lab_process
from iio_context import IioContext, missing
from lab_process import TRIAL_LIMIT_S, campaign, next_domain, quick_session

IN_C = 3  # the third trial


class OdriveTest(devices_test.DevicesCase):
    def setUp(self):
        super().setUp()
        self.context = IioContext(self.folder / "iio")
        self.addCleanup(self.context.close)

    def test_a_session_runs_until_the_rig_process_stops_which_leaves_no_torque(self):
        domain = next_domain()
        arguments = [*quick_session(self.folder / "config"), "--conditions", "A,B,C", "--trial-seconds", 5]
        laboratory = self.laboratory(domain=domain, iio=self.context, odrive=True)
        lab = self.lab("--rig", "devices", *arguments, domain=domain)
        lab.wait_for_tick(IN_C, 1, TRIAL_LIMIT_S)
        self.assertEqual(laboratory.report()["timeouts"], 0)
        self.wait_for_push(lab, laboratory)
        took_ms = devices_test.marked_and_stopped(laboratory, lab.pid_of("device_rig"))
        seen = self.assert_torque_ended(laboratory, devices_test.DRIVE_LIMIT_MS + took_ms,
                                        "SIGSTOP of the rig's process")
        self.assertEqual(seen["timeouts"], 1)
        self.assertEqual(lab.end_status(), 1, lab.errors())
        self.assert_nothing_left(lab)
        summary = lab.summary()
        self.assertEqual([trial["aborted"] is None for trial in summary["trials"]], [True] * IN_C + [False])
        parts = {"acceleration": "iio", "force": "iio", "angle": "drive", "motor": "drive", "platform": "plain_udp"}
        self.assertEqual(summary["rig"], {"kind": "devices", "parts": parts})

    @campaign
    def test_a_session_is_like_one_of_the_simulated_rig(self):
        self.assert_like_the_simulated_rig(iio=self.context, odrive=True)


if __name__ == "__main__":
    if why := missing():
        lab_process.skip(why)
    lab_process.main(devices_test.PROGRAM)
