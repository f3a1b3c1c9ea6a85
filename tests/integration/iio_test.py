# SPDX-License-Identifier: Apache-2.0
"""An accelerometer and a load cell behind Debian's iiod: the driver next to iio_readdev, and in a session.

iiod runs in a mount namespace of its own, in which a folder stands for the kernel's IIO devices (iio_context.py).
"""
import os
import struct
import subprocess
import threading

import devices_test
import lab_process
from iio_context import IioContext, missing
from lab_process import BUILD, LabTestCase, hold

SAMPLES = BUILD / "tests" / "iio_samples"
READDEV = "/usr/bin/iio_readdev"
COUNT = 300
LIMIT_S = 30
SHIFT = 12
# Both signs, both ends of 20 bit, and numbers that only the right shift and sign give back.
NUMBERS = [0, 1, -1, 524287, -524288, 12345, -54321] + [((i * 7919) % 1048576) - 524288 for i in range(COUNT - 7)]


class DriverTest(LabTestCase):
    def setUp(self):
        super().setUp()
        self.context = IioContext(self.folder / "iio")
        self.addCleanup(self.context.close)

    def feed(self, numbers=NUMBERS):
        """Writes the numbers, one each millisecond, as soon as somebody reads."""
        def write():
            with open(self.context.fifos["accelerometer"], "wb", buffering=0) as fifo:
                for number in numbers:
                    fifo.write(struct.pack("<I", (number << SHIFT) & 0xffffffff))
                    hold(0.001, poll_s=0.001)
        thread = threading.Thread(target=write, daemon=True)
        thread.start()
        return thread

    def answer(self, *words):
        feeder = self.feed()
        done = subprocess.run([str(word) for word in words], capture_output=True, timeout=LIMIT_S, check=True)
        feeder.join(LIMIT_S)
        return done.stdout

    def test_the_driver_and_iio_readdev_read_the_same_samples(self):
        read = self.answer(READDEV, "-u", self.context.uri, "-b", 1, "-s", COUNT, "accelerometer", "accel_y")
        theirs = [word >> SHIFT for word in struct.unpack(f"<{COUNT}i", read)]
        first, *lines = self.answer(SAMPLES, self.context.uri, "accelerometer", "accel_y", COUNT).decode().split("\n")[:-1]
        self.assertEqual(first, "3.9e-05 1000")
        self.assertEqual(theirs, NUMBERS)
        self.assertEqual([int(line) for line in lines], NUMBERS)

    def test_three_axes_of_one_device_are_sampled_together(self):
        samples = [[number, -number, number + 1] for number in range(1, COUNT + 1)]
        words = [number for sample in samples for number in sample]

        def write():
            with open(self.context.fifos["three_axes"], "wb", buffering=0) as fifo:
                for sample in samples:
                    fifo.write(struct.pack("<3I", *((number << SHIFT) & 0xffffffff for number in sample)))
                    hold(0.001, poll_s=0.001)
        feeder = threading.Thread(target=write, daemon=True)
        feeder.start()
        names = ["accel_x", "accel_y", "accel_z"]
        done = subprocess.run([str(SAMPLES), self.context.uri, "three_axes", ",".join(names), str(COUNT)],
                              capture_output=True, text=True, timeout=LIMIT_S, check=True)
        feeder.join(LIMIT_S)
        self.assertEqual([int(word) for line in done.stdout.splitlines()[1:] for word in line.split()], words)

    def test_a_device_of_4_khz_is_read_in_blocks_of_a_tick(self):
        (self.context.folder / "bus/iio/devices/iio:device0/sampling_frequency").write_text("4000\n")
        lines = self.answer(SAMPLES, self.context.uri, "accelerometer", "accel_y", COUNT // 4).decode().split("\n")
        self.assertEqual([int(line) for line in lines[1:-1]], NUMBERS[3::4])

    # A buffer of the kernel is emptied when it is opened again; a FIFO, once nobody has it open.
    def test_what_waits_is_thrown_away(self):
        before, waiting, new = NUMBERS[:10], [100000] * 2000, NUMBERS[10:20]

        def write(numbers):
            with open(self.context.fifos["accelerometer"], "wb", buffering=0) as fifo:
                fifo.write(b"".join(struct.pack("<I", (number << SHIFT) & 0xffffffff) for number in numbers))
        feeder = threading.Thread(target=write, args=(before + waiting,), daemon=True)
        feeder.start()
        words = [str(SAMPLES), self.context.uri, "accelerometer", "accel_y", str(len(before + new)), str(len(before))]
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as driver:
            self.addCleanup(driver.kill)
            lines = [driver.stdout.readline() for _ in range(len(before) + 2)]
            self.assertEqual([int(line) for line in lines[1:-1]], before)
            self.assertEqual(lines[-1], "skipped\n")
            write(new)
            self.assertEqual([int(driver.stdout.readline()) for _ in new], new)

    def test_a_context_that_comes_back_is_opened_again(self):
        words = [str(SAMPLES), self.context.uri, "accelerometer", "accel_y", str(COUNT)]
        with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as driver:
            self.addCleanup(driver.kill)
            driver.stdout.readline()
            for part in (NUMBERS[:100], NUMBERS[100:]):
                feeder = self.feed(part)
                self.assertEqual([int(driver.stdout.readline()) for _ in part], part)
                feeder.join(LIMIT_S)
                self.context.end()
                self.context.begin()
            self.assertEqual(driver.wait(LIMIT_S), 0, driver.returncode)

    def test_what_is_not_there_is_named_with_what_is(self):
        def refusal(*words):
            done = subprocess.run([str(SAMPLES), *words, "1"], capture_output=True, text=True, timeout=LIMIT_S, check=False)
            self.assertEqual(done.returncode, 2)
            return done.stderr.strip()
        self.assertIn("got gyro, want one of accelerometer, bridge, three_axes", refusal(self.context.uri, "gyro", "accel_y"))
        self.assertIn("got accel_x, want one of accel_y", refusal(self.context.uri, "accelerometer", "accel_x"))
        self.assertIn("iio_info -u ip:127.0.0.1:1", refusal("ip:127.0.0.1:1", "accelerometer", "accel_y"))


class SessionTest(devices_test.DevicesCase):
    """The drive moves the stick; acceleration and force come from IIO devices."""

    def test_iiod_that_dies_ends_the_torque_and_is_named(self):
        context = IioContext(self.folder / "iio")
        self.addCleanup(context.close)
        lab, laboratory = self.pushing_session(iio=context)
        laboratory.order("mark")
        context.end()
        self.assert_torque_ended(laboratory, devices_test.HOST_LIMIT_MS, "death of iiod")
        self.assertEqual(lab.end_status(), 1, lab.errors())
        summary = lab.summary()
        self.assertEqual(summary["rig"]["parts"]["acceleration"], "iio")
        self.assertRegex(summary["trials"][-1]["aborted"], "the (load cell|accelerometer) is silent, or at its end")
        self.assert_nothing_left(lab)


if __name__ == "__main__":
    if why := missing() or ("" if os.path.isfile(READDEV) else f"no {READDEV}"):
        lab_process.skip(why)
    lab_process.main()
