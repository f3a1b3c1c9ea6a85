# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C while `stillhand export` and `stillhand recover` write: no piece of a file is left, and one line says so."""
import os
import pathlib
import signal
import subprocess
import tempfile

import lab_process
from lab_process import BUILD, STILLHAND, wait_for
from verb_case import FolderCase

LOAD = BUILD / "tests" / "write_load"
# Seconds of work for either verb: 2 million messages, where a signal finds its way within milliseconds.
RATE = 100_000
LENGTH_S = 20
LIMIT_S = 180.0
POLL_S = 0.01


class InterruptedVerbsTest(FolderCase):
    @classmethod
    def setUpClass(cls):
        shared = tempfile.TemporaryDirectory(prefix="stillhand-")
        cls.addClassCleanup(shared.cleanup)
        cls.recording = pathlib.Path(shared.name) / "long.mcap"
        subprocess.run([str(LOAD), str(cls.recording), str(RATE), str(LENGTH_S)], check=True)
        os.truncate(cls.recording, cls.recording.stat().st_size - 1000)  # as a crash leaves it

    def assert_interrupted(self, wanted, piece, *words):
        """Interrupts the verb once `piece` (a pattern) has begun to grow."""
        verb = subprocess.Popen([str(STILLHAND), *(str(word) for word in words)], stdin=subprocess.DEVNULL,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            wait_for(f"{piece} of 100 kB", lambda: verb.poll() is not None or any(
                path.stat().st_size > 100_000 for path in self.folder.glob(piece)), LIMIT_S, POLL_S)
            self.assertIsNone(verb.poll(), "it ended by itself")
            verb.send_signal(wanted)
            output, errors = verb.communicate(timeout=LIMIT_S)
        finally:
            verb.kill()
        self.assertEqual(verb.returncode, 1, errors)
        self.assertEqual(errors, f"stillhand {words[0]}: stopped before the end; nothing was written\n")
        self.assertEqual(output, "")
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_an_export_leaves_no_piece_of_a_table(self):
        places = {"--csv": "out", "--hdf5": "a.h5"}
        for option, piece in (("--csv", "out/.unfinished-*/*.csv"), ("--hdf5", "a.h5.new-*")):
            with self.subTest(option):
                self.assert_interrupted(signal.SIGINT, piece, "export", self.recording, option,
                                        self.folder / places[option])

    def test_a_recovery_leaves_no_piece_of_the_new_file(self):
        before = self.recording.stat()
        for wanted in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(wanted.name):
                self.assert_interrupted(wanted, "whole.mcap.new-*", "recover", self.recording, "--out",
                                        self.folder / "whole.mcap")
        after = self.recording.stat()
        self.assertEqual((after.st_size, after.st_mtime_ns), (before.st_size, before.st_mtime_ns))


if __name__ == "__main__":
    lab_process.main(LOAD)
