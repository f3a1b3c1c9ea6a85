# SPDX-License-Identifier: Apache-2.0
"""A bus that is not Stillhand's: recorded, verified, exported, replayed, and the replay recorded, bit for bit.

The writers are programs of another project (foreign/plant.idl): one with Fast DDS, which describes its types, with a
topic as ROS 2 writes it; one with Cyclone DDS. No program of Stillhand compiles their types.
"""
import json
import pathlib
import signal
import subprocess
import unittest

import lab_process
from bus_case import CYCLONE_URI, LIMIT_S, Bus
from lab_process import BUILD, SOURCE, STILLHAND, next_domain
from verb_case import stillhand

IDL = pathlib.Path(__file__).resolve().parent / "foreign" / "plant.idl"
FAST_DDS = BUILD / "tests" / "plant_writer"
CYCLONE = BUILD / "tests" / "plant_cyclone"
SESSION_READER = BUILD / "tests" / "session_reader"
MOTION = STILLHAND.with_name("stillhand-motion")
COMPARE = BUILD / "tests" / "compare_messages"
COUNT = 60
MOST_TOPICS = 1000
PATTERNS = ["--topics", "plant/*", "--topics", "rt/*"]
needs_cyclone = unittest.skipUnless(CYCLONE.is_file(),
                                    "built without Cyclone DDS (packages cyclonedds-dev and cyclonedds-tools)")


def has_xcdr2():
    """Fast DDS 2 announces no data representation, so nobody sends XCDR 2 to it."""
    libraries = subprocess.run(["ldd", str(STILLHAND)], capture_output=True, text=True, check=True).stdout
    return "libfastrtps.so" not in libraries


