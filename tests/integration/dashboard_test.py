# SPDX-License-Identifier: Apache-2.0
"""`stillhand dashboard` next to a session, and with requests that it refuses.

The page's counts must be those of the session's recording: the same numbers, counted by two listeners.
"""
import http.client
import json
import os
import re
import shutil
import socket
import subprocess
import tempfile

import lab_process
from lab_process import BUILD, SERVICES, SOURCE, STILLHAND, LabTestCase, next_domain, quick_session

PAGE = BUILD / "share" / "stillhand" / "dashboard" / "uPlot.esm.js"
LIMIT_S = 20.0
STREAMS = ("raw_sample", "sensed", "motor_command", "rig_truth", "platform_command", "tracking_sample",
           "operator_force")
TOKEN = "0123456789abcdef0123456789abcdef"
MOST_CONNECTIONS = 64
# A session does not wait for a dashboard, which may match its writers later than the recorder, by the 0.2 s that matching
# takes on loopback (qos/README.md), five times that on a busy machine.
MOST_TICKS_APART = 1000


class Dashboard:
    """One `stillhand dashboard` on a port of the system's choice."""

    def __init__(self, *words):
        self.errors = tempfile.TemporaryFile("w+")
        self.process = subprocess.Popen([str(STILLHAND), "dashboard", "--port", "0", *(str(word) for word in words)],
                                        stdout=subprocess.PIPE, stderr=self.errors, text=True)
        address = self.process.stdout.readline()
        told = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/\n", address)
        if told is None:
            self.process.wait()
            self.errors.seek(0)
            raise AssertionError(f"no address: {address!r} {self.errors.read()}")
        self.port = int(told[1])

    def ask(self, method, target, headers=None, body=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=LIMIT_S)
        try:
            connection.request(method, target, body, headers or {})
            answer = connection.getresponse()
            return answer.status, answer.read(), dict(answer.getheaders())
        finally:
            connection.close()

    def snapshot(self, **keywords):
        status, body, _ = self.ask("GET", "/snapshot", **keywords)
        assert status == 200, (status, body)
        return json.loads(body)

    def raw(self, request):
        """Bytes as they are; what comes back until the server closes, or b""."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=LIMIT_S) as client:
            try:
                client.sendall(request)
                parts = []
                while part := client.recv(65536):
                    parts.append(part)
            except ConnectionError:
                pass
            return b"".join(parts)

    def close(self):
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()
        self.errors.close()


def wait_for(what, condition):
    return lab_process.wait_for(what, condition, LIMIT_S)


def streams(snapshot):
    return {topic["topic"].removeprefix("stillhand/"): topic for topic in snapshot["topics"]
            if topic["topic"].removeprefix("stillhand/") in STREAMS}


def same_for_every_listener(topic):
    """The counts of a topic that do not depend on when its samples arrive."""
    return {name: topic[name] for name in ("samples", "lost", "not_sent", "first_tick", "last_tick")} | {
        "sent late": (topic["sent_late"]["count"], topic["sent_late"]["worst_us"])}


class DashboardCase(LabTestCase):
    def token_file(self):
        file = self.folder / "token"
        file.write_text(TOKEN + "\n")
        file.chmod(0o600)
        return file

    def dashboard(self, *words):
        dashboard = Dashboard(*words)
        self.addCleanup(dashboard.close)
        return dashboard

    def assert_counted_alike(self, pages, files):
        """Compares every topic of two listeners; returns the topics that are the same to the last sample.

        A listener counts each tick that it did not receive as lost. So samples and losses together are the same for both,
        except for the ticks that only one of them heard, before the other's first tick or after its last. A topic that
        both heard over the same ticks, and of which neither lost a sample on its way, is the same in every count.
        """
        same = []
        for name in STREAMS:
            page, file = pages[name], files[name]
            first, last = (file[tick] - page[tick] for tick in ("first_tick", "last_tick"))
            self.assertLess(max(abs(first), abs(last)), MOST_TICKS_APART, name)
            self.assertEqual(file["samples"] + file["lost"] + first - last, page["samples"] + page["lost"], name)
            if first == last == 0 and all(counted["lost"] == counted["not_sent"] for counted in (page, file)):
                self.assertEqual(same_for_every_listener(page), same_for_every_listener(file), name)
                same.append(name)
        return same


class SessionTest(DashboardCase):
    def test_the_page_counts_what_the_recording_holds_whatever_clients_do(self):
        domain = next_domain()
        dashboard = self.dashboard("--domain", domain)
        self.assertEqual(dashboard.snapshot()["session"]["state"], "none")
        lab = self.lab(*quick_session(self.folder / "config"), "--trial-seconds", 5, domain=domain)
        running = lab.wait_for("a session on the page", lambda: (
            seen := dashboard.snapshot(), seen["session"]["state"] == "running" and seen)[1], lab_process.TRIAL_LIMIT_S)
        self.assertTrue(running["session"]["blinded"])
        self.assertNotIn("condition", running["session"])
        lab.wait_for("every process on the page", lambda: all(
            "state" in service for service in dashboard.snapshot()["services"]), lab_process.MATCH_LIMIT_S)
        names = [service["service"] for service in dashboard.snapshot()["services"]]
        self.assertEqual(sorted(names), sorted([*SERVICES, "experiment"]))

        # Neither a client that never reads nor hundreds of connections hold anything up.
        mute = socket.create_connection(("127.0.0.1", dashboard.port))
        self.addCleanup(mute.close)
        mute.sendall(b"GET /events HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
        crowd = [socket.create_connection(("127.0.0.1", dashboard.port)) for _ in range(500)]
        descriptors = len(os.listdir(f"/proc/{dashboard.process.pid}/fd"))
        self.assertLess(descriptors, MOST_CONNECTIONS + 50)
        for each in crowd:
            each.close()

        def three_seconds_of_a_person():
            seen = dashboard.snapshot()
            session = seen["session"]
            return session.get("phase") == "tracking" and session["tick"] > session["start_tick"] + 3000 and seen
        tracking = lab.wait_for("three seconds of a person", three_seconds_of_a_person, lab_process.TRIAL_LIMIT_S)
        rows = [row for row, tick in enumerate(tracking["traces"]["tick"]) if tick >= tracking["session"]["start_tick"]]
        self.assertGreater(len(rows), 100)
        self.assertTrue(all(tracking["traces"]["predicted_force_n"][row] for row in rows))
        self.assertEqual({tracking["traces"]["motor_force_n"][row] for row in rows}, {None},
                         "a motor's force reveals the condition")

        self.assertEqual(lab.end_status(lab_process.TRIAL_LIMIT_S), 0, lab.errors())
        over = wait_for("end of the session", lambda: (
            seen := dashboard.snapshot(), seen["session"]["state"] == "ending" and seen)[1])
        self.assertEqual(over["dashboard"]["dropped"], 0)
        recorded = self.dashboard("--recording", lab.out / "session.mcap").snapshot()
        ours, theirs = streams(over), streams(recorded)
        self.assertEqual(set(ours), set(STREAMS))
        same = self.assert_counted_alike(ours, theirs)
        if {"sensed", "motor_command", "rig_truth"} <= set(same):
            self.assertEqual(over["chain"], recorded["chain"])
        def lost(snapshot):
            return {topic["topic"]: topic["lost"] for topic in snapshot["topics"] if topic["lost"]}
        print(f"{len(same)} of {len(STREAMS)} topics the same to the last sample, lost by the recorder {lost(recorded)}, "
              f"by the page {lost(over)}; the page took {100 * over['dashboard']['cpu_share']:.1f} % of a core")


class RequestsTest(DashboardCase):
    def test_odd_requests_are_refused_and_the_next_is_answered(self):
        dashboard = self.dashboard("--domain", next_domain())
        head = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n"
        for request, want in ((head + b"X: " + b"a" * 9000 + b"\r\n\r\n", b"431"),
                              (b"POST /acknowledge HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100000\r\n\r\n", b"413"),
                              (b"\x00\xff\x16\x03\x01" * 20 + b"\r\n\r\n", b"400"),
                              (b"GET / HTTP/9.9\r\n\r\n", b"400"),
                              (b"GET / HTTP/1.1\r\nHost: evil.example\r\nConnection: close\r\n\r\n", b"403"),
                              (b"GET /../../etc/passwd HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n", b"404"),
                              (b"GET /%2e%2e/qos/profiles.xml HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n", b"404"),
                              (b"DELETE / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n", b"405")):
            with self.subTest(request[:60]):
                self.assertEqual(dashboard.raw(request).split(b" ")[1][:3], want)
        status, body, headers = dashboard.ask("GET", "/")
        self.assertEqual(status, 200)
        self.assertIn(b"<title>Stillhand dashboard</title>", body)
        self.assertIn("default-src 'none'", headers["Content-Security-Policy"])
        self.assertNotIn("unsafe", headers["Content-Security-Policy"])
        self.assertEqual(dashboard.ask("POST", "/acknowledge", {"Origin": "http://evil.example"})[0], 403)
        self.assertEqual(dashboard.ask("POST", "/acknowledge")[0], 204)

    def test_every_file_that_the_page_names_is_there(self):
        dashboard = self.dashboard("--domain", next_domain())
        seen, waiting = set(), {"/"}
        while waiting:
            path = waiting.pop()
            seen.add(path)
            status, body, _ = dashboard.ask("GET", path)
            self.assertEqual(status, 200, path)
            if path != "/uPlot.esm.js":
                waiting |= set(re.findall(r'(?:src="|href="|from ")(/[^"]*)"', body.decode())) - seen
        self.assertGreaterEqual(len(seen), 8, seen)

    def test_the_token_opens_and_nothing_else(self):
        dashboard = self.dashboard("--domain", next_domain(), "--token-file", self.token_file())
        for headers in ({}, {"Authorization": "Bearer " + TOKEN[:-1] + "x"}, {"Authorization": "Bearer " + "a" * 7000},
                        {"Cookie": f"stillhand_token_{dashboard.port}=" + TOKEN[:-1]}, {"Authorization": "Basic " + TOKEN}):
            self.assertEqual(dashboard.ask("GET", "/snapshot", headers)[0], 403, headers)
        self.assertEqual(dashboard.ask("GET", "/snapshot", {"Authorization": "Bearer " + TOKEN})[0], 200)
        self.assertEqual(dashboard.ask("GET", "/?token=wrong")[0], 403)
        status, _, headers = dashboard.ask("GET", "/?token=" + TOKEN)
        self.assertEqual((status, headers["Location"]), (303, "/"))
        self.assertIn("HttpOnly", headers["Set-Cookie"])
        self.assertTrue(headers["Set-Cookie"].startswith(f"stillhand_token_{dashboard.port}="), headers["Set-Cookie"])
        self.assertEqual(dashboard.ask("GET", "/", {"Cookie": headers["Set-Cookie"].split(";")[0]})[0], 200)

    def test_a_client_that_never_reads_is_dropped_and_others_go_on(self):
        dashboard = self.dashboard("--domain", next_domain())
        mute = socket.socket()
        mute.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        mute.connect(("127.0.0.1", dashboard.port))
        self.addCleanup(mute.close)
        mute.sendall(b"GET /events HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
        wait_for("listener", lambda: dashboard.snapshot()["dashboard"]["clients"] == 1)
        reading = http.client.HTTPConnection("127.0.0.1", dashboard.port, timeout=LIMIT_S)
        self.addCleanup(reading.close)
        reading.request("GET", "/events")
        stream = reading.getresponse()
        self.assertEqual(stream.getheader("Content-Type"), "text/event-stream")

        def left_alone():
            self.assertTrue(json.loads(stream.readline().removeprefix(b"data: ")))
            self.assertEqual(stream.readline(), b"\n")
            return dashboard.snapshot()["dashboard"]["clients"] == 1
        wait_for("end of the client that never reads", left_alone)

    def test_wrong_options_are_refused_in_one_line(self):
        file = self.folder / "token"
        file.write_text("short")
        file.chmod(0o600)
        broken = self.folder / "config"
        shutil.copytree(SOURCE / "deploy" / "config", broken)
        (broken / "dashboard.yaml").write_text("late_warning_ms: 9\n")
        taken = socket.socket()
        self.addCleanup(taken.close)
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        for words, want in ((("--bind", "0.0.0.0"), "--token-file"), (("--bind", "nowhere"), "--bind: got nowhere"),
                            (("--token-file", file), "16 to 256"), (("--port", "70000"), "--port"),
                            (("--port", taken.getsockname()[1]), "--port: got 127.0.0.1"),
                            (("--config", broken), "dashboard.late_warning_ms: got 9, want at most 3.5"),
                            (("--recording", self.folder / "none.mcap"), "none.mcap")):
            with self.subTest(words):
                self.refused_for(want, "dashboard", *words, timeout=LIMIT_S)


def main():
    if STILLHAND.is_file() and not PAGE.is_file():
        lab_process.skip("npm installed no page")
    lab_process.main()


if __name__ == "__main__":
    main()
