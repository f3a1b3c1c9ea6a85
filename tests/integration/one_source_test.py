# SPDX-License-Identifier: Apache-2.0
"""A program of no session next to a trial that cancels: it moves nothing, and nobody believes it.

It commands 25 N, a thousand times a second: the rig takes motor commands from the session's canceller alone. The
second writer opens the interlock, and an event with its name is recorded. Or it reports in the rig's name that the
trial is over and the interlock open: the lab takes a process's word from its participant alone.
"""
import lab_process
from lab_process import STRANGER, TICKS_PER_S, TRIAL_LIMIT_S, LabTestCase, campaign, quick_session

PUSHED_N = 25.0           # the stranger's command, and the limit of the motor
# The canceller's own force in this session: 8.7 N at most in a run without a stranger. 20 N leaves twice that.
OWN_FORCE_LIMIT_N = 20.0


class OneSourceTest(LabTestCase):
    def push_during_trial(self, name):
        """A stranger of this name next to the second second of the trial; returns the ended lab and its recording."""
        lab = self.lab(*quick_session(self.folder / "config"))
        lab.wait_for_tick(1, 1, TRIAL_LIMIT_S)
        stranger = self.stranger(lab.domain, "pushes", name)
        self.assertEqual(lab.end_status(TRIAL_LIMIT_S), 1, lab.errors())
        _, readers = self.heard(stranger)
        self.assert_nothing_left(lab)
        # Rig and recorder did match it: the rig had its commands, and did not use them.
        self.assertGreaterEqual(readers, 2)
        recording = lab.recording(10**9)
        written = {topic["topic"]: topic["messages"] for topic in self.info(lab.out / "session.mcap")["topics"]}
        self.assertGreater(written["stillhand/motor_command"], len(recording["rig"]["tick"]),
                           "the recording holds what the stranger wrote, too")
        return lab, recording

    def test_a_program_that_commands_the_motor_moves_nothing_and_is_named(self):
        lab, recording = self.push_during_trial("a stranger")
        rig = recording["rig"]
        self.assert_force_ends(rig, max(i for i, permitted in enumerate(rig["motor_permitted"]) if permitted) + 1)
        self.assertLess(max(abs(f) for f in rig["motor_force_n"]), OWN_FORCE_LIMIT_N)
        named = "a second writer of stillhand/motor_command: a stranger"
        self.assertTrue(any(source == "rig" and text.startswith(named) for source, text in recording["commands"]),
                        recording["commands"])
        self.assertIn(["stillhand/motor_command", "a stranger"], recording["second_writers"])
        self.assertIn(named, lab.errors()[-1])
        trial = lab.summary()["trials"][-1]
        self.assertIn(named, trial["aborted"])

    @campaign
    def test_a_program_that_reports_in_the_rigs_name_ends_no_trial(self):
        lab = self.lab(*quick_session(self.folder / "config"), "--trial-seconds", 10)
        lab.wait_for_tick(1, 1, TRIAL_LIMIT_S)
        stranger = self.stranger(lab.domain, "forges", "a stranger")
        self.assertEqual(lab.end_status(TRIAL_LIMIT_S), 0, lab.errors())
        _, readers = self.heard(stranger)
        trial = lab.summary()["trials"][-1]
        self.assertTrue(trial["completed"], trial)
        self.assertGreaterEqual(lab.recording(1)["rig"]["tick"][-1], trial["start_tick"] + 10 * TICKS_PER_S,
                                "the trial ended before its time")
        # The five readers of the status matched it, the lab among them, and the two of the event.
        self.assertGreaterEqual(readers, 7)
        self.assertIn(("second writer", "stillhand/service_status", "a stranger"),
                      [(mark["what"], mark["topic"], mark["peer"]) for mark in trial["marks"]])


if __name__ == "__main__":
    lab_process.main(STRANGER)