class ForeignBusTest(Bus):
    ENVIRONMENT = {"CYCLONEDDS_URI": CYCLONE_URI}

    def wait_for(self, what, process, condition):
        lab_process.wait_for(what, lambda: condition() or process.poll() is not None, LIMIT_S)
        self.assertTrue(condition(), process.said())

    def record(self, program, name, *words):
        """A recording of what a program writes, with the program still there, and the recorder's output."""
        domain = next_domain()
        file = self.folder / name
        recorder = self.start(STILLHAND, "record", "--out", file, "--domain", domain, "--no-real-time", *PATTERNS,
                              *words)
        writer = self.start(program, domain)
        self.wait_for("everything acknowledged", writer, lambda: f"written {COUNT}" in writer.said())
        status = recorder.end(signal.SIGINT)
        self.assertEqual(status, 0, recorder.said())
        return file, domain, writer, recorder.said()

    def assert_replayed(self, file, topics):
        """Recorded whole, and its replay recorded again: the same bytes in the same order."""
        self.assertEqual(stillhand("verify", file).returncode, 0)
        counts = next(each["texts"] for each in self.info(file)["metadata"] if each["name"] == "stillhand.counts")
        for topic in topics:
            self.assertEqual({key: counts[f"{topic} {key}"] for key in ("received", "lost", "late", "written")},
                             {"received": str(COUNT), "lost": "0", "late": "0", "written": str(COUNT)}, topic)
        domain = next_domain()
        again = self.folder / "again.mcap"
        recorder = self.start(STILLHAND, "record", "--out", again, "--domain", domain, "--no-real-time", *PATTERNS)
        waits = [word for topic in topics for word in ("--wait-for", topic)]
        replayed = stillhand("replay", file, "--domain", domain, "--no-real-time", *waits)
        self.assertEqual(replayed.returncode, 0, replayed.stderr)
        self.assertEqual(recorder.end(signal.SIGINT), 0, recorder.said())
        compared = subprocess.run([str(COMPARE), str(file), str(again)], capture_output=True, text=True, check=False)
        self.assertEqual(compared.returncode, 0, compared.stderr)
        result = json.loads(compared.stdout)
        self.assertEqual(set(result), set(topics))
        for topic, found in result.items():
            self.assertEqual((found["messages"], found["equal"], found["in_order"]), (COUNT, True, True), topic)
        before, after = (self.channels(each) for each in (file, again))
        for topic in topics:
            self.assertEqual(after[topic].get("replayed"), "true")
            for key in before[topic]:
                if key.startswith("qos.") or key == "keyed":
                    self.assertEqual(after[topic].get(key), before[topic][key], f"{topic} {key}")
        return result

    def channels(self, file):
        return {topic["topic"]: topic["channels"][0] for topic in self.info(file)["topics"]}

    def test_a_fast_dds_program_is_recorded_and_replayed_bit_for_bit(self):
        file, domain, writer, said = self.record(FAST_DDS, "fast_dds.mcap")
        self.assertIn("rt/imu", said)
        self.assertIn("type not known: recorded as bytes", said)
        topics = {topic["topic"]: topic for topic in self.info(file)["topics"]}
        self.assertEqual(topics["rt/imu"]["type"], "sensor_msgs::msg::dds_::Imu_")
        channels = self.channels(file)
        self.assertEqual(channels["rt/imu"]["user_data"], "typehash=RIHS01_0123456789abcdef;")
        self.assertEqual(channels["plant/flat"]["qos.durability"], "transient_local")
        self.assertEqual(channels["plant/state"]["qos.deadline_ns"], "100000000000")
        self.assertEqual(channels["plant/state"]["keyed"], "true")
        if has_xcdr2():
            # The definitions come from the bus.
            flat = self.rows(file, "plant/flat")
            self.assertEqual([float(row["pressure_pa [?]"]) for row in flat], [1e5 - i for i in range(COUNT)])
            state = self.rows(file, "plant/state")
            self.assertEqual([float(row["joint.angle_rad [?]"]) for row in state], [0.5 * i for i in range(COUNT)])
        # With its writer there, the replay would be a second one.
        refused = stillhand("replay", file, "--domain", domain, "--no-real-time")
        self.assertEqual(refused.returncode, 2, refused.stdout)
        self.assertIn("which a plant writes", refused.stderr)
        writer.end(signal.SIGTERM)
        self.assert_replayed(file, ["plant/state", "plant/flat", "rt/imu"])

    def test_a_definition_from_a_file_serves_where_the_bus_gives_none(self):
        file, _, _, _ = self.record(FAST_DDS, "idl.mcap", "--idl", IDL)
        state = self.rows(file, "plant/state")
        self.assertEqual([int(row["tick [-]"]) for row in state], list(range(COUNT)))
        self.assertEqual([float(row["gains.1 [?]"]) for row in state], [-float(i) for i in range(COUNT)])

    def test_of_a_crowd_of_topics_a_thousand_are_recorded_and_the_rest_is_said(self):
        file = self.folder / "crowd.mcap"
        recorder = self.start(STILLHAND, "record", "--out", file, "--domain", self.domain, "--no-real-time", *PATTERNS)
        writer = self.start(FAST_DDS, self.domain, "crowd", MOST_TOPICS)
        self.wait_for("everything acknowledged", writer, lambda: f"written {MOST_TOPICS}" in writer.said())
        self.assertEqual(recorder.end(signal.SIGINT), 1)
        self.assertIn("of so many topics some are not received", recorder.said())
        self.assertEqual([topic["messages"] for topic in self.info(file)["topics"]], [1] * MOST_TOPICS)

    @needs_cyclone
    def test_a_cyclone_program_is_recorded_and_replayed_bit_for_bit(self):
        if not has_xcdr2():
            return self.assert_plain_cdr_of_cyclone()
        file, _, writer, said = self.record(CYCLONE, "cyclone.mcap")
        self.assertIn("type not known: recorded as bytes", said)
        writer.end(signal.SIGTERM)
        result = self.assert_replayed(file, ["plant/state", "plant/growing"])
        # DDS-XTypes 1.3, table 60: plain CDR 1, and delimited XCDR 2, little-endian.
        self.assertEqual(result["plant/state"]["encapsulation"], 1)
        self.assertEqual(result["plant/growing"]["encapsulation"], 9)
        return None

    def assert_plain_cdr_of_cyclone(self):
        """The writer of XCDR 2 finds no reader, which the recorder says; the other one is whole."""
        domain = next_domain()
        file = self.folder / "cyclone.mcap"
        recorder = self.start(STILLHAND, "record", "--out", file, "--domain", domain, "--no-real-time", *PATTERNS,
                              "--idl", IDL)
        writer = self.start(CYCLONE, domain, "plain")
        self.wait_for("everything acknowledged", writer, lambda: f"written {COUNT}" in writer.said())
        self.assertEqual(recorder.end(signal.SIGINT), 1)
        self.assertIn("plant/growing: a writer that offers XCDR 2 is not received", recorder.said())
        writer.end(signal.SIGTERM)
        state = self.rows(file, "plant/state")
        self.assertEqual([float(row["joint.angle_rad [?]"]) for row in state], [0.5 * i for i in range(COUNT)])
        self.assert_replayed(file, ["plant/state"])

    @needs_cyclone
    def test_foreign_readers_that_join_and_leave_end_no_process_of_a_session(self):
        process = self.start(MOTION, "--domain", self.domain, "--profiles", SOURCE / "qos" / "profiles.xml",
                             "--config", SOURCE / "deploy" / "config")

        def join():
            reader = self.start(SESSION_READER, self.domain)
            self.wait_for("status", process, lambda: "heard motion\n" in reader.said())
            return reader
        for reader in [join() for _ in range(3)]:
            self.assertEqual(reader.end(signal.SIGTERM), 0, reader.said())
            join()
        self.assertEqual(process.end(signal.SIGINT), 0, process.said())


if __name__ == "__main__":
    lab_process.main(FAST_DDS)
