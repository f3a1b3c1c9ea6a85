# SPDX-License-Identifier: Apache-2.0
"""The requests that a dashboard sends to a running session: start, pause and stop of a trial, an emergency stop.

The page's buttons send these requests (tests/integration/dashboard_browser_test.py); this test shows their effect.
"""
import bisect
import subprocess
import time

import lab_process
from dashboard_test import DashboardCase, main, wait_for
from lab_process import TICKS_PER_S, TRIAL_LIMIT_S, next_domain, quick_session

REQUESTS_PER_S = 10  # and no more reach the bus


class SessionCommandTest(DashboardCase):
    def next_to_a_lab(self, *words):
        domain = next_domain()
        dashboard = self.dashboard("--domain", domain)
        return dashboard, self.lab(*quick_session(self.folder / "config"), *words, domain=domain)

    def asked(self, dashboard, path):
        status, answer, _ = dashboard.ask("POST", path)
        self.assertEqual(status, 204, answer)

    def test_trials_wait_for_a_start_run_again_after_a_stop_and_end_at_an_emergency_stop(self):
        dashboard, lab = self.next_to_a_lab("--trial-seconds", 20, "--wait-for-start")

        def paused():
            return lab.wait_for("a pause", lambda: dashboard.snapshot()["session"]["paused"], TRIAL_LIMIT_S)

        def trial(number):
            def measured():
                session = dashboard.snapshot()["session"]
                return session.get("trial") == number and session["tick"] > session["start_tick"] + TICKS_PER_S
            lab.wait_for(f"a second of trial {number}", measured, TRIAL_LIMIT_S)
            return dashboard.snapshot()["session"]["tick"]

        paused()
        self.asked(dashboard, "/session/start")
        trial(0)
        paused()
        self.asked(dashboard, "/session/start")
        trial(1)
        self.asked(dashboard, "/session/stop")
        paused()
        stood = dashboard.snapshot()["session"]["tick"]
        lab.wait_for("the platform's rest", lambda: lab.recording(1)["rig"]["tick"][-1] > stood + 2 * TICKS_PER_S,
                     TRIAL_LIMIT_S)
        self.asked(dashboard, "/session/start")
        again = trial(2)
        self.asked(dashboard, "/emergency-stop")
        self.assertEqual(lab.end_status(), 1, lab.errors())
        self.assertTrue(dashboard.snapshot()["session"]["emergency"])
        self.assertRegex(lab.errors()[-1], "trial 2, C, does not count: emergency stop, asked by dashboard on ")
        trials = lab.summary()["trials"]
        self.assertEqual([(each["number"], each["condition"], each["completed"]) for each in trials],
                         [(0, "I", True), (1, "C", False), (2, "C", False)])
        self.assertRegex(trials[1]["aborted"], "^stopped, asked by dashboard on ")
        recording = lab.recording(10**9, "signals")
        requests = [text for source, text in recording["commands"] if source == "experiment"]
        self.assertEqual([text.split(",")[0] for text in requests], ["start", "start", "stop", "start", "emergency stop"])
        self.assertIn(["rig", "emergency stop"], recording["commands"])
        self.assert_force_ends(recording["rig"], bisect.bisect_right(recording["rig"]["tick"], again))
        # From the stop on there is no force, and the platform comes to rest in the middle.
        rig = recording["rig"]
        during = range(rig["tick"].index(stood), rig["tick"].index(stood + TICKS_PER_S))
        self.assertGreater(max(abs(rig["motor_force_n"][i]) for i in range(during.start)), 1.0)
        self.assertEqual({rig["motor_force_n"][i] for i in during}, {0.0})
        commands = {tick: position_m for tick, position_m, *_ in recording["signals"]["command"]}
        self.assertLess(abs(commands[stood + 2 * TICKS_PER_S]), 1e-6)

    def test_a_request_that_no_process_listens_to_is_refused(self):
        dashboard = self.dashboard("--domain", next_domain())
        # The dashboard hears its own messages; its own reader does not count as one that listens.
        wait_for("its own word", lambda: dashboard.ask("POST", "/acknowledge") and any(
            topic["topic"] == "stillhand/session_command" and topic["samples"] > 0
            for topic in dashboard.snapshot()["topics"]))
        for path in ("/session/start", "/session/stop", "/emergency-stop", "/recorder/pause"):
            status, answer, _ = dashboard.ask("POST", path)
            self.assertEqual(status, 409, path)
            self.assertIn(b": no ", answer)
        onlooker = self.dashboard("--domain", next_domain(), "--read-only")
        self.assertFalse(onlooker.snapshot()["actions"]["enabled"])
        self.assertEqual(onlooker.ask("POST", "/emergency-stop")[0], 409)

    def test_a_storm_of_requests_is_refused_and_an_emergency_stop_is_not(self):
        dashboard = self.dashboard("--domain", next_domain())
        head = b"POST %s HTTP/1.1\r\nHost: 127.0.0.1\r\n"
        began = time.monotonic()
        answers = dashboard.raw((head + b"\r\n") % b"/acknowledge" * 200 +
                                (head + b"Connection: close\r\n\r\n") % b"/emergency-stop")
        done, refused = answers.count(b"HTTP/1.1 204"), answers.count(b"HTTP/1.1 429")
        self.assertEqual(done + refused, 200)
        self.assertGreater(done, 0)
        self.assertLessEqual(done, REQUESTS_PER_S * (1 + time.monotonic() - began))
        self.assertEqual(answers.count(b"HTTP/1.1 409"), 1, "the emergency stop, which no rig heard")

    def recorder(self, domain, file):
        recorder = subprocess.Popen([str(lab_process.STILLHAND), "record", "--domain", str(domain), "--out",
                                     str(self.folder / file)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(recorder.kill)
        return recorder

    def test_a_recorder_obeys_and_the_page_shows_it(self):
        domain = next_domain()
        dashboard = self.dashboard("--domain", domain)
        recorder = self.recorder(domain, "first.mcap")

        def recorders():
            return dashboard.snapshot()["recorders"]
        self.assertFalse(wait_for("a recorder", recorders)[0]["paused"])
        wait_for("a recorder that listens", lambda: dashboard.ask("POST", "/recorder/pause")[0] == 204)
        wait_for("its pause", lambda: recorders()[0]["paused"])
        self.asked(dashboard, "/recorder/resume")
        wait_for("its end", lambda: not recorders()[0]["paused"])
        first = recorders()[0]["name"]
        self.asked(dashboard, "/recorder/stop")
        self.assertEqual(recorder.wait(timeout=20), 0)

        # The next recorder does not act on the first one's requests. It records at least its own status, ten times a second.
        recorder = self.recorder(domain, "next.mcap")
        wait_for("two seconds of the next", lambda: any(
            each["received"] > 20 and not each["paused"] for each in recorders() if each["name"] != first))
        self.assertIsNone(recorder.poll())
        self.asked(dashboard, "/recorder/stop")
        self.assertEqual(recorder.wait(timeout=20), 0)


if __name__ == "__main__":
    main()
