# SPDX-License-Identifier: Apache-2.0
"""A test of verbs on a running bus: a domain, and processes that do not outlive it."""
import os
import subprocess
import tempfile

import lab_process
from lab_process import next_domain
from verb_case import FolderCase

LIMIT_S = 60.0
# As the profiles: loopback alone, and its multicast for discovery.
CYCLONE_URI = ("<CycloneDDS><Domain><General><Interfaces><NetworkInterface address='127.0.0.1' multicast='true'/>"
               "</Interfaces></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
               "<MaxAutoParticipantIndex>31</MaxAutoParticipantIndex><Peers><Peer Address='127.0.0.1'/></Peers>"
               "</Discovery></Domain></CycloneDDS>")


def wait_for(what, condition):
    return lab_process.wait_for(what, condition, LIMIT_S)


class Bus(FolderCase):
    ENVIRONMENT = {}

    def setUp(self):
        super().setUp()
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
