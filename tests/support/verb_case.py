# SPDX-License-Identifier: Apache-2.0
"""Tests of verbs: a verb run to its end, its refusal in one line, the tables of a recording, a folder for a test."""
import csv
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", SOURCE / "build"))
STILLHAND = pathlib.Path(os.environ.get("STILLHAND_PROGRAMS", BUILD / "bin")) / "stillhand"
VERB_LIMIT_S = 600.0  # a guard against a verb that hangs, next to other work


def stillhand(*words, **keywords):
    return subprocess.run([str(STILLHAND), *map(str, words)], check=False, text=True,
                          **{"capture_output": True, "timeout": VERB_LIMIT_S} | keywords)


def rows(file, delimiter=","):
    """Of a table: [{title, with its unit: text}]."""
    with open(file, encoding="utf-8", newline="") as text:
        return list(csv.DictReader(text, delimiter=delimiter))


def columns(file, *names):
    """Some columns of a table, by their titles without units: [[text]]."""
    with open(file, encoding="utf-8", newline="") as text:
        table = csv.reader(text)
        titles = [title.split(" [")[0] for title in next(table)]
        places = [titles.index(name) for name in names]
        return [[row[place] for place in places] for row in table]


class VerbCase(unittest.TestCase):
    def run_verb(self, *words, status=0, **keywords):
        done = stillhand(*words, **keywords)
        self.assertEqual(done.returncode, status, f"{words}: {done.stdout}{done.stderr}")
        return done

    def refused(self, *words, **keywords):
        """What a person can mend: status 2 and one line, which it returns."""
        errors = self.run_verb(*words, status=2, **keywords).stderr
        self.assertEqual(len(errors.splitlines()), 1, errors)
        return errors

    def refused_for(self, said, *words, **keywords):
        self.assertIn(said, self.refused(*words, **keywords))

    def assert_sealed(self, folder):
        """The files are those whose digests were written before."""
        checked = subprocess.run(["sha256sum", "--check", "--strict", "undeclared_effect.sha256"], cwd=folder,
                                 capture_output=True, text=True, check=False)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        return checked.stdout

    def info(self, file):
        with tempfile.TemporaryDirectory(prefix="stillhand-") as folder:
            out = pathlib.Path(folder) / "info.json"
            self.run_verb("info", file, "--json", out)
            return json.loads(out.read_text())

    def rows(self, file, topic):
        """Table of one topic of a recording."""
        with tempfile.TemporaryDirectory(prefix="stillhand-") as tables:
            self.run_verb("export", file, "--csv", tables, "--topics", topic)
            return rows(pathlib.Path(tables) / (topic.replace("/", "_") + ".csv"))


class FolderCase(VerbCase):
    """A folder for each test."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="stillhand-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)


class SharedFolderCase(VerbCase):
    """A folder for all tests of the class."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="stillhand-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
