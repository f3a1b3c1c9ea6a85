# SPDX-License-Identifier: Apache-2.0
"""`stillhand lab --rig devices` with an emulated ODrive on the stick, acceleration and force from IIO devices.

The rig process stops while the motor pushes in condition C, so that the drive's own watchdog has to end the torque.
"""
import devices_test
import lab_process
from iio_context import IioContext, missing


class OdriveCase(devices_test.DevicesCase):
    def setUp(self):
        super().setUp()
        self.context = IioContext(self.folder / "iio")
        self.addCleanup(self.context.close)

    def pushing(self):
        return self.pushing_session(iio=self.context, odrive=True)


class OdriveTest(OdriveCase):
    def test_a_rig_process_that_stops_leaves_no_torque(self):
        lab, laboratory = self.pushing()
        took_ms = devices_test.marked_and_stopped(laboratory, lab.pid_of("device_rig"))
        seen = self.assert_torque_ended(laboratory, devices_test.DRIVE_LIMIT_MS + took_ms,
                                        "SIGSTOP of the rig's process")
        self.assertEqual(seen["timeouts"], 1)
        self.assertEqual(lab.end_status(), 1, lab.errors())
        self.assert_nothing_left(lab)


if __name__ == "__main__":
    if why := missing():
        lab_process.skip(why)
    lab_process.main(devices_test.PROGRAM)
