#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writing and reading a recording next to a plain write, and to the MCAP project's own library, by number of topics.

    STILLHAND_BUILD=build /usr/bin/python3 tests/benchmark/recorder_peers.py

50,000 messages of 92 bytes each time, on 1, 10, 100 and 1,000 topics; medians of --repeats of the processor time.
Plain: one write() for each message. Ours: McapWriter and McapReader (tests/mcap_write_benchmark). Peer: @mcap/core of
npm in Node.js, which interface.mcap_official_reader installs; without it its columns are left out. Neither Debian nor
npm has the `mcap` command, MCAP's C++ library or rosbag2. Nobody waits for the disk.
"""
import argparse
import json
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile

BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", "build")).resolve()
PEER = BUILD / "tests" / "mcap_official_reader"
MESSAGES, BYTES = 50_000, 92
TOPICS = (1, 10, 100, 1000)


def ours(repeats):
    run = subprocess.run([BUILD / "tests" / "mcap_write_benchmark", "--benchmark_filter=plain_write/|topics",
                          f"--benchmark_repetitions={repeats}", "--benchmark_min_time=0.1", "--benchmark_format=json"],
                         capture_output=True, text=True, check=True)
    return {each["run_name"]: each["cpu_time"] / 1e3 for each in json.loads(run.stdout)["benchmarks"]
            if each.get("aggregate_name") == "median"}


def peer(topics, repeats, folder):
    if shutil.which("node") is None or not (PEER / "node_modules" / "@mcap" / "core").is_dir():
        return None
    shutil.copy(pathlib.Path(__file__).with_name("mcap_peer.mjs"), PEER)
    run = subprocess.run(["node", PEER / "mcap_peer.mjs", folder + "/peer.mcap", *map(str, (MESSAGES, BYTES, topics, repeats))],
                         capture_output=True, text=True)
    if run.returncode:
        sys.exit("recorder_peers: " + run.stderr.strip()[-400:])
    return {name: statistics.median(each) for name, each in json.loads(run.stdout).items()}


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--repeats", type=int, default=5)
    options = words.parse_args()
    mine = ours(options.repeats)
    plain = next(value for name, value in mine.items() if name.startswith("plain_write/"))
    rate = lambda seconds: f"{MESSAGES / seconds / 1e6:.2f}" if seconds else "-"
    over = lambda one, other: f"{one / other:.1f}" if one else "-"
    print(f"plain write(): {rate(plain)} million messages a second")
    print("| topics | write: ours [10^6/s] | peer | ours/plain [time] | peer/ours | read: ours [10^6/s] | peer | peer/ours |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for topics in TOPICS:
            other = peer(topics, options.repeats, folder) or {"write_s": None, "read_s": None}
            write = mine[f"mcap_write_topics/topics:{topics}/real_time"]
            read = mine[f"mcap_read_topics/topics:{topics}/real_time"]
            print(f"| {topics} | {rate(write)} | {rate(other['write_s'])} | {over(write, plain)} "
                  f"| {over(other['write_s'], write)} | {rate(read)} | {rate(other['read_s'])} "
                  f"| {over(other['read_s'], read)} |", flush=True)


if __name__ == "__main__":
    main()
