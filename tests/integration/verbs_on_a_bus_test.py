# SPDX-License-Identifier: Apache-2.0
"""`stillhand record` and `stillhand replay` on a running bus: every command, remote and from the keyboard.

What is recorded comes from publish_samples (four topics, one sample each millisecond), what is replayed from write_load
(ten topics load/0 to load/9, evenly). No session is needed.
"""
import os
import pty
import re
import signal
import subprocess
import time

import lab_process
from bus_case import LIMIT_S, Bus, wait_for
from lab_process import BUILD, STILLHAND
from verb_case import stillhand

LOAD = BUILD / "tests" / "write_load"
PUBLISH = BUILD / "tests" / "publish_samples"
ANSWER = re.compile(r"(?P<at>[\d.]+) of (?P<length>[\d.]+) s, rate (?P<rate>[\d.e+-]+)(?P<flags>[^\d]*), (?P<count>\d+)")


class Verbs(Bus):
    def verb(self, name, *words, **keywords):
        return self.start(STILLHAND, name, "--domain", self.domain, *words, **keywords)

    def remote(self, verb, command):
        return stillhand(verb, "--domain", self.domain, "--remote", command)

    def obeyed(self, verb, command):
        answer = self.remote(verb, command)
        self.assertEqual(answer.returncode, 0, answer.stderr)
        return answer.stdout

    def messages(self, file):
        return {topic["topic"]: topic["messages"] for topic in self.info(file)["topics"]}


class RefusedTest(Verbs):
    """Errors that a person can mend: one line, status 2, before anything is written or played."""

    def assert_refused(self, *words):
        before = sorted(self.folder.iterdir())
        line = self.refused(words[0], "--domain", self.domain, *words[1:])
        self.assertEqual(sorted(self.folder.iterdir()), before, words)
        return line

    def test_a_recording_that_is_refused_leaves_no_file_and_takes_none(self):
        file = self.folder / "a.mcap"
        broken = self.folder / "broken.xml"
        broken.write_text("<dds><profiles>")
        empty = self.folder / "empty.xml"
        empty.write_text('<dds xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles"><profiles/></dds>')
        for words in (("--domain", 233), ("--profiles", self.folder / "nowhere.xml"), ("--profiles", broken),
                      ("--profiles", empty), ("--trigger", "x", "--window", 1), ("--trigger", "a.b>1"),
                      ("--trigger", "stillhand/sensed.no_field>1", "--window", 1), ("--min-free-mb", 1e9)):
            self.assert_refused("record", "--out", file, *words)
        file.write_text("of somebody else")
        self.assertIn("a.mcap", self.assert_refused("record", "--out", file))
        self.assert_refused("record", "--out", file, "--domain", 233)
        self.assertEqual(file.read_text(), "of somebody else")

    def test_a_start_behind_the_end_names_the_length(self):
        self.write_load()
        # The last of 2000 messages, one each millisecond.
        self.assertIn("--start: got 2 s, want at most 1.999 s, the length of", self.assert_refused(
            "replay", self.file, "--start", 2))
        self.assertIn("--start before --end", self.assert_refused("replay", self.file, "--start", 1.5, "--end", 1))

    def test_a_topic_that_is_not_there_is_answered_by_those_that_are(self):
        self.write_load()
        topics = "one of " + ", ".join(f"load/{i}" for i in range(10))
        for words in (("--remap", "laod/3=load/4"), ("--topics", "laod/*"), ("--block", "*")):
            self.assertIn(topics, self.assert_refused("replay", self.file, *words))
        self.assertIn("--remap: got load/3, which is not played", self.assert_refused(
            "replay", self.file, "--remap", "load/3=x", "--block", "load/3"))

    def write_load(self):
        self.file = self.folder / "load.mcap"
        subprocess.run([str(LOAD), str(self.file), "1000", "2"], check=True)


