# SPDX-License-Identifier: Apache-2.0
"""A service as systemd starts it: its life sign feeds the watchdog, and stops when the service hangs."""
import os
import signal
import socket
import subprocess

import lab_process
from lab_process import BUILD, SOURCE, next_domain
from verb_case import FolderCase

FIRST_LIMIT_S = 20.0
WATCHDOG_S = 2.0  # apps/deploy/units.cpp


class WatchdogTest(FolderCase):
    def setUp(self):
        super().setUp()
        self.systemd = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.addCleanup(self.systemd.close)
        path = str(self.folder / "notify")
        self.systemd.bind(path)
        self.service = subprocess.Popen(
            [str(BUILD / "bin" / "stillhand-sensing"), "--domain", str(next_domain()), "--profiles",
             str(SOURCE / "qos" / "profiles.xml"), "--config", str(SOURCE / "deploy" / "config")],
            env=dict(os.environ, NOTIFY_SOCKET=path))
        self.addCleanup(self.end)

    def end(self):
        self.service.kill()
        self.service.wait()

    def next_sign(self, limit_s):
        """The next datagram, or nothing within the limit."""
        self.systemd.settimeout(limit_s)
        try:
            return self.systemd.recv(256)
        except TimeoutError:
            return None

    def test_a_service_that_hangs_feeds_the_watchdog_no_more(self):
        self.assertEqual(self.next_sign(FIRST_LIMIT_S), b"WATCHDOG=1")
        for _ in range(20):
            self.assertEqual(self.next_sign(WATCHDOG_S), b"WATCHDOG=1")
        self.service.send_signal(signal.SIGSTOP)
        os.waitid(os.P_PID, self.service.pid, os.WSTOPPED | os.WNOWAIT)
        self.systemd.setblocking(False)
        try:
            while self.systemd.recv(256):
                pass
        except BlockingIOError:  # what it had sent before
            pass
        self.assertIsNone(self.next_sign(WATCHDOG_S))
        self.service.send_signal(signal.SIGCONT)
        self.assertEqual(self.next_sign(WATCHDOG_S), b"WATCHDOG=1")


if __name__ == "__main__":
    lab_process.main()
