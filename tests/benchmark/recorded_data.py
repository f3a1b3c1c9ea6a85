# SPDX-License-Identifier: Apache-2.0
"""What the programs over recordings share: the build, the recordings that are no part of the project, a verb, a column."""
import csv
import os
import pathlib
import subprocess
import sys

import numpy

SKIPPED = 77
SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", SOURCE / "build"))
DATA = pathlib.Path(os.environ.get("STILLHAND_DATA", SOURCE.parent / "shared" / "data"))


def stillhand(*words):
    """Runs a verb; a verb that fails ends the program with its line."""
    run = subprocess.run([str(BUILD / "bin" / "stillhand"), *map(str, words)], capture_output=True, text=True)
    if run.returncode:
        sys.exit(f"{pathlib.Path(sys.argv[0]).stem}: {run.stderr.strip()}")


def columns_of(path, names):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    at = [[title.split(" [")[0] for title in rows[0]].index(name) for name in names]
    return [numpy.array([float(row[column]) for row in rows[1:]]) for column in at]


def column(path, name):
    return columns_of(path, [name])[0]


def needs(file):
    """Skips the program where a recording of DATA is not there."""
    if not (DATA / file).is_file():
        print(f"skipped: no recordings in {DATA}; STILLHAND_DATA names their folder")
        sys.exit(SKIPPED)
