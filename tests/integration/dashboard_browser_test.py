# SPDX-License-Identifier: Apache-2.0
"""The page of `stillhand dashboard` in a real Chromium, next to a real session and with its recording.

With STILLHAND_SCREENSHOTS=FOLDER the test leaves pictures of every state, size and colour there.
"""
import bisect
import contextlib
import http.server
import os
import pathlib
import re
import signal
import socket
import threading
import time

import browser
import lab_process
from dashboard_test import PAGE, TOKEN, DashboardCase, streams, wait_for
from lab_process import BUILD, STILLHAND, TICKS_PER_S, TRIAL_LIMIT_S, hold, next_domain, quick_session

AXE = BUILD / "apps" / "dashboard" / "web" / "node_modules" / "axe-core" / "axe.min.js"
# A person sees a miss within 1 s: ten snapshots of the page. Milliseconds are printed only, for the machine may be busy.
SHOWN_WITHIN_SNAPSHOTS = 10
DELAY_MS = 20
ESCAPE = "\ue00c"
HOST = socket.gethostname()
OTHER_MISSES = "the machine's own misses of sensing, acknowledged before the delay:"


def now_ms():
    return time.time() * 1000


def named(text):
    """An alarm that a delay of sensing raises."""
    return re.search(rf"sensed \(sensing on {re.escape(HOST)}\) (sent late|lost)", text)


class BrowserCase(DashboardCase):
    def open(self, dashboard, query=""):
        page = browser.Browser(f"http://127.0.0.1:{dashboard.port}/{query}")
        self.addCleanup(page.close)
        return page

    def beside_a_lab(self, *words):
        domain = next_domain()
        dashboard = self.dashboard("--domain", domain)
        page = self.open(dashboard)
        wait_for("a page that knows of no session", lambda: "No session" in page.text("word"))
        return dashboard, page, self.lab(*quick_session(self.folder / "config"), *words, domain=domain)

    def assert_keeps_to_itself(self, page, dashboard):
        page.gather()
        self.assertEqual(page.errors, [])
        self.assertEqual([url for url in page.requests
                          if not url.startswith((f"http://127.0.0.1:{dashboard.port}/", "data:"))], [])

    def assert_accessible(self, page, state):
        for dark in (False, True):
            page.resize("laptop", dark)
            found = page.findings(AXE.read_text())
            self.assertEqual(found, [], f"{state}, {'dark' if dark else 'light'}")
        page.resize("laptop")

    def assert_fits(self, page, state):
        for size in browser.SIZES:
            page.resize(size)
            self.assertLessEqual(page.overflows(), 0, f"{state} on a {size}")
        page.resize("laptop")

    def assert_everything_is_reached_by_tab(self, page):
        there = set(page.operable())
        places = page.walk()
        there &= set(page.operable())  # a loaded machine's event brings and takes a button meanwhile
        self.assertEqual([place["name"] for place in places if not place["shown"]], [], "focus is not to be seen")
        self.assertEqual(there - {place["name"] for place in places}, set(), "not reached by Tab")

    def shows(self, page, since_ms, shown, what):
        """How long it took until the page showed it [ms]."""
        at_ms = wait_for(what, lambda: page.first_seen(since_ms, shown))
        self.assertLessEqual(page.drawn_between(since_ms, at_ms), SHOWN_WITHIN_SNAPSHOTS, what)
        return at_ms - since_ms


