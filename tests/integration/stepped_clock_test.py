# SPDX-License-Identifier: Apache-2.0
"""A session that an earlier recorder logged by a clock that somebody set: read as if nobody had, and said.

The recording of a live session (fixture lab_run) gets the log times that this recorder would have given it.
"""
import pathlib
import signal

import lab_process
from bus_case import Bus
from lab_process import BUILD, STILLHAND, next_domain
from verb_case import stillhand

RECORDING = pathlib.Path(BUILD / "tests" / "lab_run" / "session.mcap")
STEP_CLOCK = BUILD / "tests" / "step_clock"
# (after so many seconds, the clock is set by so many)
SETTINGS = {"an hour back": ((20.3, -3600),), "0.25 s back": ((20.3, -0.25),), "10 s forward": ((20.3, 10),),
            "an hour back and forward again": ((15.1, -3600), (30.2, 3600)), "twice back": ((15.1, -5), (30.2, -2))}
# The samples' stamps give a step to the difference of two ways to the recorder; so long took none here.
WAY_S = 0.1
TOPIC = "stillhand/sensed"


class SteppedClockTest(Bus):
    def stepped(self, name, steps):
        file = self.folder / f"{name}.mcap"
        done = self.start(STEP_CLOCK, RECORDING, file, *(word for step in steps for word in step))
        self.assertEqual(done.wait(), 0, done.said())
        return file

    def assert_read_straight(self, file, steps, whole):
        """Times, order and length are those of the recording before its clock was set."""
        info = self.info(file)
        self.assertEqual(len(info["clock_steps"]), len(steps))
        for found, (_, by_s) in zip(info["clock_steps"], steps):
            self.assertAlmostEqual(1e-9 * found["by_ns"], by_s, delta=WAY_S)
        self.assertLess(abs(info["duration_s"] - whole["duration_s"]), WAY_S)
        rates = {topic["topic"]: topic["rate_hz"] for topic in whole["topics"]}
        for topic in info["topics"]:
            self.assertAlmostEqual(topic["rate_hz"], rates[topic["topic"]], 0, topic["topic"])

    def assert_exported(self, file, whole_rows):
        rows = self.rows(file, TOPIC)
        self.assertEqual([row["tick [-]"] for row in rows], [row["tick [-]"] for row in whole_rows])
        times = [float(row["t [s]"]) for row in rows]
        self.assertEqual(times, sorted(times))
        worst = max(abs(t - float(row["t [s]"])) for t, row in zip(times, whole_rows))
        self.assertLess(worst, WAY_S)

    def test_the_verbs_read_it_as_if_nobody_had_set_the_clock(self):
        whole, rows = self.info(RECORDING), self.rows(RECORDING, TOPIC)
        self.assertEqual(whole["clock_steps"], [])
        for name, steps in SETTINGS.items():
            with self.subTest(name):
                file = self.stepped(name, steps)
                self.assert_read_straight(file, steps, whole)
                self.assert_exported(file, rows)
                verified = stillhand("verify", file)
                self.assertEqual(verified.returncode, 0)
                self.assertIn("the clock of its recorder was set by ", verified.stderr)
                self.assertEqual(len(verified.stderr.splitlines()), 1)
                # Without its end, as after a crash, the samples alone show it.
                cut = self.folder / "cut.mcap"
                cut.write_bytes(file.read_bytes()[:-5000])
                self.assertEqual(len(self.info(cut)["clock_steps"]), len(steps))

    def test_recover_writes_it_straight_for_other_programs(self):
        file = self.stepped("back", SETTINGS["an hour back"])
        mended = self.folder / "mended.mcap"
        self.assertEqual(stillhand("recover", file, "--out", mended).returncode, 0)
        info = self.info(mended)
        self.assertEqual(info["clock_steps"], [])
        self.assert_read_straight(mended, (), self.info(RECORDING))
        found = next(each["texts"] for each in info["metadata"] if each["name"] == "stillhand.recovery")
        self.assertIn("-3600.0", found["finding 0"])
        self.assertEqual(stillhand("recover", mended).stdout, f"{mended}: whole; nothing to recover\n")

    def test_a_replay_is_in_order_and_as_long(self):
        for name in ("an hour back", "0.25 s back", "10 s forward"):
            with self.subTest(name):
                file, again = self.stepped(name, SETTINGS[name]), self.folder / f"{name} again.mcap"
                domain = next_domain()
                recorder = self.start(STILLHAND, "record", "--out", again, "--domain", domain, "--no-real-time",
                                      "--topics", TOPIC)
                played = stillhand("replay", file, "--domain", domain, "--no-real-time", "--start", 18, "--end", 23,
                                   "--topics", TOPIC, "--wait-for", TOPIC)
                self.assertEqual(played.returncode, 0, played.stderr)
                self.assertIn("the clock of its recorder was set by ", played.stderr)
                self.assertEqual(recorder.end(signal.SIGINT), 0, recorder.said())
                ticks = [int(row["tick [-]"]) for row in self.rows(again, TOPIC)]
                self.assertEqual(ticks, sorted(ticks))
                first = [int(row["tick [-]"]) for row in self.rows(RECORDING, TOPIC)
                         if 18 <= float(row["t [s]"]) <= 23]
                self.assertLessEqual(abs(ticks[0] - first[0]), 1000 * WAY_S)
                self.assertLessEqual(abs(ticks[-1] - first[-1]), 1000 * WAY_S)


if __name__ == "__main__":
    lab_process.main(STEP_CLOCK)
