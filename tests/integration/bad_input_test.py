# SPDX-License-Identifier: Apache-2.0
"""What the user can mend: exit status 2, one line with what, where and what would be right, nothing left behind."""
import shutil
import socket

import lab_process
from lab_process import MATCH_LIMIT_S, SOURCE, STILLHAND, LabTestCase, next_domain, running

PROFILES = SOURCE / "qos" / "profiles.xml"
RIDE_ROWS = [f"{0.01 * i:.2f},{0.5 if i % 20 < 10 else -0.5}" for i in range(1000)]
# Found by a service, so after every process was started and had its chance to match.
REFUSAL_LIMIT_S = MATCH_LIMIT_S + 10.0


class BadInputTest(LabTestCase):
    def assert_refused(self, words, *arguments, **keywords):
        """The lab refuses its arguments in one line that holds the words, and leaves nothing."""
        lab = self.lab(*arguments, **keywords)
        there_before = lab.out.exists()
        self.assertEqual(lab.end_status(REFUSAL_LIMIT_S), 2, lab.errors())
        self.assert_one_line(lab.errors(), words)
        self.assert_nothing_left(lab)
        if not there_before:
            self.assertFalse(lab.out.exists(), "results of a session that never was")

    def assert_one_line(self, lines, words):
        self.assertEqual(len(lines), 1, lines)
        self.assertTrue(lines[0].startswith("stillhand"), lines[0])
        for word in words:
            self.assertIn(word, lines[0])

    def file(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def settings(self, name, text):
        folder = self.folder / "config"
        shutil.copytree(SOURCE / "deploy" / "config", folder)
        (folder / name).write_text(text)
        return folder

    def ride(self, header, rows):
        return self.file("ride.csv", "\n".join([header, *rows]) + "\n")

    def assert_ride_refused(self, words, header, rows):
        ride = self.ride(header, rows)
        self.assert_refused([str(ride), *words], "--conditions", "B", "--trial-seconds", 5, "--identify-seconds", 5,
                            "--motion", "ride", "--ride", ride)

    def test_arguments_out_of_bounds_are_refused(self):
        cases = [
            (["--conditions", "A,D"], ['"D"', "A (stationary)"]),
            (["--conditions", "A,A"], ["A twice", "each condition once"]),
            (["--conditions", ""], ["--conditions", "A,B,C"]),
            (["--trial-seconds", "-5"], ["--trial-seconds", "-5", "5 to 3600"]),
            (["--trial-seconds", "nan"], ["--trial-seconds", "nan", "5 to 3600"]),
            (["--identify-seconds", "inf"], ["--identify-seconds", "inf", "5 to 3600"]),
            (["--trial-seconds", "soon"], ["--trial-seconds", "soon"]),
            (["--seed", "-1"], ["--seed", "-1"]),
            (["--seed", "99999999999999999999"], ["--seed", "99999999999999999999", "9223372036854775807"]),
            (["--seed", "1.5"], ["--seed", "1.5"]),
            (["--match-seconds", "-1"], ["--match-seconds", "-1"]),
            (["--motion", "train"], ["--motion", "train", "noise", "road", "ride"]),
            (["--motion", "ride"], ["--ride"]),
            (["--motion", "road", "--road-class", "J"], ["--road-class", '"J"', "A (very good) to H"]),
            (["--motion", "road", "--road-class", "b"], ["--road-class", '"b"', "A (very good) to H"]),
            (["--motion", "road", "--speed-m-s", "71"], ["--speed-m-s", "71", "0.5 to 70 m/s"]),
            (["--motion", "road", "--speed-m-s", "nan"], ["--speed-m-s", "nan", "0.5 to 70 m/s"]),
            (["--motion", "road", "--speed-m-s", "72km/h"], ["--speed-m-s", "72km/h"]),
            (["--motion", "road", "--road-class", "F"], ["--road-class", "F at 20 m/s", "less speed"]),
            (["--road-class", "C"], ["--road-class", "--motion road"]),
            (["--speed-m-s", "10"], ["--speed-m-s", "--motion road"]),
            (["--operator", "mouse"], ["--headless"]),
            (["--misspelt"], ["--misspelt"]),
        ]
        for arguments, words in cases:
            with self.subTest(" ".join(arguments)):
                self.assert_refused(words, *arguments)

    def test_domain_out_of_bounds_is_refused(self):
        for domain in (233, -1):
            with self.subTest(domain):
                self.assert_refused(["--domain", str(domain)], domain=domain)

    def test_missing_out_is_refused(self):
        lab = self.lab(out="")
        self.assertEqual(lab.end_status(), 2)
        self.assert_one_line(lab.errors(), ["--out"])

    def test_out_that_cannot_be_written_is_refused(self):
        file = self.file("file", "kept")
        self.assert_refused(["--out", str(file), "folder"], out=file)
        self.assertEqual(file.read_text(), "kept")
        # Not even root can write there.
        self.assert_refused(["--out", "/proc/stillhand", "folder"], out="/proc/stillhand")

    def test_profile_file_that_is_missing_or_broken_is_refused(self):
        text = PROFILES.read_text()
        self.assert_refused(["nowhere.xml", "qos/profiles.xml"], "--profiles", self.folder / "nowhere.xml")
        self.assert_refused(["cut.xml", "XML"], "--profiles", self.file("cut.xml", text[:len(text) // 2]))

    # The lab uses stream_slow itself; record_stream only the recorder does, so that a service has to find it out.
    def test_missing_profile_is_named(self):
        for name in ("stream_slow", "record_stream"):
            with self.subTest(name):
                text = PROFILES.read_text().replace(f'profile_name="{name}"', 'profile_name="renamed"')
                self.assert_refused([f"{name}.xml", f'"{name}"'], "--profiles", self.file(f"{name}.xml", text))

    def test_misspelt_setting_is_named_with_file_line_and_column(self):
        folder = self.settings("rig.yaml", "motor:\n  lag_seconds: 0.002\n")
        self.assert_refused([f"{folder}/rig.yaml:2:3", "lag_seconds", "lag_s"], "--config", folder)

    def test_settings_that_no_trial_can_have_are_refused_before_the_session(self):
        folder = self.settings("motion.yaml", "limits:\n  max_position_m: 0.005\n")
        self.assert_refused(["motion.yaml", "trial 0 (I)", "0.005"], "--config", folder)
        (folder / "motion.yaml").write_text("")
        (folder / "display.yaml").write_text("reference_scale_m: 0.4\n")
        self.assert_refused(["display.reference_scale_m", "0.4", "smaller"], "--config", folder)

    def test_missing_settings_folder_is_named(self):
        self.assert_refused([str(self.folder / "nowhere")], "--config", self.folder / "nowhere")

    def test_missing_ride_file_is_named(self):
        self.assert_refused(["nowhere.csv"], "--conditions", "B", "--motion", "ride", "--ride",
                            self.folder / "nowhere.csv")

    def test_ride_with_a_gap_is_refused(self):
        self.assert_ride_refused(["row 500", "100 rows"], "t [s],a_y [m/s^2]", RIDE_ROWS[:500] + RIDE_ROWS[600:])

    def test_ride_without_lateral_acceleration_is_refused(self):
        self.assert_ride_refused(["a_y [m/s^2]"], "t [s],a_x [m/s^2]", RIDE_ROWS)

    def test_ride_that_the_results_would_replace_is_refused_and_kept(self):
        out = self.folder / "earlier"
        out.mkdir()
        ride = out / "session.mcap"
        ride.write_bytes(b"kept")
        self.assert_refused([str(ride)], "--motion", "ride", "--ride", ride, out=out)  # no recording
        ride.unlink()
        (out / "screen.avi").write_text("\n".join(["t [s],a_y [m/s^2]", *RIDE_ROWS]))
        self.assert_refused(["--out", str(out), "screen.avi is read by this session"], "--trial-seconds", 5, "--motion", "ride",
                            "--ride", out / "screen.avi", out=out)
        self.assertTrue((out / "screen.avi").exists())

    def test_a_session_keeps_files_of_others_and_refuses_a_second_lab_in_its_folder_and_on_its_domain(self):
        out = self.folder / "mine"
        (out / "logs").mkdir(parents=True)
        others = [out / "notes.txt", out / "logs" / "server.log"]
        for file in others:
            file.write_text("kept")
        first = self.lab("--conditions", "A", out=out)
        first.wait_for_start()
        self.assert_refused(["--out", str(out), "another lab"], out=out)
        self.assertTrue((out / "session.mcap").exists())
        second = self.lab(out=self.folder / "second", domain=first.domain)
        self.assertEqual(second.end_status(), 2)
        self.assert_one_line(second.errors(), ["--domain", str(first.domain), "another lab"])
        self.assertFalse(second.out.exists())
        self.assertIsNone(first.process.poll())
        self.assertGreater(len(running(first.domain)), len(lab_process.SERVICES))
        first.interrupt()
        self.assertEqual(first.end_status(), 1)
        self.assert_nothing_left(first)
        self.assertEqual([file.read_text() for file in others], ["kept", "kept"])

    def test_a_model_that_the_canceller_refuses_ends_the_session_before_the_trial(self):
        arguments = lab_process.quick_session(self.folder / "config")
        (self.folder / "config" / "cancellation.yaml").write_text("max_model_gain_n_s2_m: 1\n")
        lab = self.lab(*arguments)
        self.assertEqual(lab.end_status(90), 1)
        self.assertIn("cancellation was not prepared", lab.errors()[-1])
        self.assertEqual(lab.errors()[-1].count("the log of cancellation says why"), 1, "the reason, once")
        self.assertIn("model gain is above the bound", (lab.out / "logs" / "cancellation.log").read_text())
        self.assertFalse(lab.summary()["trials"][-1]["completed"])

    def test_port_in_use_is_named(self):
        domain = next_domain()
        port = 7400 + 250 * domain
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as occupied:
            occupied.bind(("0.0.0.0", port))
            self.assert_refused(["--domain", str(port)], domain=domain)

    def test_missing_program_is_named(self):
        programs = self.folder / "bin"
        programs.mkdir()
        (self.folder / "share").symlink_to(STILLHAND.parents[1] / "share")
        shutil.copy(STILLHAND, programs)
        for service in lab_process.SERVICES:
            if service != "display":
                (programs / f"stillhand-{service}").symlink_to(STILLHAND.with_name(f"stillhand-{service}"))
        self.assert_refused([str(programs / "stillhand-display")], program=programs / "stillhand")


if __name__ == "__main__":
    lab_process.main()
