# SPDX-License-Identifier: Apache-2.0
"""A disk of 20 MB that fills up: recorder and session report it and end, and the file so far can be read.

The disk is a tmpfs in a mount namespace of this test (unshare). The test is skipped where the system allows none.
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

from lab_process import BUILD, CTEST_SKIPPED, SOURCE, STILLHAND, next_domain
from verb_case import VerbCase

RECORDER = BUILD / "bin" / "stillhand-recorder"
PUBLISH = BUILD / "tests" / "publish_samples"
DISK_BYTES = 20_000_000
FILLED_BYTES = 19_000_000  # before it begins: 1 MB is full after 3 s of 4 unpacked topics at 1 kHz
END_LIMIT_S = 60.0
INSIDE = "STILLHAND_FULL_DISK"  # set inside the namespace: the mount point


def run(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)


class FullDiskTest(VerbCase):
    def setUp(self):
        self.disk = pathlib.Path(os.environ[INSIDE])
        for left in self.disk.iterdir():
            shutil.rmtree(left) if left.is_dir() else left.unlink()
        out = tempfile.TemporaryDirectory(prefix="out-", dir=self.disk.parent)
        self.addCleanup(out.cleanup)
        self.out = pathlib.Path(out.name)
        # Another one for each case, above the ports that Linux gives to other sockets.
        self.domain = next_domain()

    def fill(self, bytes_used):
        (self.disk / "other").write_bytes(bytes(bytes_used))

    def publish(self):
        self.publisher = subprocess.Popen([str(PUBLISH), "--domain", str(self.domain)], stdout=subprocess.PIPE)
        self.addCleanup(self.end_publisher)

    def end_publisher(self):
        self.publisher.terminate()
        self.publisher.wait()
        self.publisher.stdout.close()

    def record_until_it_ends(self, *words):
        """The recorder's one line, with status 1."""
        self.publish()
        recorder = subprocess.Popen(
            [str(RECORDER), "--domain", str(self.domain), "--profiles", str(SOURCE / "qos/profiles.xml"), "--config",
             str(SOURCE / "deploy/config"), "--out", str(self.disk / "a.mcap"), "--compression", "none", *words],
            stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        try:
            errors = recorder.communicate(timeout=END_LIMIT_S)[1]
        finally:
            recorder.kill()
        self.assertEqual(recorder.returncode, 1, errors)
        self.assertEqual(len(errors.splitlines()), 1, errors)
        self.assertIn("a.mcap", errors)
        return errors

    def test_the_recorder_stops_with_a_whole_file_before_the_disk_is_full(self):
        self.fill(FILLED_BYTES)
        line = self.record_until_it_ends("--min-free-mb", "0.5")
        self.assertIn("left on the disk", line)
        self.run_verb("verify", self.disk / "a.mcap")

    def test_a_session_on_a_full_disk_says_so_and_keeps_what_was_recorded(self):
        # 16 MB are left alone by default: 3 MB hold some seconds of a session, and no first trial of 40 s.
        self.fill(1_000_000)
        lab = self.run_verb("lab", "--domain", self.domain, "--headless", "--out", self.disk / "run", "--trial-seconds", 20,
                            "--identify-seconds", 40, status=1)
        self.assertIn("left on the disk", lab.stderr)
        self.run_verb("verify", self.disk / "run" / "session.mcap")

    def test_a_full_disk_is_announced_and_the_file_is_readable(self):
        self.fill(FILLED_BYTES)
        line = self.record_until_it_ends("--min-free-mb", "0")
        self.assertIn("No space left on device", line)
        file, out = self.disk / "a.mcap", self.out
        told = self.run_verb("info", file, "--json", out / "info.json")
        info = json.loads((out / "info.json").read_text())
        self.assertGreater(info["messages"], 4000)
        # All of it but the chunk that did not fit.
        self.assertLess(info["lost_bytes"], 400_000)
        self.assertIn("cut off", told.stderr)
        # A copy finds no room next to the file, which stays.
        self.assertIn("No space left on device", self.run_verb("recover", file, status=1).stderr)
        self.assertEqual(sorted(path.name for path in self.disk.iterdir()), ["a.mcap", "other"])
        self.run_verb("recover", file, "--out", out / "whole.mcap")
        self.run_verb("verify", out / "whole.mcap")
        (self.disk / "other").unlink()
        self.run_verb("recover", file)
        self.run_verb("verify", file)


def enter_namespace():
    """Runs this script again with a disk of its own; returns its status."""
    with tempfile.TemporaryDirectory(prefix="stillhand-") as folder:
        disk = pathlib.Path(folder) / "disk"
        disk.mkdir()
        mount = ["mount", "-t", "tmpfs", "-o", f"size={DISK_BYTES}", "tmpfs", str(disk)]
        # With a user namespace of its own where it is allowed, else as root.
        for flags in (["-rm"], ["-m"]):
            if run("unshare", *flags, *mount).returncode == 0:
                script = '"$@" && exec "$PYTHON" "$SCRIPT" --verbose'
                environment = {**os.environ, INSIDE: str(disk), "PYTHON": sys.executable, "SCRIPT": __file__}
                return subprocess.run(["unshare", *flags, "sh", "-c", script, "sh", *mount], env=environment,
                                      check=False).returncode
    print("skipped: no mount namespace (unshare -rm) on this system")
    return CTEST_SKIPPED


if __name__ == "__main__":
    missing = [str(path) for path in (STILLHAND, RECORDER, PUBLISH) if not path.is_file()]
    if missing:
        print("skipped, not built:", ", ".join(missing))
        sys.exit(CTEST_SKIPPED)
    if INSIDE in os.environ:
        unittest.main()
    sys.exit(enter_namespace())
