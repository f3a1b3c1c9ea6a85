# SPDX-License-Identifier: Apache-2.0
"""`stillhand record` next to a session, `stillhand replay` onto the bus.

One session is recorded twice: by its own recorder and from outside. The recording is replayed to a cancellation that
answers replays: its motor commands must be the recorded ones, bit for bit. Replayed onto the bus of another session, in
the middle of a cancelled trial, the recording must take the motor's force away and must not replace it by another.
"""
import bisect
import json
import pathlib
import signal
import subprocess
import tempfile

import lab_process
from lab_process import BUILD, SOURCE, STILLHAND, TRIAL_LIMIT_S, LabTestCase, next_domain, quick_session, wait_for

COMPARE = BUILD / "tests" / "compare_commands"
# Of the session's motor commands, at least so many are answered bit for bit.
LEAST_EQUAL_SHARE = 0.95
# A lost sample changes every answer after it. If one replay of the session loses a sample with probability p, three tries
# fail with p^3: a test that fails in less than one run of a hundred hides a p of up to 0.21.
TRIES = 3
END_LIMIT_S = 20.0


class Verb:
    """One process under test, ended by close()."""

    def __init__(self, *words, program=STILLHAND):
        self._output = tempfile.TemporaryFile("w+")
        self._errors = tempfile.TemporaryFile("w+")
        self.process = subprocess.Popen([str(program)] + [str(word) for word in words], stdin=subprocess.DEVNULL,
                                        stdout=self._output, stderr=self._errors)

    def end(self, limit_s=END_LIMIT_S):
        return self.process.wait(timeout=limit_s)

    def interrupt(self):
        self.process.send_signal(signal.SIGINT)
        return self.end()

    def output(self):
        self._output.seek(0)
        return self._output.read()

    def errors(self):
        self._errors.seek(0)
        return self._errors.read()

    def close(self):
        self.process.kill()
        self.process.wait()
        self._output.close()
        self._errors.close()


def printed_counts(output):
    """The table that `record` prints: {topic: (received, lost, not sent, written)}."""
    rows = {}
    for line in output.splitlines():
        words = line.split()
        if len(words) >= 5 and words[0].startswith("stillhand/"):
            rows[words[0]] = tuple(int(word) for word in words[1:5])
    return rows


