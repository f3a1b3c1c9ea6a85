#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What `stillhand dashboard` costs with many rigs on the bus and many pages open.

    STILLHAND_BUILD=build tests/benchmark/dashboard_load.py [--rigs 15] [--seconds 20] [--clients 24]

Each rig has seven topics at 1 kHz, written by one process on the real bus (dashboard_load.cpp); each client reads the
stream of events. Processor time is that of all the dashboard's threads, user and system, meanwhile. *Counted* are the
samples that its page shows for all rigs at the end. Prints a row of a table; exit status 1 above 25 % of a core, or if a
count differs from the samples sent.
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import threading
import time
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

from waiting import wait_for  # noqa: E402

BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", "build"))
TOPICS = 7
WARM_UP_S = 3.0
MOST_SHARE = 0.25
LIMIT_S = 30.0
POLL_S = 0.1


def cpu_s(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Client(threading.Thread):
    """Reads and counts events until it is stopped."""

    def __init__(self, address):
        super().__init__(daemon=True)
        self.stream = urllib.request.urlopen(address + "events", timeout=30)
        self.events = self.bytes = 0

    def run(self):
        try:
            while part := self.stream.read1(1 << 16):
                self.bytes += len(part)
                self.events += part.count(b"data: {")
        except (OSError, ValueError):
            pass


def snapshot(address):
    return json.load(urllib.request.urlopen(address + "snapshot", timeout=30))


def counted_of(seen):
    return sum(each["samples"] for each in seen["rigs"])


def refused(why):
    return SystemExit(f"dashboard_load: {why}")


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--rigs", type=int, default=15)
    words.add_argument("--seconds", type=int, default=20)
    words.add_argument("--clients", type=int, default=24)
    options = words.parse_args()
    domain = str(190 + os.getpid() % 10)
    dashboard = subprocess.Popen([BUILD / "bin" / "stillhand", "dashboard", "--port", "0", "--domain", domain],
                                 stdout=subprocess.PIPE, text=True)
    address = dashboard.stdout.readline().strip()
    load = subprocess.Popen([BUILD / "tests" / "dashboard_load", domain, str(options.rigs), str(options.seconds)],
                            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    try:
        clients = [Client(address) for _ in range(options.clients)]
        for client in clients:
            client.start()
        wait_for("the load's first seconds", lambda: snapshot(address)["session"]["tick"] >= 1000 * WARM_UP_S,
                 LIMIT_S, POLL_S, refused)
        began, used = time.monotonic(), cpu_s(dashboard.pid)
        events, most_listening = sum(client.events for client in clients), 0


        def nearly_over():
            nonlocal most_listening
            seen = snapshot(address)
            most_listening = max(most_listening, seen["dashboard"]["clients"])
            return seen["session"]["tick"] >= 1000 * (options.seconds - 1)
        wait_for("the load's last second", nearly_over, LIMIT_S + options.seconds, POLL_S, refused)
        share = (cpu_s(dashboard.pid) - used) / (time.monotonic() - began)
        rate = (sum(client.events for client in clients) - events) / (time.monotonic() - began)
        report = load.stdout.readline().strip()
        sent = int(re.match(r"sent (\d+)", report)[1])
        # Samples on their way arrive; the row shows it if they do not.
        wait_for("all that was sent", lambda: counted_of(snapshot(address)) == sent, LIMIT_S, POLL_S,
                 failure=None)
        seen = snapshot(address)
    finally:
        load.stdin.close()
        load.wait()
        dashboard.terminate()
        dashboard.wait()
    counted = counted_of(seen)
    lost = sum(each["lost"] for each in seen["rigs"])
    print(report)
    print(f"events {rate:.0f} a second, {rate / options.clients:.1f} a client; {most_listening} listened")
    print("| topics at 1 kHz | messages a second | clients | CPU [% of a core] | sent | counted | lost | dropped |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    print(f"| {TOPICS * options.rigs} | {TOPICS * options.rigs * 1000} | {most_listening} | {100 * share:.1f} | {sent} | {counted} | {lost} | "
          f"{seen['dashboard']['dropped']} |")
    return 0 if share < MOST_SHARE and counted == sent and lost == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
