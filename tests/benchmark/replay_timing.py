#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How punctual `stillhand replay` is: release error and drift.

    tests/benchmark/replay_timing.py [--seconds 600] [--rate 10000] [--speed 1]

Replays a recording of ten topics, RATE messages a second in all, while `stillhand record` listens. Prints what the
replay measured of itself (time of the write less time due), what was lost on the way, and what the listener's file
says: how much longer or shorter the whole took than the recording, by the system clock.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", SOURCE / "build"))


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--seconds", type=int, default=600)
    words.add_argument("--rate", type=int, default=10000)
    words.add_argument("--speed", default="1")
    options = words.parse_args()
    domain = str(150 + os.getpid() % 40)
    stillhand = BUILD / "bin" / "stillhand"
    load = BUILD / "tests" / "bus_load"
    with tempfile.TemporaryDirectory(prefix="stillhand-") as folder:
        recording, heard = folder + "/load.mcap", folder + "/heard.mcap"
        subprocess.run([load, "--write", recording, str(options.rate), str(options.seconds)], check=True)
        recorder = subprocess.Popen([stillhand, "record", "--out", heard, "--domain", domain], stdout=subprocess.PIPE,
                                    text=True)
        waits = [word for i in range(10) for word in ("--wait-for", f"load/{i}")]
        subprocess.run([stillhand, "replay", recording, "--domain", domain, "--rate", options.speed, *waits],
                       stdin=subprocess.DEVNULL, check=True)
        recorder.send_signal(2)
        rows = [[int(word) for word in line.split()[1:5]]
                for line in recorder.communicate(timeout=60)[0].splitlines() if line.startswith("load/")]
        received, lost, _, written = (sum(column) for column in zip(*rows))
        sent = options.rate * options.seconds
        print(f"{sent} in the recording, {received} heard, {sent - received} missing ({lost} by gaps), {written} written")
        spans = [int(subprocess.run([load, "--span", path], stdout=subprocess.PIPE, text=True, check=True).stdout)
                 for path in (recording, heard)]
        wanted = spans[0] / float(options.speed)
        print(f"heard from first to last message: {spans[1] / 1e9:.6f} s, wanted {wanted / 1e9:.6f} s: "
              f"{(spans[1] - wanted) / 1e3:+.0f} us, {(spans[1] - wanted) / wanted * 1e6:+.3f} us/s")


if __name__ == "__main__":
    sys.exit(main())