class RecordTest(Verbs):
    def setUp(self):
        super().setUp()
        self.start(PUBLISH, "--domain", self.domain)

    def recorder(self, *words):
        """`record` at work: it has taken samples."""
        recorder = self.verb("record", "--topics", "stillhand/sensed", "--topics", "stillhand/raw_sample", *words)
        wait_for("samples", lambda: self.counted("received") > 100)
        return recorder

    def counted(self, what):
        answer = self.remote("record", "resume")
        found = re.search(rf"(\d+) {what}", answer.stdout)
        return int(found[1]) if found else 0

    def test_a_pause_leaves_a_hole_and_the_stop_is_acknowledged(self):
        file = self.folder / "a.mcap"
        recorder = self.recorder("--out", file)
        paused = self.obeyed("record", "pause")
        paused_s = time.monotonic()
        wait_for("a hole of a second", lambda: time.monotonic() > paused_s + 1.0)
        resumed = self.obeyed("record", "resume")
        stopped = self.obeyed("record", "stop")
        self.assertIn("stop", stopped)
        self.assertIn("pause", paused)
        self.assertIn("resume", resumed)
        recorder.wait(timeout=LIMIT_S)
        self.assertIn("messages passed over: paused", recorder.said())
        ticks = [int(row["tick [-]"]) for row in self.rows(file, "stillhand/sensed")]
        steps = [later - earlier for earlier, later in zip(ticks, ticks[1:])]
        # The commands themselves take a while; the hole is at least what lay between the answers.
        self.assertGreaterEqual(max(steps), 1000)

    def test_a_pattern_that_no_topic_has_is_answered_by_those_that_are_there(self):
        recorder = self.verb("record", "--topics", "stilhand/*", "--out", self.folder / "a.mcap")
        wait_for("the topics of the bus", lambda: "stillhand/sensed" in recorder.said())
        self.assertIn("no topic", recorder.said())
        # What is found after the first warning is named too.
        load = self.folder / "load.mcap"
        subprocess.run([str(LOAD), str(load), "100", "60"], check=True)
        self.verb("replay", load)
        wait_for("a later topic", lambda: "load/0" in recorder.said())

    def test_a_request_without_a_recorder_is_answered_by_an_error(self):
        answer = self.remote("record", "pause")
        self.assertEqual(answer.returncode, 1)
        self.assertIn(f"no recorder answers on domain {self.domain}", answer.stderr)
        self.assertEqual(self.remote("record", "dance").returncode, 2)

    def test_a_trigger_without_a_window_is_refused(self):
        self.recorder("--out", self.folder / "a.mcap")
        answer = self.remote("record", "trigger")
        self.assertEqual(answer.returncode, 1)
        self.assertIn("no event window", answer.stderr)

    def test_a_command_writes_the_last_seconds(self):
        file = self.folder / "a.mcap"
        recorder = self.recorder("--out", file, "--window", 2)
        wait_for("a full window", lambda: self.counted("received") > 2 * 4000)
        self.obeyed("record", "trigger")
        recorder.end(signal.SIGINT)
        info = self.info(file)
        cause = [entry["texts"]["cause"] for entry in info["metadata"] if entry["name"] == "stillhand.trigger"]
        self.assertEqual(cause, ["a command"])
        # The window, give or take a batch of the writing thread (20 ms), and what the machine holds up.
        self.assertGreater(info["duration_s"], 1.9)
        self.assertLess(info["duration_s"], 2.5)

    def test_a_threshold_on_a_field_writes_the_window_once(self):
        file = self.folder / "a.mcap"
        # Ticks rise for ever: the threshold is crossed once, between two samples of the window.
        recorder = self.verb("record", "--topics", "stillhand/sensed", "--out", file, "--window", 2, "--trigger",
                             "stillhand/sensed.tick>4000")
        wait_for("the window in the file", lambda: file.exists() and "stillhand/sensed" in self.messages(file))
        recorder.end(signal.SIGINT)
        info = self.info(file)
        causes = [entry["texts"]["cause"] for entry in info["metadata"] if entry["name"] == "stillhand.trigger"]
        self.assertEqual(causes, ["stillhand/sensed.tick>4000"])
        ticks = [int(row["tick [-]"]) for row in self.rows(file, "stillhand/sensed")]
        # The sample that crosses it is in the window; a batch later the window is written.
        self.assertLessEqual(ticks[0], 4000)
        self.assertGreater(ticks[-1], 4000)

    def assert_parts(self, *words):
        recorder = self.recorder("--out", self.folder / "a.mcap", *words)
        wait_for("a third part", (self.folder / "a.0003.mcap").exists)
        recorder.end(signal.SIGINT)
        parts = sorted(self.folder.glob("a*.mcap"), key=lambda path: (path.name != "a.mcap", path.name))
        ticks = []
        for part in parts:
            self.assertEqual(stillhand("verify", part).returncode, 0, part)
            ticks += [int(row["tick [-]"]) for row in self.rows(part, "stillhand/sensed")]
        # Nothing falls between two files: each tick is there once, but for what the bus lost.
        self.assertEqual(ticks, sorted(set(ticks)))
        counts = [int(word) for line in recorder.said().splitlines() if line.startswith("stillhand/sensed")
                for word in line.split()[1:5]]
        self.assertEqual(len(ticks), counts[3])
        self.assertEqual(ticks[-1] - ticks[0] + 1 - len(ticks), counts[1])
        return [self.info(part) for part in parts]

    def test_files_by_time_follow_one_another_without_a_gap(self):
        for info in self.assert_parts("--rotate-s", 1)[:-1]:
            self.assertLessEqual(info["duration_s"], 1.0)
            self.assertGreater(info["duration_s"], 0.9)

    def test_files_by_size_follow_one_another_without_a_gap(self):
        for info in self.assert_parts("--rotate-mb", 0.2, "--compression", "none", "--flush-ms", 20)[:-1]:
            self.assertGreater(info["bytes"], 200_000)
            # A chunk of 20 ms, its index, and the index of all chunks come on top.
            self.assertLess(info["bytes"], 300_000)


