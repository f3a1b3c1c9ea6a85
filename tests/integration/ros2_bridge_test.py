# SPDX-License-Identifier: Apache-2.0
"""`stillhand ros2-bridge`: what another DDS with the types of ROS 2 receives, and that the bridge only listens.

A stretch of a recorded session (fixture lab_run) is played; foreign/ros2_reader.c reads with Cyclone DDS. A stretch is
so short that the buffer of a socket holds all of it: no reader misses a message because the machine is busy.
"""
import json
import os
import pathlib
import re
import signal

import lab_process
from bus_case import CYCLONE_URI, Bus, wait_for
from lab_process import BUILD, STILLHAND, next_domain

READER = BUILD / "tests" / "ros2_reader"
RECORDING = pathlib.Path(os.environ.get("STILLHAND_RECORDING", BUILD / "tests" / "lab_run" / "session.mcap"))
LONG = (80.0, 82.0)  # [s] of the recording
READ = 8  # topics
# What every ROS 2 from Iron on has for sensor_msgs/msg/Imu.
HASH_OF_IMU = "RIHS01_7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b"
# Topic of ROS 2: topic of the session, what the message holds of a row there. REP 103: y is left, and right here.
EXPECTED = {
    "/rig_1/hand/wrench": ("sensed", lambda r: ("stick", [0, -r["force_n"], 0, 0, 0, 0], [])),
    "/rig_1/stick/joint_states": ("sensed", lambda r: ("", [r["theta_rad"], r["omega_rad_s"]], ["stick"])),
    "/rig_1/motor/wrench": ("motor_command", lambda r: ("stick", [0, -r["force_n"], 0, 0, 0, 0], [])),
    "/rig_1/platform/joint_states": ("platform_command",
                                     lambda r: ("", [-r["position_m"], -r["velocity_m_s"]], ["platform"])),
    "/rig_1/target": ("tracking_sample", lambda r: ("screen", [0, -r["target_m"], 0], [])),
    "/rig_1/cursor": ("tracking_sample", lambda r: ("screen", [0, -r["cursor_m"], 0], [])),
}


def messages(reader):
    """{topic: [(frame, numbers, texts)]} in the order of arrival."""
    found = {}
    for line in reader.said().splitlines():
        if line.startswith("["):
            topic, frame, numbers, texts = json.loads(line)
            found.setdefault(topic, []).append((frame, numbers, texts))
    return found


def is_part_in_order(part, whole):
    rest = iter(whole)
    return all(each in rest for each in part)


