#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How many messages a second `stillhand record` takes from the bus without a loss.

    tests/benchmark/record_rate.py [--rate 60000] [--seconds 60] [--pattern stream_1khz] [--search]

Ten topics of one writer process, 132 bytes a message, over UDP on loopback, all on this machine. --search goes down by a
sixth until nothing is lost. Prints what was sent, received, lost and written, the processor time of both, and what the
kernel dropped. Exit status 1 when something was lost.
"""
import argparse
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

from waiting import wait_for  # noqa: E402

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", SOURCE / "build"))
TAKEN_LIMIT_S = 10.0


def dropped_by_kernel():
    """UDP datagrams that found no room in a socket's buffer, since boot."""
    names, values = [line.split() for line in pathlib.Path("/proc/net/snmp").read_text().splitlines()
                     if line.startswith("Udp:")]
    return int(values[names.index("RcvbufErrors")])


def all_taken():
    """True if no UDP socket of this machine holds a datagram."""
    rows = pathlib.Path("/proc/net/udp").read_text().splitlines()[1:]
    return all(int(row.split()[4].split(":")[1], 16) == 0 for row in rows)


def measure(rate, seconds, pattern):
    domain = 150 + os.getpid() % 40
    with tempfile.TemporaryDirectory(prefix="stillhand-") as folder:
        dropped = dropped_by_kernel()
        recorder = subprocess.Popen([BUILD / "bin" / "stillhand", "record", "--out", folder + "/load.mcap",
                                     "--domain", str(domain), "--topics", "load/*"], stdout=subprocess.PIPE, text=True)
        load = subprocess.Popen([BUILD / "tests" / "bus_load", str(domain), str(rate), str(seconds), pattern],
                                stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        sent = load.stdout.readline().strip()
        wait_for("end of the queues", all_taken, TAKEN_LIMIT_S, failure=None)
        load.communicate("\n", timeout=60)
        if load.returncode:
            sys.exit(f"record_rate: bus_load ended with status {load.returncode}")
        recorder.send_signal(2)
        told = recorder.communicate(timeout=60)[0]
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        rows = [[int(word) for word in line.split()[1:5]] for line in told.splitlines() if line.startswith("load/")]
        received, lost, not_sent, written = (sum(column) for column in zip(*rows))
        print(sent)
        print(f"received {received}, lost {lost}, not sent {not_sent}, written {written}; "
              f"{rate * seconds - written} missing in the file")
        print(f"processor time of both: {usage.ru_utime + usage.ru_stime:.1f} s so far; datagrams that the kernel "
              f"dropped on this machine meanwhile: {dropped_by_kernel() - dropped}", flush=True)
        achieved = float(sent.split(" a second")[0].split()[-1])
        return rate * seconds - written, achieved


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--rate", type=int, default=60000)
    words.add_argument("--seconds", type=int, default=60)
    words.add_argument("--pattern", default="stream_1khz", choices=("stream_1khz", "event"))
    words.add_argument("--search", action="store_true")
    options = words.parse_args()
    rate = options.rate
    while True:
        missing, achieved = measure(rate, options.seconds, options.pattern)
        if missing == 0:
            print(f"{achieved:.0f} messages a second: nothing lost"
                  + ("" if achieved > 0.99 * rate else f"; the sender did not reach {rate}"))
            return 0 if achieved > 0.99 * rate else 1
        if not options.search or rate < 1000:
            return 1
        rate = rate * 5 // 6 // 10 * 10


if __name__ == "__main__":
    sys.exit(main())
