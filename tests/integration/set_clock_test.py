# SPDX-License-Identifier: Apache-2.0
"""Somebody sets the clock of the recorder's machine while it records: order, length and export stay right.

The recorder alone runs with a clock (skewed_clock) that jumps; publish_samples sends a sample each millisecond.
"""
import os
import re
import subprocess
import time

import lab_process
from lab_process import BUILD, next_domain
from verb_case import FolderCase

STEPS_S = (-3600.0, -0.25, 10.0)
TOPIC = "stillhand/sensed"


class SetClockTest(FolderCase):
    def setUp(self):
        super().setUp()
        self.domain = next_domain()
        publisher = subprocess.Popen([BUILD / "tests" / "publish_samples", "--domain", str(self.domain)],
                                     stdout=subprocess.DEVNULL)
        self.addCleanup(publisher.wait)
        self.addCleanup(publisher.kill)

    def recorded_over(self, step_s):
        """A recording of 4 s, in whose middle the system clock jumps."""
        file = self.folder / f"{step_s}.mcap"
        at_ns = time.clock_gettime_ns(time.CLOCK_MONOTONIC) + 2_500_000_000
        self.run_verb("record", "--domain", self.domain, "--out", file, "--topics", TOPIC, "--duration", 4,
                      env={**os.environ, "LD_PRELOAD": str(BUILD / "tests" / "libskewed_clock.so"),
                           "SKEW_SYSTEM_STEP_MS": str(1000.0 * step_s), "SKEW_STEP_AT_NS": str(at_ns)})
        return file

    def test_the_recording_is_in_order_and_as_long_as_it_was(self):
        for step_s in STEPS_S:
            with self.subTest(step_s):
                file = self.recorded_over(step_s)
                said = self.run_verb("info", file).stdout
                offset_ns = {when: int(ns) for when, ns in re.findall(r"clock_offset_ns at (start|end): (\d+)", said)}
                # The clock did jump.
                self.assertAlmostEqual(1e-9 * (offset_ns["end"] - offset_ns["start"]), step_s, 1)
                rows = self.rows(file, TOPIC)
                ticks = [int(row["tick [-]"]) for row in rows]
                times = [float(row["t [s]"]) for row in rows]
                self.assertGreater(len(rows), 100)
                self.assertEqual(ticks, sorted(ticks))
                self.assertEqual(times, sorted(times))
                # A tick each millisecond by the sender's monotonic clock.
                self.assertAlmostEqual((times[-1] - times[0]) / (0.001 * (ticks[-1] - ticks[0])), 1.0, 1)


if __name__ == "__main__":
    lab_process.main(BUILD / "tests" / "publish_samples")