class Ros2BridgeTest(Bus):
    ENVIRONMENT = {"CYCLONEDDS_URI": CYCLONE_URI}

    def setUp(self):
        super().setUp()
        self.ros_domain = next_domain()
        self.start_ns = self.info(RECORDING)["start_ns"]
        self.tables = {}
        self.first, self.second = self.stretch(60.0), self.stretch(70.0)

    def stretch(self, after_s):
        """50 ms of the recording with the status of a process [s]."""
        status = self.table("service_status", (after_s, after_s + 1.0))[0]
        begin_s = 1e-9 * (int(status["log_time"]) - self.start_ns) - 0.001
        return begin_s, begin_s + 0.05

    def bridge(self, *words):
        return self.start(STILLHAND, "ros2-bridge", "--domain", self.domain, "--ros-domain", self.ros_domain, *words)

    def play(self, stretch, *words):
        begin_s, end_s = stretch
        self.run_verb("replay", RECORDING, "--domain", self.domain, "--start", begin_s, "--end", end_s,
                      "--no-real-time", "--wait-for", "stillhand/sensed", *words)

    def readers(self, bridge, *kinds):
        """Readers that the bridge's writers know and that know them: its topics are there since a first replay."""
        started = [self.start(READER, self.ros_domain, kind) for kind in kinds]
        for reader in started:
            wait_for("the bridge's topics", lambda: f"matched {READ}\n" in reader.said())
        words = f"{len(kinds)} reader" + ("s" if len(kinds) > 1 else "") + "\n"
        wait_for("readers", lambda: bridge.said().count(words) == READ)
        return started

    def table(self, topic, stretch):
        if topic not in self.tables:
            self.tables[topic] = [
                {title.split(" [")[0]: cell for title, cell in row.items()}
                for row in self.rows(RECORDING, f"stillhand/{topic}")]
        begin_ns, end_ns = (self.start_ns + round(at_s * 1e9) for at_s in stretch)
        return [row for row in self.tables[topic] if begin_ns <= int(row["log_time"]) < end_ns]

    def numbers(self, topic, stretch):
        return [{name: float(cell) for name, cell in row.items() if re.search("_(n|m|rad|s|s2)$", name)}
                for row in self.table(topic, stretch)]

    def expected(self, topic, *stretches):
        source, of_row = EXPECTED[topic]
        return [of_row(row) for stretch in stretches for row in self.numbers(source, stretch)]

    def assert_last(self, reader, stretch):
        """The last messages of each topic are those of the stretch, each value as the recording has it."""
        last = self.expected("/rig_1/cursor", stretch)
        wait_for("the last message", lambda: messages(reader).get("/rig_1/cursor", [])[-len(last):] == last)
        for topic in EXPECTED:
            expected = self.expected(topic, stretch)
            self.assertGreater(len(expected), 40)
            wait_for(topic, lambda: messages(reader).get(topic, [])[-len(expected):] == expected)

    def test_another_dds_reads_what_the_recording_holds(self):
        bridge = self.bridge("--replay")
        self.play(self.first)
        wait_for("topics", lambda: bridge.said().count(" 0 readers\n") == READ)
        reliable, best_effort = self.readers(bridge, "reliable", "best-effort")
        self.play(self.second, "--rate", 0.1)
        self.assert_last(reliable, self.second)
        for topic in EXPECTED:
            heard = messages(best_effort)[topic]
            self.assertTrue(heard and is_part_in_order(heard, self.expected(topic, self.first, self.second)), topic)
        rows = self.numbers("sensed", self.second)
        for (frame, numbers, _), row in zip(messages(reliable)["/rig_1/imu"][-len(rows):], rows):
            # Orientation: no part about y and z.  An angular velocity is not measured: covariance -1.
            self.assertEqual((frame, numbers[1:3], numbers[4]), ("platform", [0, 0], -1))
            self.assertEqual(numbers[5:], [row["accel_x_m_s2"], -row["accel_y_m_s2"], row["accel_z_m_s2"]])
        statuses = [("/rig_1/" + row["service"], row["tick"]) for row in self.table("service_status", self.second)]
        heard = [(texts[0], texts[2]) for _, _, texts in messages(reliable)["/diagnostics"] if texts[1] == "tick"]
        self.assertEqual(heard[-len(statuses):], statuses)
        self.assertEqual(bridge.end(signal.SIGINT), 0, bridge.said())

    def test_a_reader_that_hangs_holds_up_neither_the_bridge_nor_other_readers(self):
        bridge = self.bridge("--replay")
        self.play(self.first)
        hanging, running = self.readers(bridge, "reliable", "reliable")
        hanging.send_signal(signal.SIGSTOP)
        # More than the buffers on the way and the ten messages of a writer hold: 14,000 messages.
        self.play(LONG, "--rate", 2)
        self.play(self.second, "--rate", 0.1)
        self.assert_last(running, self.second)
        hanging.send_signal(signal.SIGCONT)
        self.play(self.first, "--rate", 0.1)
        self.assert_last(running, self.first)
        bridge.end(signal.SIGINT)
        self.assertNotIn("refused", bridge.said())
        for topic in EXPECTED:
            whole = self.expected(topic, self.first, LONG, self.second, self.first)
            self.assertTrue(is_part_in_order(messages(hanging).get(topic, []), whole), topic)

    def test_the_bridge_writes_topics_of_ros_2_alone(self):
        self.ros_domain = self.domain  # where it could do harm
        file = self.folder / "bus.mcap"
        recorder = self.start(STILLHAND, "record", "--out", file, "--domain", self.domain, "--no-real-time")
        bridge = self.bridge("--replay")
        self.play(self.first, "--topics", "stillhand/sensed", "--topics", "stillhand/motor_command")
        wait_for("four topics and the recorder's readers", lambda: bridge.said().count(" 1 reader\n") == 4)
        self.play(self.second, "--topics", "stillhand/sensed", "--topics", "stillhand/motor_command")
        self.assertEqual(bridge.end(signal.SIGINT), 0, bridge.said())
        recorder.end(signal.SIGINT)
        channels = {topic["topic"]: topic["channels"] for topic in self.info(file)["topics"]}
        ours = {topic: found for topic, found in channels.items() if not topic.startswith("rt/")}
        self.assertTrue({"stillhand/sensed", "stillhand/motor_command"} <= set(ours))
        for topic, found in ours.items():
            self.assertNotIn("bridge", json.dumps(found), topic)
        self.assertEqual({topic.removeprefix("rt/rig_1/") for topic in channels if topic.startswith("rt/")},
                         {"imu", "hand/wrench", "stick/joint_states", "motor/wrench"})
        imu, = channels["rt/rig_1/imu"]
        self.assertEqual([imu[name] for name in ("participant", "qos.reliability", "qos.durability", "user_data")],
                         ["stillhand_ros2_bridge", "reliable", "volatile", f"typehash={HASH_OF_IMU};"])

    def test_a_replay_is_published_only_where_a_person_asks_for_it(self):
        bridge = self.bridge()
        self.play(self.first)
        wait_for("the remark", lambda: "a replay runs on this domain; --replay publishes it" in bridge.said())
        self.assertEqual(bridge.end(signal.SIGINT), 1)
        self.assertNotIn("/rig_1/imu", bridge.said())
        self.assertIn("no message was published", bridge.said())

    def test_what_a_person_can_mend_is_one_line(self):
        for words, want in (
                (("--topics", "stillhand/sensd"), "--topics: got stillhand/sensd, want one of stillhand/event"),
                (("--ros-domain", 233), '--ros-domain: got "233", want a number from 0 to 232'),
                (("--domain", -1), '--domain: got "-1", want a number from 0 to 232'),
                (("--ros-address", "192.0.2.1"), "--ros-address: got 192.0.2.1, which no interface of this"),
                (("--profiles", "nowhere.xml"), "QoS profiles: got no file nowhere.xml")):
            self.refused_for(want, "ros2-bridge", *words)


if __name__ == "__main__":
    lab_process.main(READER, RECORDING)
