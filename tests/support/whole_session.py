#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a test of a session that is in FOLDER; skipped where a trial of that session was not completed.

Usage: whole_session.py FOLDER COMMAND [ARGUMENT]...

A machine that cannot hold a loop of 1 kHz leaves a session without trials (again_after_standstill.py), which shows
nothing of what reads it.
"""
import json
import pathlib
import subprocess
import sys

CTEST_SKIPPED = 77


def main():
    if len(sys.argv) < 3:
        print(__doc__)
        return 2
    summary, command = pathlib.Path(sys.argv[1]) / "summary.json", sys.argv[2:]
    trials = json.loads(summary.read_text())["trials"] if summary.is_file() else []
    if not (trials and all(trial["completed"] for trial in trials)):
        print(f"skipped: {summary}: want a session whose trials were all completed")
        return CTEST_SKIPPED
    return subprocess.run(command, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