class SessionTest(BrowserCase):
    def test_a_session_is_watched_and_ended_by_one_key(self):
        dashboard, page, lab = self.beside_a_lab("--trial-seconds", 240)
        lab.wait_for("a person's third second on the page", lambda: self.tracking(dashboard), TRIAL_LIMIT_S)
        self.assertRegex(page.text("session"), r"phase\s+tracking")
        self.assertIn("hidden", page.text("session"))
        self.assertRegex(page.text("protocol"), r"trial 1 of 1\s*runs, left \d:\d\d")
        self.assert_everything_moves(page, lab)
        page.keep("running")
        self.assert_fits(page, "running")
        self.assert_accessible(page, "running")
        self.assert_everything_is_reached_by_tab(page)
        since_ms = self.delayed(page, lab, dashboard)
        self.acknowledged(lab, page, since_ms, lambda: page.press("a"))

        page.click("[data-ask='/session/pause']")  # before the next trial
        page.click("[data-ask='/session/stop']")
        lab.wait_for("a pause", lambda: dashboard.snapshot()["session"]["paused"], TRIAL_LIMIT_S)
        page.click("[data-ask='/session/start']")
        lab.wait_for("the trial once more", lambda: self.tracking(dashboard), TRIAL_LIMIT_S)

        tick = dashboard.snapshot()["session"]["tick"]
        asked_ms = now_ms()
        page.press(ESCAPE)
        took_ms = self.shows(page, asked_ms, lambda text: re.search(r"Emergency stop\s+the motor", text),
                             "the emergency stop")
        page.keep("emergency")
        self.assert_accessible(page, "emergency stop")
        self.assertEqual(lab.end_status(TRIAL_LIMIT_S), 1, lab.errors())
        self.assert_no_force_behind(lab, tick, took_ms)
        self.assert_keeps_to_itself(page, dashboard)
        page.close()
        self.watch_the_recording(lab.out / "session.mcap", dashboard.snapshot())

    def tracking(self, dashboard):
        session = dashboard.snapshot()["session"]
        return session.get("phase") == "tracking" and session["tick"] > session["start_tick"] + 3 * TICKS_PER_S

    def assert_everything_moves(self, page, lab):
        def numbers():
            return re.findall(r"[\d.]+", page.text("topics"))
        pictures, counts = page.pictures(), numbers()
        self.assertGreaterEqual(len(pictures), 4)
        lab.wait_for("another picture of each chart", lambda: all(
            old != new for old, new in zip(pictures, page.pictures())), TRIAL_LIMIT_S)
        lab.wait_for("other counts", lambda: numbers() != counts, TRIAL_LIMIT_S)

    def delayed(self, page, lab, dashboard):
        """Holds sensing up by 20 ms: more than its readers keep for it, so it is late or loses."""
        acknowledged = []

        def quiet():
            """Nothing named of sensing; a miss of the machine's own is acknowledged."""
            if shown := named(page.text("strip") + page.text("alarms")):
                acknowledged.append(shown[0])
                dashboard.ask("POST", "/acknowledge")
            return not shown
        lab.wait_for("a page that names no miss of sensing", quiet, TRIAL_LIMIT_S)
        print(OTHER_MISSES, len(acknowledged), flush=True)
        pid = lab.pid_of("sensing")
        since_ms = now_ms()
        os.kill(pid, signal.SIGSTOP)
        hold(DELAY_MS / 1000)
        os.kill(pid, signal.SIGCONT)
        took_ms = self.shows(page, since_ms, named, "the delay")
        print(f"{DELAY_MS} ms of delay in sensing shown {took_ms:.0f} ms after its beginning")
        return since_ms

    def acknowledged(self, lab, page, since_ms, acknowledge):
        """One acknowledgement: the page then shows every alarm of sensing's delay as acknowledged, or none of them.

        A miss of the machine's own may raise the alarm again; what the page showed before that counts.
        """
        def raised(alarms):
            return [text for text in alarms if named(text) and "acknowledged" not in text]
        # Not one of before, which was acknowledged: there would be nothing for the key to do yet.
        lab.wait_for("the alarm in the list", lambda: page.first_alarms_seen(since_ms, raised), TRIAL_LIMIT_S)
        asked_ms = now_ms()
        acknowledge()
        try:
            lab.wait_for("an acknowledgement", lambda: page.first_alarms_seen(
                asked_ms, lambda alarms: not raised(alarms)), TRIAL_LIMIT_S)
        except AssertionError as error:
            shown = {place: page.text(place) for place in ("answer", "alarms")}
            raise AssertionError(f"{error}; the page: {shown}") from error
        self.assertRegex(page.text("answer"), "Acknowledge: asked at")

    def assert_no_force_behind(self, lab, tick, took_ms):
        recording = lab.recording(10**9, "signals")
        rig = recording["rig"]
        stopped, zero = self.assert_force_ends(rig, bisect.bisect_right(rig["tick"], tick))
        self.assertIn(["rig", "emergency stop"], recording["commands"])
        print(f"emergency stop shown after {took_ms:.0f} ms; from the rig's word on {rig['tick'][zero] - rig['tick'][stopped]} ms to no force")

    def watch_the_recording(self, file, live):
        dashboard = self.dashboard("--recording", file)
        page = self.open(dashboard)
        wait_for("the time line", lambda: not page.run("return document.getElementById('timeline-part').hidden"))
        wait_for("its topics", lambda: "sensed" in page.text("topics"))
        self.assertFalse(page.run("return !document.getElementById('emergency').hidden"))
        self.assert_everything_is_reached_by_tab(page)  # from the page's beginning: nothing was focused yet
        before = page.text("when")
        page.run("document.getElementById('instant').focus()")
        page.press("\ue012")  # an instant back
        wait_for("another instant", lambda: page.text("when") != before)
        self.assert_fits(page, "recording")
        page.keep("recording")
        self.assert_accessible(page, "recording")
        self.assert_keeps_to_itself(page, dashboard)
        recorded, live = streams(dashboard.snapshot()), streams(live)
        self.assertEqual(set(recorded), set(live))
        same = self.assert_counted_alike(live, recorded)
        print(f"{len(same)} of {len(recorded)} topics counted alike to the last sample by the page that watched and the page of "
              "the recording")


