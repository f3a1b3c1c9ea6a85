# SPDX-License-Identifier: Apache-2.0
"""An emergency stop without a dashboard: `stillhand stop`, Escape on the tracking screen, a key of an input device.

Each prints the time from the command or the key to the first tick at which the rig's force is zero. By default the
verb stops a trial that cancels, and the two keys a pegged trial, which has no force; `--campaign` stops a trial that
cancels with each key.
"""
import http.client
import multiprocessing
import os
import selectors
import socket
import struct
import time

import lab_process
from dashboard_test import TOKEN, DashboardCase
from lab_process import TICKS_PER_S, TRIAL_LIMIT_S, campaign, quick_session, wait_for
from virtual_display import VirtualDisplay, missing_tools

FORCE_LIMIT_TICKS = 50  # the motor force ramps to zero within 40 ticks
EV_KEY, KEY_ENTER, PRESSED = 1, 28, 1
INPUT_EVENT = "llHHi"   # linux/input.h: seconds, microseconds, type, code, value
HOSTILE = 1000
CLICK_LIMIT_S, CLICK_AGAIN_S = 2.0, 0.25  # apps/dashboard/web/actions.js
STOP_KEY, ESCAPE = "the stop key", "Escape on the tracking screen"


def hostile_clients(port, ready):
    """HOSTILE connections to a dashboard, for ever: the one half asks for what is refused and never reads, the other half
    sends half a request. One that the dashboard closes comes back at once."""
    said = (b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n" * 500, b"POST /emergency-stop HTTP/1.1\r\n")
    everyone, came = selectors.DefaultSelector(), 0

    def come(kind):
        client = socket.socket()
        client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        client.setblocking(False)
        client.connect_ex(("127.0.0.1", port))
        everyone.register(client, selectors.EVENT_WRITE, kind)

    for i in range(HOSTILE):
        come(i % len(said))
    while True:
        for key, events in everyone.select():
            try:
                if events & selectors.EVENT_WRITE:
                    key.fileobj.send(said[key.data])
                    everyone.modify(key.fileobj, selectors.EVENT_READ, key.data)  # its end, or an answer that stays there
                    came += 1
                    if came == 20 * HOSTILE:
                        ready.set()
                elif key.data == 0 and key.fileobj.recv(1, socket.MSG_PEEK):
                    key.fileobj.send(said[key.data])
                else:
                    raise ConnectionResetError
            except BlockingIOError:
                pass
            except OSError:
                everyone.unregister(key.fileobj)
                key.fileobj.close()
                come(key.data)


class StopTest(DashboardCase):
    def assert_stopped(self, lab, since_ns, what, forced):
        """The session ended by an emergency stop, with its force at zero; prints when."""
        self.assertEqual(lab.end_status(), 1, lab.errors())
        self.assert_nothing_left(lab)
        self.assertIn(f"emergency stop, asked by {what}", lab.errors()[-1])
        recording = lab.recording(10**9)
        self.assertIn(["rig", "emergency stop"], recording["commands"])
        rig = recording["rig"]
        # The event carries the newest tick that the rig had published; it reports the one that it computes.
        zero = rig["tick"].index(recording["force_zero_ticks"][-1]) + 1
        force = rig["motor_force_n"]
        self.assertEqual([each for each in force[zero:] if each != 0.0], [])
        self.assertNotIn(True, rig["motor_permitted"][zero:])
        pressed = next(i for i, stamp_ns in enumerate(rig["stamp_ns"]) if stamp_ns >= since_ns)
        if forced:
            self.assertGreater(max(abs(each) for each in force[pressed - TICKS_PER_S:pressed]), 1.0)
        print(f"{what}: force zero after {(rig['stamp_ns'][zero] - since_ns) / 1e6:.0f} ms"
              f"{'' if forced else ' (there was none)'}", flush=True)

    def test_the_verb_stops_a_session_of_this_machine_and_does_not_say_whether_there_was_a_force(self):
        lab = self.lab(*quick_session(self.folder / "config"))
        lab.wait_for_tick(1, 1, TRIAL_LIMIT_S)
        since_ns = time.monotonic_ns()
        stopped = self.run_verb("stop", "--domain", lab.domain, timeout=30)
        self.assertRegex(stopped.stdout,
                         rf"^domain {lab.domain} rig 1: force zero \(\d+ ms to reach the rig\)\n$")
        print(stopped.stdout, end="", flush=True)
        self.assert_stopped(lab, since_ns, "stillhand stop", forced=True)

    @campaign
    def test_a_click_stops_the_motor_whatever_a_thousand_other_connections_send(self):
        lab = self.lab(*quick_session(self.folder / "config"))
        dashboard = self.dashboard("--domain", lab.domain, "--token-file", self.token_file())
        lab.wait_for_tick(1, 1, TRIAL_LIMIT_S)
        ready = multiprocessing.Event()
        hostile = multiprocessing.Process(target=hostile_clients, args=(dashboard.port, ready), daemon=True)
        hostile.start()
        self.addCleanup(hostile.kill)
        self.assertTrue(ready.wait(TRIAL_LIMIT_S))
        since_ns = time.monotonic_ns()
        wait_for("answer to a click", lambda: self.click(dashboard), 40 * CLICK_LIMIT_S, CLICK_AGAIN_S)
        print(f"answer after {(time.monotonic_ns() - since_ns) / 1e6:.0f} ms", flush=True)
        hostile.kill()
        dashboard.close()
        self.assert_stopped(lab, since_ns, f"dashboard on {socket.gethostname()}", forced=True)

    def click(self, dashboard):
        """As the page asks: with a time limit. True if it was accepted."""
        try:
            connection = http.client.HTTPConnection("127.0.0.1", dashboard.port, timeout=CLICK_LIMIT_S)
            connection.request("POST", "/emergency-stop", headers={"Authorization": "Bearer " + TOKEN})
            return connection.getresponse().status == 204
        except (OSError, http.client.HTTPException):
            return False
        finally:
            connection.close()

    def test_without_a_session_the_verb_fails_with_one_line(self):
        stopped = self.run_verb("stop", "--domain", lab_process.next_domain(), "--wait", 2, status=1, timeout=30)
        self.assertRegex(stopped.stdout, "^domain [0-9]+ rig 1: no rig answers\n$")

    def test_a_key_of_an_input_device(self):
        self.press(STOP_KEY, forced=False)

    def test_escape_on_the_tracking_screen(self):
        self.press(ESCAPE, forced=False)

    @campaign
    def test_a_key_of_an_input_device_ends_the_force(self):
        self.press(STOP_KEY, forced=True)

    @campaign
    def test_escape_on_the_tracking_screen_ends_the_force(self):
        self.press(ESCAPE, forced=True)

    def press(self, what, forced):
        if what == ESCAPE and missing_tools():
            self.skipTest(f"not installed: {missing_tools()}")
        device = self.folder / "device"
        os.mkfifo(device)
        pipe = os.open(device, os.O_RDWR)
        self.addCleanup(os.close, pipe)
        display = None
        if what == ESCAPE:
            display = VirtualDisplay()
            self.addCleanup(display.close)
        words = quick_session(self.folder / "config") if forced else ["--identify-seconds", 60]
        lab = self.lab(*words, "--stop-key", device, "--match-seconds", 60, headless=display is None,
                       environment=display and display.environment)
        lab.wait_for_tick(1 if forced else 0, 1, TRIAL_LIMIT_S)
        window = display and lab.wait_for("the window", lambda: display.window("Stillhand"), TRIAL_LIMIT_S)
        since_ns = time.monotonic_ns()
        if display:
            display.xdotool("windowfocus", "--sync", window, "key", "Escape")
        else:
            os.write(pipe, struct.pack(INPUT_EVENT, 0, 0, EV_KEY, KEY_ENTER, PRESSED))
        self.assert_stopped(lab, since_ns, what, forced)


if __name__ == "__main__":
    lab_process.main()
