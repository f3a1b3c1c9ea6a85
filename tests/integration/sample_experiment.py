# SPDX-License-Identifier: Apache-2.0
"""An experiment's folder with simulated participants, made in seconds and without a bus (write_sample_experiment.cpp)."""
import csv
import math
import pathlib
import re
import subprocess
import tempfile
import unittest

from lab_process import BUILD, STILLHAND

WRITE_SAMPLE = BUILD / "tests" / "write_sample_experiment"
LIMIT_S = 500.0  # next to other work


def stillhand(*words, status=0):
    """Runs a verb to its end; returns (standard output, standard error)."""
    done = subprocess.run([str(STILLHAND), *map(str, words)], capture_output=True, text=True, check=False,
                          timeout=LIMIT_S)
    if done.returncode != status:
        raise AssertionError(f"{words}: status {done.returncode}: {done.stdout}{done.stderr}")
    return done.stdout, done.stderr


def new_experiment(folder, participants, *words, **values):
    """Makes the folder and changes keys of its experiment.yaml; trials of 5 s unless said otherwise."""
    stillhand("experiment", "new", folder, "--participants", participants, "--trial-seconds", 5, "--identify-seconds", 5,
              "--seed", 11, *words)
    file = folder / "experiment.yaml"
    text = file.read_text()
    for key, value in values.items():
        text, count = re.subn(rf"(?m)^( *){key}: .*$", rf"\g<1>{key}: {value}", text)
        if count != 1:
            raise AssertionError(f"{key}: {count} times in experiment.yaml")
    file.write_text(text)


def conduct(folder, *otherwise):
    """Every participant.  `otherwise`: arguments of write_sample_experiment."""
    subprocess.run([str(WRITE_SAMPLE), str(folder), *map(str, otherwise)], check=True, timeout=LIMIT_S)


def rows(file):
    """Of a CSV file, by the names of its columns."""
    with open(file, encoding="utf-8", newline="") as text:
        return list(csv.DictReader(text))


def number(text):
    """Of a cell; an empty one is not a number."""
    return float(text) if text else math.nan


def unblind(folder):
    stillhand("experiment", "unblind", folder, "--reason", "Anna said so")


class SampleExperimentCase(unittest.TestCase):
    """Cases that share a folder, and in it the place of an experiment."""

    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.folder = pathlib.Path(holder.name)
        cls.experiment = cls.folder / "experiment"
