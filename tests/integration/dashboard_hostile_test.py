# SPDX-License-Identifier: Apache-2.0
"""`stillhand dashboard` with hostile clients. With `--campaign` also next to a session that they must not disturb."""
import errno
import http.client
import os
import pathlib
import resource
import signal
import socket
import threading
import time

from dashboard_test import LIMIT_S, TOKEN, DashboardCase, main, streams, wait_for
from lab_process import TICKS_PER_S, TRIAL_LIMIT_S, campaign, hold, next_domain, quick_session

CONNECTIONS = 10000
MOST_CONNECTIONS = 64
MOST_LISTENERS = 48
MOST_GROWTH_KB = 64 * 1024  # of the dashboard's memory: 64 clients' buffers of 0.3 MB, and what it keeps of a session
REQUEST_LIMIT_S = 10.0      # the server's, for one request
HEAD = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n"
TRAVERSALS = ("/../etc/passwd", "/../../../../../../etc/passwd", "//etc/passwd", "/./../etc/passwd", "/..;/etc/passwd",
              "/%2e%2e/%2e%2e/etc/passwd", "/%2e%2e%2f%2e%2e%2fetc%2fpasswd", "/%252e%252e%252fetc%252fpasswd",
              "/..%c0%af..%c0%afetc/passwd", "/..%ef%bc%8fetc/passwd", "/..\\..\\etc\\passwd", "/%5c..%5c..%5cetc%5cpasswd",
              "/main.js/../../../../etc/passwd", "/main.js%00.html", "/etc/passwd", "file:///etc/passwd",
              "http://127.0.0.1/etc/passwd", "/uPlot.LICENSE", "/proc/self/environ", "/.", "/..", "/~root", "*")
MALFORMED = (b"\r\n\r\n", b"GET\r\n\r\n", b"GET  HTTP/1.1\r\n\r\n", b"GET / HTTP/1.1\n\n\n", b"GET / HTTP/1.1 HTTP/1.1\r\n\r\n",
             b"G\x00T / HTTP/1.1\r\n\r\n", b"GET /\x00 HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", b"GET / HTTP/2.0\r\n\r\n",
             b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", b"GET / HTTP/1.1\r\nHost 127.0.0.1\r\n\r\n", HEAD + b": x\r\n\r\n",
             HEAD + b"Content-Length: -1\r\n\r\n", HEAD + b"Content-Length: 99999999999999999999\r\n\r\n",
             HEAD + b"Content-Length: 3\r\nContent-Length: 4\r\n\r\nabcd", HEAD + b"Transfer-Encoding: chunked\r\n\r\nffffffffffffffff\r\n",
             HEAD + b"Transfer-Encoding: gzip, chunked\r\nContent-Length: 4\r\n\r\n", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" * 8 + b"\r\n\r\n")


def memory_kb(pid):
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0])


def descriptors(pid):
    return len(os.listdir(f"/proc/{pid}/fd"))


class Honest(threading.Thread):
    """Asks for a snapshot, again and again, and counts the answers."""

    def __init__(self, dashboard):
        super().__init__(daemon=True)
        self.dashboard, self.over = dashboard, threading.Event()
        self.asked = self.answered = 0

    def run(self):
        while not self.over.is_set():
            self.asked += 1
            try:
                self.answered += self.dashboard.ask("GET", "/snapshot")[0] == 200
            except (OSError, http.client.HTTPException):
                pass
            self.over.wait(0.05)

    def stop(self):
        self.over.set()
        self.join()


class ClientsCase(DashboardCase):
    def connected(self, dashboard, said=b""):
        client = socket.create_connection(("127.0.0.1", dashboard.port), timeout=LIMIT_S)
        self.addCleanup(client.close)
        client.sendall(said)
        return client

    def say_at_once(self, dashboard, clients, request):
        """Sends to all at the same instant: the dashboard is stopped meanwhile and finds every request."""
        os.kill(dashboard.process.pid, signal.SIGSTOP)
        try:
            for client in clients:
                client.sendall(request)
        finally:
            os.kill(dashboard.process.pid, signal.SIGCONT)

    def status_of(self, client):
        """The status of its answer; b"" without one."""
        try:
            return client.recv(12).removeprefix(b"HTTP/1.1 ")
        except ConnectionError:
            return b""


