#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""deploy/with_progress.sh in a pipe and on a terminal."""
import os
import pathlib
import pty
import subprocess
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "deploy" / "with_progress.sh"


class WithProgressTest(unittest.TestCase):
    def setUp(self):
        file = tempfile.NamedTemporaryFile()
        self.addCleanup(file.close)
        self.log = file.name

    def words(self, command):
        return [str(SCRIPT), "build", self.log, "bash", "-c", command]

    def test_in_a_pipe_whole_lines_say_how_far_it_is(self):
        # The command goes on until the line is there: no time is waited for.
        command = r'printf "\033[1m[1/3] x\r\n"; read -r < "$0"'
        with tempfile.TemporaryDirectory() as folder:
            gate = pathlib.Path(folder) / "gate"
            os.mkfifo(gate)
            with subprocess.Popen([*self.words(command), str(gate)], stdout=subprocess.PIPE,
                                  env={**os.environ, "STILLHAND_PROGRESS_S": "0.1"}) as sut:
                line = next(line for line in sut.stdout if b"[1/3]" in line)
                gate.write_text("go\n")
                sut.stdout.read()
        self.assertRegex(line, rb"^build: \d+ s, \[1m\[1/3\] x\n$")
        self.assertEqual(sut.returncode, 0)

    def test_a_short_command_is_silent_in_a_pipe_and_its_output_is_in_the_log(self):
        done = subprocess.run(self.words("echo said"), capture_output=True, text=True, check=True)
        self.assertEqual(done.stdout + done.stderr, "")
        self.assertEqual(pathlib.Path(self.log).read_text(), "said\n")

    def test_the_status_is_that_of_the_command(self):
        self.assertEqual(subprocess.run(self.words("exit 3"), check=False).returncode, 3)

    def test_on_a_terminal_the_output_passes_through(self):
        primary, secondary = pty.openpty()
        subprocess.run(self.words("echo said"), stdout=secondary, check=True)
        self.assertEqual(os.read(primary, 100), b"said\r\n")
        os.close(primary)
        os.close(secondary)


if __name__ == "__main__":
    unittest.main()
