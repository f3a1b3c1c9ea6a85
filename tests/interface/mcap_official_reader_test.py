# SPDX-License-Identifier: Apache-2.0
"""Recordings as others read them: the MCAP project's own reader, Foxglove's IDL parser and deserialiser.

Installs the npm packages that their lock file names into the build tree. Skipped (status 77) without Node.js, without npm,
or if npm cannot install the packages. Reads a live session's recording (fixture lab_run) and one file of each compression.
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

from verb_case import BUILD, STILLHAND, FolderCase, rows  # noqa: E402

SCRIPTS = pathlib.Path(__file__).resolve().parent / "mcap_official_reader"
INSTALLED = BUILD / "tests" / "mcap_official_reader"
WRITE_SAMPLE = BUILD / "tests" / "write_sample_recording"
RECORDING = pathlib.Path(os.environ.get("STILLHAND_RECORDING", BUILD / "tests" / "lab_run" / "session.mcap"))
CTEST_SKIPPED = 77
INSTALL_LIMIT_S = 120


def skip(why):
    print("skipped:", why)
    sys.exit(CTEST_SKIPPED)


def install():
    for program in ("node", "npm"):
        if shutil.which(program) is None:
            skip(f"{program} is not installed")
    INSTALLED.mkdir(parents=True, exist_ok=True)
    for script in SCRIPTS.iterdir():
        if script.is_file():
            shutil.copy(script, INSTALLED)
    lock = (SCRIPTS / "package-lock.json").read_text()
    mark = INSTALLED / "node_modules" / "installed-lock.json"
    if mark.is_file() and mark.read_text() == lock:
        return
    try:
        installed = subprocess.run(["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund"], cwd=INSTALLED,
                                   capture_output=True, text=True, timeout=INSTALL_LIMIT_S, check=False)
    except subprocess.TimeoutExpired:
        skip(f"npm did not install the packages within {INSTALL_LIMIT_S} s")
    if installed.returncode != 0:
        skip("npm cannot install the packages: " + (installed.stderr.strip().splitlines() or ["?"])[-1])
    mark.write_text(lock)


def run(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)


def node(script, *words):
    return run("node", INSTALLED / script, *words)


class OfficialReaderTest(FolderCase):
    def assert_same_counts(self, file):
        """Their reader by index and as a stream, every checksum validated; ours."""
        theirs = node("read_recording.mjs", file)
        self.assertEqual(theirs.returncode, 0, theirs.stderr)
        theirs = json.loads(theirs.stdout)
        ours = self.info(file)
        self.assertEqual(theirs["messages"], ours["messages"])
        self.assertEqual({name: topic["messages"] for name, topic in theirs["topics"].items()},
                         {topic["topic"]: topic["messages"] for topic in ours["topics"] if topic["messages"]})
        self.assertEqual(theirs["statistics"]["start_ns"], str(ours["start_ns"]))
        self.assertEqual(theirs["statistics"]["end_ns"], str(ours["end_ns"]))
        if "data_crc_computed" in theirs:
            self.assertEqual(theirs["data_crc_computed"], theirs["data_crc_in_file"])
        return ours, theirs

    def export(self, file):
        tables = self.folder / "tables"
        self.assertEqual(self.run_verb("export", file, "--csv", tables).stderr, "")
        return tables

    def test_every_message_of_a_live_recording_has_the_same_values(self):
        ours, _ = self.assert_same_counts(RECORDING)
        self.assertGreater(ours["messages"], 10_000)
        compared = node("compare_values.mjs", RECORDING, self.export(RECORDING))
        self.assertEqual(compared.returncode, 0, compared.stderr)
        found = json.loads(compared.stdout)
        self.assertEqual(found["messages"], ours["messages"])
        print(f"{found['messages']} messages, {found['values']} values are the same")

    def test_one_wrong_digit_would_be_noticed(self):
        tables = self.export(RECORDING)
        sensed = tables / "stillhand_sensed.csv"
        lines = sensed.read_text().split("\n")
        cells = lines[1000].split(",")
        cells[9] = cells[9][:-1] + ("1" if cells[9][-1] != "1" else "2")
        lines[1000] = ",".join(cells)
        sensed.write_text("\n".join(lines))
        compared = node("compare_values.mjs", RECORDING, tables)
        self.assertEqual(compared.returncode, 1)
        self.assertIn("stillhand/sensed, message 1000: accel_y_m_s2", compared.stderr)

    def test_every_compression_is_read(self):
        for compression in ("none", "lz4", "zstd"):
            with self.subTest(compression):
                file = self.folder / f"{compression}.mcap"
                self.assertEqual(run(WRITE_SAMPLE, file, compression).returncode, 0)
                ours, theirs = self.assert_same_counts(file)
                self.assertEqual(ours["compression"], [compression])
                self.assertEqual(theirs["compression"], ["" if compression == "none" else compression])
                self.assertEqual(ours["messages"], 20_000)

    def test_a_recovered_recording_is_read(self):
        whole = RECORDING.read_bytes()
        cut, mended = self.folder / "cut.mcap", self.folder / "mended.mcap"
        cut.write_bytes(whole[:len(whole) // 8])
        self.run_verb("recover", cut, "--out", mended)
        ours, _ = self.assert_same_counts(mended)
        self.assertEqual(ours["messages"], self.info(cut)["messages"])
        compared = node("compare_values.mjs", mended, self.export(mended))
        self.assertEqual(compared.returncode, 0, compared.stderr)

    def test_a_bag_of_ros_2_has_the_values_of_the_recording(self):
        bag = self.folder / "bag.mcap"
        self.assertEqual(self.run_verb("export", RECORDING, "--ros2bag", bag).stderr, "")
        read = node("read_ros2.mjs", bag)
        self.assertEqual(read.returncode, 0, read.stderr)
        found = json.loads(read.stdout)
        self.assertEqual(found["profile"], "ros2")
        self.assertEqual({topic["encoding"] for topic in found["topics"].values()}, {"ros2msg"})
        tables = self.export(RECORDING)

        def samples(name):
            return [{title.split(" [")[0]: text for title, text in row.items()} for row in rows(tables / f"{name}.csv")]

        # REP 103: y is left there, and right here.
        expected = {
            "/rig_1/imu": ("stillhand_sensed", lambda m: list(m["linear_acceleration"].values()),
                           lambda r: [r["accel_x_m_s2"], -r["accel_y_m_s2"], r["accel_z_m_s2"]]),
            "/rig_1/hand/wrench": ("stillhand_sensed", lambda m: list(m["wrench"]["force"].values()),
                                   lambda r: [0, -r["force_n"], 0]),
            "/rig_1/stick/joint_states": ("stillhand_sensed", lambda m: [*m["position"], *m["velocity"]],
                                          lambda r: [r["theta_rad"], r["omega_rad_s"]]),
            "/rig_1/motor/wrench": ("stillhand_motor_command", lambda m: list(m["wrench"]["force"].values()),
                                    lambda r: [0, -r["force_n"], 0]),
            "/rig_1/platform/joint_states": ("stillhand_platform_command", lambda m: [*m["position"], *m["velocity"]],
                                             lambda r: [-r["position_m"], -r["velocity_m_s"]]),
            "/rig_1/target": ("stillhand_tracking_sample", lambda m: list(m["point"].values()),
                              lambda r: [0, -r["target_m"], 0]),
        }
        for topic, (table, of_message, of_row) in expected.items():
            ours, theirs = samples(table), found["topics"][topic]
            self.assertEqual(theirs["messages"], len(ours), topic)
            for sample, row in zip(theirs["samples"], ours[::1000]):
                numbers = {name: float(text) for name, text in row.items() if name.endswith(("_n", "_m", "_s", "_s2", "_rad"))}
                self.assertEqual(of_message(sample["value"]), of_row(numbers), topic)
                stamp = sample["value"]["header"]["stamp"]
                self.assertEqual(stamp["sec"] * 10**9 + stamp["nanosec"], int(row["log_time"]))
        diagnostics = found["topics"]["/diagnostics"]
        self.assertEqual(diagnostics["type"], "diagnostic_msgs/msg/DiagnosticArray")
        self.assertIn(diagnostics["samples"][0]["value"]["status"][0]["level"], (0, 1))


if __name__ == "__main__":
    missing = [str(path) for path in (STILLHAND, WRITE_SAMPLE, RECORDING) if not path.is_file()]
    if missing:
        skip("not there: " + ", ".join(missing))
    install()
    unittest.main()
