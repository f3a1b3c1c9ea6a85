# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C, other signals and kill -9 at several moments of a session: it ends soon, leaves no process and no file but a
recording that can be read."""
import os
import pathlib
import resource
import signal
import subprocess
import time

import lab_process
from lab_process import STILLHAND, TRIAL_LIMIT_S, LabTestCase, quick_session, running

# It ends by itself: 0.4 s before the trials, 2.3 s in one, on two busy cores (2026-11). Next to tests and compilers, at
# a load of 5 to 10, it once took over 10 s.
INTERRUPT_LIMIT_S = 60.0


class InterruptTest(LabTestCase):
    def start(self):
        return self.lab(*quick_session(self.folder / "config"))

    def assert_interrupted(self, lab, interrupt=None):
        begun = time.monotonic()
        (interrupt or lab.interrupt)()
        self.assertEqual(lab.end_status(INTERRUPT_LIMIT_S), 1)
        print(f"ended after {time.monotonic() - begun:.1f} s", flush=True)
        self.assert_nothing_left(lab)

    def assert_recording_holds(self, lab, trial):
        recording = lab.recording(1)
        self.assertEqual(recording["damage"], [])
        self.assertEqual(recording["trials"][-1]["number"], trial)
        self.assertGreater(recording["messages"]["stillhand/rig_truth"], 1000)

    def assert_marked(self, lab, trial):
        marked = lab.summary()["trials"][trial]
        self.assertFalse(marked["completed"])
        self.assertEqual(marked["aborted"], "interrupted")
        self.assertTrue(lab.summary()["interrupted"])

    def interrupted_before_the_first_trial(self):
        lab = self.start()
        lab.wait_for("the first service", lambda: len(running(lab.domain)) > 1, 10.0)
        self.assert_interrupted(lab)
        self.assertEqual(lab.errors(), ["stillhand lab: interrupted before the first trial"])
        return lab

    def test_interrupt_before_the_services_have_matched_leaves_no_results(self):
        lab = self.interrupted_before_the_first_trial()
        self.assertFalse(lab.out.exists())

    def test_termination_during_identification_leaves_a_readable_recording(self):
        # Recorded as the lab's command line says.
        lab = self.lab(*quick_session(self.folder / "config"), "--compression", "lz4", "--flush-ms", 50, "--fsync")
        lab.wait_for_tick(0, 1, TRIAL_LIMIT_S)
        recorder = pathlib.Path(f"/proc/{lab.pid_of('recorder')}/cmdline").read_text().split("\0")
        self.assertEqual(recorder[recorder.index("--flush-ms") + 1], "50")
        self.assertIn("--fsync", recorder)
        # An orderly shutdown of the machine terminates; a terminal that closes makes the same request (unit.runtime).
        self.assert_interrupted(lab, lambda: os.kill(lab.process.pid, signal.SIGTERM))
        self.assert_recording_holds(lab, 0)
        self.assertIn("chunks (lz4)", subprocess.run([str(STILLHAND), "info", str(lab.out / "session.mcap")],
                                                     capture_output=True, text=True, check=True).stdout)
        self.assert_marked(lab, 0)
        self.assertEqual({path.name for path in lab.out.iterdir()}, {"session.mcap", "summary.json", "logs"})

    def test_interrupt_during_a_trial_leaves_a_readable_recording_and_the_model(self):
        lab = self.start()
        lab.wait_for_tick(1, 1, TRIAL_LIMIT_S)
        self.assert_interrupted(lab)
        self.assert_recording_holds(lab, 1)
        self.assert_marked(lab, 1)
        self.assertEqual(lab.summary()["conditions"], {})
        self.assertEqual({path.name for path in lab.out.iterdir()},
                         {"session.mcap", "summary.json", "model.json", "logs"})

    # A limit on the size of files stands in for a full disk: the recorder writes 0.4 MB a second.
    def test_recording_that_cannot_be_written_ends_the_trial(self):
        def limit_files():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # an error of write() instead
            resource.setrlimit(resource.RLIMIT_FSIZE, (2_000_000, 2_000_000))
        lab = self.lab(*quick_session(self.folder / "config"), before_start=limit_files)
        self.assertEqual(lab.end_status(TRIAL_LIMIT_S), 1)
        self.assert_nothing_left(lab)
        trial = lab.summary()["trials"][-1]
        self.assertFalse(trial["completed"])
        for words in ("recorder", "session.mcap", "File too large"):
            self.assertIn(words, trial["aborted"])
        self.assertGreater(lab.recording(1)["messages"]["stillhand/rig_truth"], 1000)

    def test_services_of_a_killed_lab_end_by_themselves(self):
        lab = self.start()
        lab.wait_for_tick(0, 1, TRIAL_LIMIT_S)
        os.kill(lab.process.pid, signal.SIGKILL)
        self.assertEqual(lab.end_status(), -signal.SIGKILL)
        self.assert_nothing_left(lab)
        self.assert_recording_holds(lab, 0)
        # No process was left to write results: there are none, rather than half of them.
        self.assertEqual({path.name for path in lab.out.iterdir()}, {"session.mcap", "logs"})

    def test_lab_that_never_began_a_trial_leaves_the_earlier_session(self):
        out = self.folder / "run"
        (out / "logs").mkdir(parents=True)
        names = {"session.mcap", "summary.json", "model.json"}
        for name in names:
            (out / name).write_text("of an earlier run")
        self.interrupted_before_the_first_trial()
        self.assertEqual({path.name for path in out.iterdir()} - {"logs"}, names)
        self.assertEqual((out / "session.mcap").read_text(), "of an earlier run")


if __name__ == "__main__":
    lab_process.main()