class CrowdTest(ClientsCase):
    def test_streams_asked_for_at_once_leave_room_for_an_emergency_stop(self):
        dashboard = self.dashboard("--domain", next_domain())
        without = descriptors(dashboard.process.pid)
        crowd = [self.connected(dashboard) for _ in range(MOST_CONNECTIONS)]
        wait_for("a place for each", lambda: descriptors(dashboard.process.pid) >= without + MOST_CONNECTIONS)
        self.say_at_once(dashboard, crowd, b"GET /events HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
        answers = [self.status_of(client) for client in crowd]
        self.assertEqual((answers.count(b"200"), answers.count(b"503")), (MOST_LISTENERS, MOST_CONNECTIONS - MOST_LISTENERS))
        self.assertEqual(dashboard.ask("POST", "/emergency-stop")[0], 409)  # an answer: no rig is there

    def test_a_refused_client_that_stays_takes_no_place(self):
        dashboard = self.dashboard("--domain", next_domain(), "--token-file", self.token_file())
        head = b"POST /emergency-stop HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n"
        strangers = [self.connected(dashboard, head + b"\r\n") for _ in range(MOST_CONNECTIONS)]
        self.assertEqual({self.status_of(client) for client in strangers}, {b"403"})
        own = [self.connected(dashboard) for _ in range(MOST_CONNECTIONS)]
        self.say_at_once(dashboard, own, head + b"Authorization: Bearer " + TOKEN.encode() + b"\r\n\r\n")
        self.assertEqual({self.status_of(client) for client in own}, {b"409"})


class HostileClientsTest(ClientsCase):
    @campaign
    def test_a_session_runs_on_whatever_clients_do(self):
        domain = next_domain()
        dashboard = self.dashboard("--domain", domain)
        lab = self.lab(*quick_session(self.folder / "config"), "--trial-seconds", 10, domain=domain)
        lab.wait_for("a session on the page", lambda: dashboard.snapshot()["session"]["tick"] > TICKS_PER_S, TRIAL_LIMIT_S)
        pid = dashboard.process.pid
        before_kb = memory_kb(pid)
        slow = self.slow_ones(dashboard)
        for attack in (self.traverse, self.say_nonsense, self.pipeline, self.never_read, self.flood):
            with self.subTest(attack.__name__):
                attack(dashboard)
                self.assertEqual(dashboard.ask("GET", "/")[0], 200)
        wait_for("the end of the slow clients", lambda: all(self.is_closed(each) for each in slow))
        self.assertEqual(lab.end_status(TRIAL_LIMIT_S), 0, lab.errors())
        over = wait_for("end of the session", lambda: (
            seen := dashboard.snapshot(), seen["session"]["state"] == "ending" and seen)[1])
        self.assertEqual(over["dashboard"]["dropped"], 0)
        growth_kb = memory_kb(pid) - before_kb
        self.assertLess(growth_kb, MOST_GROWTH_KB)
        recorded = streams(self.dashboard("--recording", lab.out / "session.mcap").snapshot())
        lost = {name: topic["lost"] - topic["not_sent"] for name, topic in recorded.items()}
        print(f"lost on the way to the recorder: {sum(lost.values())} of {sum(topic['samples'] for topic in recorded.values())}; "
              f"the dashboard grew by {growth_kb / 1024:.1f} MB")
        self.assertEqual(set(lost.values()), {0}, lost)

    def is_closed(self, client):
        client.setblocking(False)
        try:
            return client.recv(65536) == b""
        except BlockingIOError:
            return False
        except OSError:
            return True

    def slow_ones(self, dashboard):
        """Clients that send a header byte by byte; each keeps its place until the limit of a request."""
        slow = [self.connected(dashboard, HEAD) for _ in range(MOST_CONNECTIONS // 2)]

        def trickle():
            for client in slow:
                try:
                    client.send(b"X")
                except OSError:
                    pass
        threading.Thread(target=hold, args=(2 * REQUEST_LIMIT_S, trickle, 0.5), daemon=True).start()
        return slow

    def traverse(self, dashboard):
        for target in TRAVERSALS:
            answer = dashboard.raw(b"GET " + target.encode() + b" HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
            self.assertIn(answer.split(b" ")[1:2], ([b"404"], [b"400"]), target)
            self.assertNotIn(b"root:", answer, target)

    def say_nonsense(self, dashboard):
        long = b"a" * 100000
        for request in (*MALFORMED, b"GET /" + long + b" HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", HEAD + b"Cookie: " + long + b"\r\n\r\n",
                        HEAD + b"A: b\r\n" * 5000 + b"\r\n", b"POST /acknowledge HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 5000\r\n\r\n" + long):
            client = self.connected(dashboard)
            try:
                client.sendall(request)
                client.shutdown(socket.SHUT_WR)
                answer = client.recv(65536)
            except OSError as error:
                # ENOTCONN from shutdown(): the server closed first.
                if not isinstance(error, ConnectionError) and error.errno != errno.ENOTCONN:
                    raise
                answer = b""
            client.close()
            # No answer, or a refusal. None of these requests is one that HTTP allows a server to accept.
            self.assertIn(answer[:12].split(b" ")[1:2], ([], [b"400"], [b"403"], [b"413"], [b"431"]), request[:80])

    def pipeline(self, dashboard):
        asked = 1000
        client = self.connected(dashboard)
        threading.Thread(target=client.sendall, daemon=True, args=(
            (HEAD[:-2].replace(b"/ ", b"/style.css ") + b"\r\n\r\n") * (asked - 1) + HEAD + b"Connection: close\r\n\r\n",)).start()
        answers = 0
        while part := client.recv(1 << 20):
            answers += part.count(b"HTTP/1.1 200 OK")
        self.assertGreater(answers, 0.99 * asked)  # a status line may lie across two parts

    def never_read(self, dashboard):
        """Asks and asks, and takes nothing: as a stream, and as a thousand pages."""
        for _ in range(MOST_LISTENERS // 2):
            mute = socket.socket()
            mute.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            mute.connect(("127.0.0.1", dashboard.port))
            self.addCleanup(mute.close)
            mute.setblocking(False)
            mute.send(b"GET /events HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
        for _ in range(8):
            greedy = self.connected(dashboard)
            greedy.setblocking(False)
            greedy.send(b"GET /snapshot HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n" * 200)
        wait_for("end of the clients that never read", lambda: dashboard.snapshot()["dashboard"]["clients"] == 0)

    def flood(self, dashboard):
        _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
        honest = Honest(dashboard)
        honest.start()
        began = time.monotonic()
        crowd, worst = [], 0
        for i in range(min(CONNECTIONS, most - 500)):
            client = socket.socket()
            client.setblocking(False)
            if client.connect_ex(("127.0.0.1", dashboard.port)) not in (0, errno.EINPROGRESS):
                client.close()
                continue
            crowd.append(client)
            if i % 100 == 0:
                worst = max(worst, descriptors(dashboard.process.pid))
        took_s = time.monotonic() - began
        asked, answered = honest.asked, honest.answered
        self.assertLess(worst, MOST_CONNECTIONS + 50)
        # With all of them still there.
        self.assertEqual(dashboard.ask("GET", "/snapshot")[0], 200)
        honest.stop()
        for client in crowd:
            client.close()
        print(f"{len(crowd)} connections in {took_s:.1f} s: at most {worst} descriptors; of the honest requests meanwhile {answered} of {asked} "
              f"answered, in all {honest.answered} of {honest.asked}")


if __name__ == "__main__":
    main()