class StoppedProcessTest(BrowserCase):
    def test_a_stopped_process_is_named_and_acknowledged_by_the_button(self):
        dashboard, page, lab = self.beside_a_lab()
        lab.wait_for("samples behind the grace", lambda: dashboard.snapshot()["session"]["tick"] > 3 * TICKS_PER_S,
                     TRIAL_LIMIT_S)
        pid = lab.pid_of("sensing")
        since_ms = now_ms()
        os.kill(pid, signal.SIGSTOP)
        try:
            took_ms = self.shows(page, since_ms, lambda text: f"sensed (sensing on {HOST}) silent" in text, "a stopped process")
            page.keep("alarm")
            self.assert_accessible(page, "alarm")
            self.assert_fits(page, "alarm")
        finally:
            with contextlib.suppress(ProcessLookupError):  # the session may have ended it
                os.kill(pid, signal.SIGKILL)
        print(f"a stopped process shown after {took_ms:.0f} ms")
        lab.end_status(TRIAL_LIMIT_S)
        wait_for("end of the session", lambda: dashboard.snapshot()["session"]["state"] == "ending")
        self.assertIn("sensing", page.text("alarms"))  # it stays
        page.click("#acknowledge")
        wait_for("no alarm", lambda: (page.text("word"), page.text("alarms")) == ("Session over", "none"))
        self.assert_keeps_to_itself(page, dashboard)


class Refusal(http.server.BaseHTTPRequestHandler):
    """A dashboard that was restarted with another token."""

    def do_GET(self):
        self.send_error(403)

    def log_message(self, *_):
        pass


class SignedOutTest(BrowserCase):
    def test_a_client_that_is_signed_out_is_shown_what_to_do(self):
        dashboard = self.dashboard("--domain", next_domain(), "--token-file", self.token_file())
        page = self.open(dashboard, f"?token={TOKEN}")
        wait_for("its word", lambda: "No session" in page.text("word"))
        page.driver.delete_all_cookies()
        page.press(ESCAPE)
        wait_for("what became of the emergency stop", lambda: re.search(
            r"NOT DELIVERED \(signed out: open this page again with \?token=", page.text("answer")))
        dashboard.process.kill()
        dashboard.process.wait()
        with http.server.ThreadingHTTPServer(("127.0.0.1", dashboard.port), Refusal) as other:
            threading.Thread(target=other.serve_forever, daemon=True).start()
            try:
                wait_for("the strip's word", lambda: page.text("word") == "Signed out")
                self.assertIn("?token=", page.text("what"))
            finally:
                other.shutdown()


if __name__ == "__main__":
    why = browser.missing() or ("npm installed no page" if not PAGE.is_file() else "") or (
        "npm installed no axe-core" if not pathlib.Path(AXE).is_file() else "")
    if STILLHAND.is_file() and why:
        lab_process.skip(why)
    lab_process.main()