class ReplayTest(LabTestCase):
    @classmethod
    def setUpClass(cls):
        """A session with a cancelled trial of 5 s, recorded from outside too."""
        folder = tempfile.TemporaryDirectory(prefix="stillhand-")
        cls.addClassCleanup(folder.cleanup)
        cls.shared = pathlib.Path(folder.name)
        domain = next_domain()
        cls.outside = cls.shared / "outside.mcap"
        recorder = Verb("record", "--out", cls.outside, "--domain", domain, "--require", "stillhand/sensed",
                        "--require", "stillhand/nobody_writes_this")
        cls.addClassCleanup(recorder.close)
        words = quick_session(cls.shared / "config")
        words[words.index("--trial-seconds") + 1] = 5
        lab = lab_process.LabProcess(cls.shared / "run", *words, domain=domain)
        cls.addClassCleanup(lab.close)
        cls.lab_status = lab.end_status(2 * TRIAL_LIMIT_S)
        cls.lab_errors = lab.errors()
        cls.record_status = recorder.interrupt()
        cls.record_output = recorder.output()
        cls.record_errors = recorder.errors()
        cls.session = cls.shared / "run" / "session.mcap"

    def verb(self, *words, program=STILLHAND):
        verb = Verb(*words, program=program)
        self.addCleanup(verb.close)
        return verb

    def inspected(self, path):
        told = subprocess.run([str(lab_process.INSPECT), str(path), "1"], capture_output=True, text=True, check=True)
        return json.loads(told.stdout)

    def test_the_outside_recording_is_whole_and_the_session_runs_undisturbed(self):
        self.assertEqual(self.lab_status, 0, self.lab_errors)
        told = printed_counts(self.record_output)
        found = self.inspected(self.outside)
        self.assertEqual(found["damage"], [])
        written = {topic: counts[3] for topic, counts in told.items() if counts[3] > 0}
        # inspect_recording knows the session's topics, and not the recorder's own remote control.
        own = {"stillhand/recorder_command", "stillhand/recorder_status"}
        self.assertEqual(found["messages"], {topic: count for topic, count in written.items() if topic not in own})
        self.assertGreater(written["stillhand/sensed"], 10_000)  # 5 s of each of two trials at 1 kHz
        lost = sum(counts[1] for counts in told.values())
        print("lost on the way to the outside recorder:", lost, flush=True)
        for topic, (received, _, _, in_file) in told.items():
            self.assertEqual(received, in_file, topic)
        # A topic that was required and never came is reported, and shows in the exit status.
        self.assertEqual(self.record_status, 1)
        self.assertIn("begins without stillhand/nobody_writes_this", self.record_errors)
        self.assertNotIn("begins without stillhand/sensed", self.record_errors)

    def answers_of_the_cancellation(self, attempt):
        """Replays the session to a cancellation; returns how compare_commands compares its answers."""
        domain = next_domain()
        places = ["--profiles", SOURCE / "qos" / "profiles.xml", "--config", self.shared / "config"]
        cancellation = self.verb("--domain", domain, "--answer-replay", "--real-time", *places,
                                 program=STILLHAND.parent / "stillhand-cancellation")
        answers = self.folder / f"answers{attempt}.mcap"
        recorder = self.verb("record", "--out", answers, "--domain", domain, "--topics", "stillhand/motor_command")
        replay = self.verb("replay", self.session, "--domain", domain, "--block", "stillhand/motor_command",
                           "--wait-for", "stillhand/sensed", "--wait-for", "stillhand/trial_assignment",
                           "--wait-for", "stillhand/feedthrough_model", "--wait-for", "stillhand/trial_control")
        self.assertEqual(replay.end(TRIAL_LIMIT_S), 0, replay.errors())
        recorder.interrupt()
        self.assertEqual(cancellation.interrupt(), 0, cancellation.errors())
        print(recorder.output(), replay.output(), flush=True)
        compared = subprocess.run([str(COMPARE), str(self.session), str(answers)], capture_output=True, text=True,
                                  check=True)
        return json.loads(compared.stdout)

    def test_the_cancellation_answers_a_replay_bit_for_bit(self):
        # The topic is best effort: on a loaded machine a sample may be lost, live or replayed, or a model may come later
        # than the tick that it names. The commands show both. From there on the inputs are not the same; before it, every
        # answer has to be equal in every try. A try in which that covers too little of the session is made again.
        for attempt in range(1, TRIES + 1):
            compared = self.answers_of_the_cancellation(attempt)
            apart = [compared[name] for name in ("first_gap_tick", "first_other_model_tick") if compared[name] >= 0]
            print(f"try {attempt} of {TRIES}: inputs apart from {min(apart, default='no')} tick on, {compared}", flush=True)
            if compared["different"] > 0:
                self.assertNotEqual(apart, [], "other answers to the same samples")
                self.assertGreaterEqual(compared["first_difference_tick"], min(apart))
            equal = compared["compared"] - compared["different"]
            if equal >= LEAST_EQUAL_SHARE * compared["live"]:
                break
        self.assertGreaterEqual(equal, LEAST_EQUAL_SHARE * compared["live"])
        self.assertGreater(compared["greatest_force_n"], 1.0)  # a force was asked for at all

    def table(self, file, topic):
        """Its rows, titles without units; none when no message of the topic was recorded."""
        if topic not in {entry["topic"] for entry in self.info(file)["topics"]}:
            return []
        return [{title.split(" [")[0]: cell for title, cell in row.items()} for row in self.rows(file, topic)]

    def table_so_far(self, file, topic):
        """Of a recording that is still written."""
        try:
            return self.table(file, topic)
        except AssertionError:  # no file yet, or none that can be read
            return []

    def test_behind_a_seek_the_bus_has_the_state_of_that_instant_and_no_event_from_before(self):
        control = self.table(self.session, "stillhand/trial_control")
        first = int(self.table(self.session, "stillhand/sensed")[0]["log_time"]) - int(
            1e9 * float(self.table(self.session, "stillhand/sensed")[0]["t"]))
        # Half a second after the last announcement of a trial: nothing of this topic follows soon.
        announced = [row for row in control if int(row["trial"]) >= 0][-1]
        at_s = (int(announced["log_time"]) - first) * 1e-9 + 0.5
        domain = next_domain()
        heard = self.folder / "heard.mcap"
        recorder = self.verb("record", "--out", heard, "--domain", domain, "--topics", "stillhand/trial_control",
                             "--topics", "stillhand/event", "--topics", "stillhand/sensed")
        replay = self.verb("replay", self.session, "--domain", domain, "--paused", "--topics", "stillhand/trial_control",
                           "--topics", "stillhand/event", "--topics", "stillhand/sensed", "--wait-for",
                           "stillhand/trial_control", "--wait-for", "stillhand/event", "--wait-for", "stillhand/sensed")
        for command in (f"seek {at_s:.3f}", "play"):
            subprocess.run([str(STILLHAND), "replay", "--domain", str(domain), "--remote", command], check=True)
        # A wrong state or event would be published before the first samples that follow. An event of what follows may come
        # or not.
        wait_for("half a second of samples behind the seek", lambda: len(self.table_so_far(heard, "stillhand/sensed")) > 500,
                 TRIAL_LIMIT_S, poll_s=0.2)
        subprocess.run([str(STILLHAND), "replay", "--domain", str(domain), "--remote", "stop"], check=True)
        self.assertEqual(replay.end(), 0, replay.errors())
        recorder.interrupt()
        self.assertEqual(self.table(heard, "stillhand/trial_control")[0]["stamp_ns"], announced["stamp_ns"])
        newest_before = [row for row in self.table(self.session, "stillhand/sensed")
                         if int(row["log_time"]) < int(announced["log_time"]) + 500_000_000][-1]
        self.assertGreater(int(self.table(heard, "stillhand/sensed")[0]["tick"]), int(newest_before["tick"]) - 10)
        events = {int(row["stamp_ns"]) for row in self.table(heard, "stillhand/event")}
        before = {int(row["stamp_ns"]) for row in self.table(self.session, "stillhand/event")
                  if int(row["log_time"]) < int(announced["log_time"]) + 490_000_000}
        self.assertEqual(events & before, set())

    def test_a_replay_on_a_sessions_bus_takes_the_motors_force_away(self):
        lab = self.lab(*quick_session(self.folder / "config"))
        lab.wait_for_tick(1, 1, TRIAL_LIMIT_S)
        replay = self.verb("replay", self.session, "--domain", lab.domain, "--topics", "stillhand/motor_command",
                           "--topics", "stillhand/sensed", "--loop", "--wait-for", "stillhand/motor_command")
        # The trial is marked and the session ends, as after a death; the replay goes on all the while.
        self.assertEqual(lab.end_status(TRIAL_LIMIT_S), 1)
        self.assertIsNone(replay.process.poll(), replay.errors())
        self.assertEqual(replay.interrupt(), 0, replay.errors())
        recording = lab.recording(10**6)
        rig = recording["rig"]
        start = next(entry["start_tick"] for entry in recording["trials"] if entry["number"] == 1)
        forbidden, zero = self.assert_force_ends(rig, bisect.bisect_left(rig["tick"], start))
        print(f"force zero {rig['tick'][zero] - rig['tick'][forbidden]} ticks after the interlock opened", flush=True)
        self.assertFalse(any(rig["motor_permitted"][forbidden:]))
        marks = {(mark["source"], mark["what"]) for mark in lab.summary()["trials"][-1]["marks"]}
        self.assertIn(("rig", "interlock opened"), marks)
        self.assertTrue(any("a replay is on the bus" in line for line in lab.errors()), lab.errors())
        self.assert_nothing_left(lab)


if __name__ == "__main__":
    lab_process.main(COMPARE)
