# SPDX-License-Identifier: Apache-2.0
"""A test of verbs on a running bus: a folder, a domain, processes that do not outlive it, recordings looked into."""
import csv
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import lab_process
from lab_process import STILLHAND, next_domain

LIMIT_S = 60.0
# As the profiles: loopback alone, and its multicast for discovery.
CYCLONE_URI = ("<CycloneDDS><Domain><General><Interfaces><NetworkInterface address='127.0.0.1' multicast='true'/>"
               "</Interfaces></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
               "<MaxAutoParticipantIndex>31</MaxAutoParticipantIndex><Peers><Peer Address='127.0.0.1'/></Peers>"
               "</Discovery></Domain></CycloneDDS>")


def stillhand(*words):
    return subprocess.run([str(STILLHAND), *map(str, words)], capture_output=True, text=True, check=False,
                          timeout=LIMIT_S)


def wait_for(what, condition):
    return lab_process.wait_for(what, condition, LIMIT_S)


class Bus(unittest.TestCase):
    ENVIRONMENT = {}

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="stillhand-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.domain = next_domain()

    def start(self, *words, stdin=subprocess.DEVNULL):
        """A process; said() is its output, end(signal) its exit status."""
        output = tempfile.TemporaryFile("w+")
        process = subprocess.Popen([str(word) for word in words], stdin=stdin, stdout=output, stderr=subprocess.STDOUT,
                                   env=os.environ | self.ENVIRONMENT)

        def close():
            process.kill()
            process.wait()
            output.close()
        self.addCleanup(close)

        def said():
            output.seek(0)
            return output.read()

        def end(number):
            process.send_signal(number)
            return process.wait(timeout=LIMIT_S)
        process.said, process.end = said, end
        return process

    def info(self, file):
        found = stillhand("info", file, "--json", self.folder / "info.json")
        self.assertEqual(found.returncode, 0, found.stderr)
        return json.loads((self.folder / "info.json").read_text())

    def rows(self, file, topic):
        """Table of one topic, [{title with its unit: text}]."""
        tables = pathlib.Path(tempfile.mkdtemp(dir=self.folder))
        exported = stillhand("export", file, "--csv", tables, "--topics", topic)
        self.assertEqual(exported.returncode, 0, exported.stderr)
        with open(tables / (topic.replace("/", "_") + ".csv"), newline="", encoding="utf-8") as table:
            return list(csv.DictReader(table))
