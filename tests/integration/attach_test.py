# SPDX-License-Identifier: Apache-2.0
"""`stillhand lab --attach`: conducts services that run already, as systemd starts them, session after session."""
import json
import os
import signal
import subprocess
import threading
import time

import lab_process
from lab_process import BUILD, INSPECT, SERVICES, SOURCE, TICKS_PER_S, TRIAL_LIMIT_S, LabTestCase, campaign, \
    next_domain, quick_session



class Units:
    """Every service but the experiment; each is restarted when it ends, as by a unit with Restart=always."""

    def __init__(self, folder, domain, config):
        self.folder, self.domain, self.config = folder, domain, config
        self.ending = threading.Event()
        self.keepers = [threading.Thread(target=self.keep, args=(service,)) for service in SERVICES]
        for keeper in self.keepers:
            keeper.start()

    def keep(self, service):
        started = 0
        while not self.ending.is_set():
            words = [str(BUILD / "bin" / f"stillhand-{service}"), "--domain", str(self.domain), "--profiles",
                     str(SOURCE / "qos" / "profiles.xml"), "--config", str(self.config), "--real-time", "--one-session"]
            if service == "recorder":
                words += ["--out", str(self.folder / f"{started}.mcap")]
            if service == "display":
                words += ["--headless"]
            started += 1
            with open(self.folder / f"{service}.log", "a", encoding="utf-8") as log:
                process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=log, stderr=log)
                while process.poll() is None and not self.ending.wait(0.05):
                    pass
                if process.poll() is None:
                    process.terminate()
                process.wait()
            self.ending.wait(1.0)  # RestartSec of apps/deploy/units.cpp

    def close(self):
        self.ending.set()
        for keeper in self.keepers:
            keeper.join()


def newest_tick(folder, since_s):
    """The rig's newest tick in the recordings written since a time; -1 before there is any."""
    files = [file for file in folder.glob("*.mcap") if file.stat().st_mtime > since_s]
    if not files:
        return -1
    newest = max(files, key=lambda file: file.stat().st_mtime)
    inspected = subprocess.run([str(INSPECT), str(newest), "1"], capture_output=True, text=True, check=False)
    return (json.loads(inspected.stdout)["rig"]["tick"] or [-1])[-1] if inspected.returncode == 0 else -1


class AttachTest(LabTestCase):
    def setUp(self):
        super().setUp()
        self.domain = next_domain()
        self.words = (*quick_session(self.folder / "config"), "--trial-seconds", 5)
        units = Units(self.folder, self.domain, self.folder / "config")
        self.addCleanup(units.close)

    def whole_session(self, out):
        """A completed session; returns its RMS error [mm]."""
        lab = self.lab(*self.words, "--attach", domain=self.domain, out=self.folder / out)
        self.assertEqual(lab.end_status(TRIAL_LIMIT_S), 0, lab.errors())
        summary = lab.summary()
        self.assertTrue(all(trial["completed"] for trial in summary["trials"]))
        self.assertEqual(summary["recording_damage"], [])
        # A sample clock of its own: nothing of the session before.
        self.assertEqual(lab.recording(10**9)["rig"]["tick"][0], 0)
        return summary["conditions"]["C"]["rms_error_mm"]["mean"]

    def broken_session(self):
        """A service that dies ends the session and is named."""
        started = time.time()
        lab = self.lab(*self.words, "--attach", domain=self.domain, out=self.folder / "broken")
        lab.wait_for("a second of its sample clock", lambda: newest_tick(self.folder, started) > TICKS_PER_S,
                     TRIAL_LIMIT_S, poll_s=0.3)
        os.kill(lab.pid_of("motion"), signal.SIGKILL)
        self.assertEqual(lab.end_status(), 1)
        self.assertIn("motion ended: its life sign is gone", " ".join(lab.errors()))

    def contested_session(self):
        """A stranger conducts the services first: the session is refused."""
        stranger = self.stranger(self.domain, "conducts", "a stranger")
        lab = self.lab(*self.words, "--attach", "--match-seconds", 6, domain=self.domain, out=self.folder / "contested")
        self.assertEqual(lab.end_status(TRIAL_LIMIT_S), 1)
        self.assertIn("two name the session's sources", " ".join(lab.errors()))
        stranger.kill()
        stranger.wait()

    def test_services_that_run_already_hold_a_whole_session_after_a_contested_and_a_broken_one(self):
        self.contested_session()
        self.broken_session()
        # It says from before the session to its end, as the recorder, which file is the recording: whole_session()
        # reads what the lab fetched.
        self.stranger(self.domain, "misleads", "a stranger")
        self.whole_session("second")

    @campaign
    def test_a_session_after_a_broken_one_gives_what_the_first_one_gave(self):
        first = self.whole_session("first")
        self.broken_session()
        self.assertAlmostEqual(self.whole_session("second"), first, delta=0.1 * first)


if __name__ == "__main__":
    lab_process.main()
