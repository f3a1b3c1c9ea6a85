# SPDX-License-Identifier: Apache-2.0
"""An experiment's folder with simulated participants, made in seconds and without a bus (write_sample_experiment.cpp)."""
import math
import re
import subprocess

import lab_process  # noqa: F401  first: it knows where verb_case is
import verb_case
from verb_case import BUILD, SharedFolderCase, rows  # noqa: F401  rows for its users

WRITE_SAMPLE = BUILD / "tests" / "write_sample_experiment"
LIMIT_S = 500.0  # next to other work


def stillhand(*words, status=0, **keywords):
    """Runs a verb to its end; returns (standard output, standard error)."""
    done = verb_case.stillhand(*words, **keywords)
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


def number(text):
    """Of a cell; an empty one is not a number."""
    return float(text) if text else math.nan


def unblind(folder):
    stillhand("experiment", "unblind", folder, "--reason", "Anna said so")


class SampleExperimentCase(SharedFolderCase):
    """Cases that share the place of an experiment."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.experiment = cls.folder / "experiment"