class ReplayTest(Verbs):
    LENGTH_S = 20
    RATE = 1000  # of ten topics together

    def setUp(self):
        super().setUp()
        self.file = self.folder / "load.mcap"
        subprocess.run([str(LOAD), str(self.file), str(self.RATE), str(self.LENGTH_S)], check=True)

    def replay(self, *words, **keywords):
        replay = self.verb("replay", self.file, *words, **keywords)
        wait_for("an answer", lambda: self.remote("replay", "loop-off").returncode == 0)
        return replay

    def answer(self, command):
        return ANSWER.search(self.obeyed("replay", command))

    def test_each_command_is_obeyed_and_answered(self):
        replay = self.replay("--paused")
        self.assertIn("paused", self.answer("pause")["flags"])
        at_start = self.answer("seek 5")
        self.assertEqual((at_start["at"], at_start["count"]), ("5.000", "0"))
        step = self.answer("step")
        self.assertEqual(step["count"], "1")
        self.assertGreaterEqual(float(step["at"]), 5.0)
        self.assertEqual(self.answer("rate 10")["rate"], "10")
        self.assertNotIn("paused", self.answer("play")["flags"])
        self.assertIn("looping", self.answer("loop 2 3")["flags"])
        positions = [float(self.answer("play")["at"]) for _ in range(5)]
        self.assertTrue(all(2.0 <= at <= 3.1 for at in positions), positions)
        self.assertNotIn("looping", self.answer("loop-off")["flags"])
        self.obeyed("replay", "pause")  # or it is over before the last command
        for refused in ("seek 1000", "loop 3 2", "rate 1000"):
            answer = self.remote("replay", refused)
            self.assertEqual(answer.returncode, 1, refused)
            self.assertIn(refused, answer.stderr)
        self.obeyed("replay", "stop")
        self.assertEqual(replay.wait(timeout=LIMIT_S), 0, replay.said())
        self.assertEqual(self.remote("replay", "play").returncode, 1)

    def test_a_loop_plays_its_stretch_again_and_again(self):
        heard = self.folder / "heard.mcap"
        recorder = self.verb("record", "--out", heard, "--topics", "load/0")
        replay = self.replay("--paused", "--topics", "load/0", "--wait-for", "load/0")
        self.obeyed("replay", "loop 4 5")
        self.obeyed("replay", "play")
        # 100 messages a second of this topic: a second time round after 200.
        wait_for("three rounds", lambda: int(self.answer("play")["count"]) > 300)
        self.obeyed("replay", "stop")
        replay.wait(timeout=LIMIT_S)
        recorder.end(signal.SIGINT)
        ticks = [int(row["tick [-]"]) for row in self.rows(heard, "load/0")]
        # Tick n is n/100 s behind the start: the stretch holds 400 to 500, both ends included.
        self.assertEqual((min(ticks), max(ticks)), (400, 500))
        self.assertGreaterEqual(ticks.count(450), 2)

    def test_a_subset_goes_out_under_another_name(self):
        heard = self.folder / "heard.mcap"
        recorder = self.verb("record", "--out", heard, "--topics", "load/*", "--topics", "other/*")
        replay = self.verb("replay", self.file, "--topics", "load/3", "--topics", "load/4",
                           "--block", "load/4", "--remap", "load/3=other/three", "--rate", 10, "--wait-for",
                           "other/three")
        self.assertEqual(replay.wait(timeout=LIMIT_S), 0, replay.said())
        recorder.end(signal.SIGINT)
        self.assertEqual(self.messages(heard), {"other/three": self.RATE * self.LENGTH_S // 10})
        ticks = [int(row["tick [-]"]) for row in self.rows(heard, "other/three")]
        self.assertEqual(ticks, list(range(len(ticks))))

    def test_readers_that_are_there_hear_the_first_message_and_nobody_is_said(self):
        words = (self.file, "--topics", "load/3", "--rate", 100)
        alone = self.verb("replay", *words)
        self.assertEqual(alone.wait(timeout=LIMIT_S), 0, alone.said())
        count = self.RATE * self.LENGTH_S // 10
        self.assertIn(f"no program received {count} of them", alone.said())
        heard = self.folder / "heard.mcap"
        recorder = self.verb("record", "--out", heard, "--topics", "load/*")
        wait_for("the recorder", lambda: self.remote("record", "resume").returncode == 0)
        replay = self.verb("replay", *words)
        self.assertEqual(replay.wait(timeout=LIMIT_S), 0, replay.said())
        recorder.end(signal.SIGINT)
        self.assertEqual(self.messages(heard), {"load/3": count})
        self.assertNotIn("no reader", replay.said())

    def test_the_loss_of_a_recording_is_reported_in_one_line(self):
        whole = self.file.read_bytes()
        middle = len(whole) // 2
        blank = 64 * 1024  # more than the message indexes between two chunks
        holed = whole[:middle] + bytes(blank) + whole[middle + blank:]
        # Lost are a part of the index at the end; half of all; a chunk or two.
        for content, status, words in ((whole[:-1000], 0, "nothing in it is lost"),
                                       (whole[:middle], 1, "cut off, as after a crash"),
                                       (holed, 1, "damaged in ")):
            with self.subTest(words):
                self.file.write_bytes(content)
                replay = stillhand("replay", self.file, "--domain", self.domain, "--topics", "load/0", "--rate", 100)
                self.assertEqual(replay.returncode, status, replay.stderr)
                self.assertEqual(len(replay.stderr.splitlines()), 1, replay.stderr)
                self.assertIn(words, replay.stderr)

    def test_keys_of_a_terminal_control_it(self):
        # The status that the replay publishes ten times a second, as a recording that grows.
        statuses = self.folder / "statuses.mcap"
        self.verb("record", "--out", statuses, "--topics", "stillhand/replay_status", "--flush-ms", 20)
        ours, theirs = pty.openpty()
        self.addCleanup(os.close, ours)
        replay = self.verb("replay", self.file, "--paused", stdin=theirs)
        os.close(theirs)

        def state():
            if "stillhand/replay_status" not in self.messages(statuses):
                return None
            newest = {title.split(" [")[0]: cell
                      for title, cell in self.rows(statuses, "stillhand/replay_status")[-1].items()}
            return {name: float(newest[name]) for name in ("paused", "position_s", "rate", "looping", "released")}

        def after(key, condition):
            os.write(ours, key)
            wait_for(f"effect of {key}", lambda: condition(state()))
        wait_for("its status", lambda: statuses.exists() and state())
        after(b"s", lambda now: now["released"] == 1)
        after(b"+", lambda now: now["rate"] > 1)
        after(b"-", lambda now: now["rate"] == 1)
        after(b"\x1b[C", lambda now: 5.0 <= now["position_s"] < 5.1)
        after(b"\x1b[D", lambda now: now["position_s"] < 0.1)
        os.write(ours, b"a")
        after(b"\x1b[C", lambda now: now["position_s"] >= 5.0)
        after(b"b", lambda now: now["looping"] and now["position_s"] < 0.1)
        after(b"c", lambda now: not now["looping"])
        after(b" ", lambda now: not now["paused"] and now["position_s"] > 0.1)
        os.write(ours, b"q")
        self.assertEqual(replay.wait(timeout=LIMIT_S), 0, replay.said())


if __name__ == "__main__":
    lab_process.main(LOAD, PUBLISH)
