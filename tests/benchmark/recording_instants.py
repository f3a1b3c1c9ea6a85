#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How fast `stillhand dashboard --recording` is ready, and shows an instant of it.

    STILLHAND_BUILD=build /usr/bin/python3 tests/benchmark/recording_instants.py SESSION.mcap [--instants 200]

From the start of the program to its address, then one request after the other for instants drawn over the recording.
"""
import argparse
import json
import pathlib
import random
import statistics
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "integration"))

from dashboard_test import Dashboard  # noqa: E402


def resident_mb(pid):
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    return next(int(line.split()[1]) for line in status.splitlines() if line.startswith("VmRSS:")) / 1024


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("recording", type=pathlib.Path)
    words.add_argument("--instants", type=int, default=200)
    options = words.parse_args()
    began = time.monotonic()
    dashboard = Dashboard("--recording", options.recording)
    ready_s = time.monotonic() - began
    try:
        length_s = json.loads(dashboard.ask("GET", "/timeline")[1])["length_s"]
        draw = random.Random(1)
        took_ms = []
        for _ in range(options.instants):
            began = time.monotonic()
            status, _, _ = dashboard.ask("GET", f"/snapshot?at={draw.uniform(0, length_s):.3f}")
            took_ms.append((time.monotonic() - began) * 1e3)
            assert status == 200, status
        memory_mb = resident_mb(dashboard.process.pid)
    finally:
        dashboard.close()
    print(f"{length_s:.0f} s, {options.recording.stat().st_size / 1e6:.0f} MB: ready after {ready_s:.2f} s; an instant takes "
          f"{statistics.median(took_ms):.0f} ms in the median, {max(took_ms):.0f} ms at most of {len(took_ms)}; "
          f"{memory_mb:.0f} MB of memory")


if __name__ == "__main__":
    sys.exit(main())
