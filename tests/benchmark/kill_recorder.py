# SPDX-License-Identifier: Apache-2.0
"""Kills a recorder with SIGKILL at random moments while it records 4000 messages a second.

Usage: STILLHAND_BUILD=build python3 tests/benchmark/kill_recorder.py [--kills 200] [--seed 1] [--domain 214]

Every file must open, say that it was cut off, lose at most 1 s of messages, and come out whole of `stillhand recover`.
What is lost is the time from the stamp of the newest sample in the file to the kill, and a sample of each topic for each
millisecond of it. The publisher's own lateness on a busy machine does not count: a sample is stamped as it is written.
"""
import argparse
import csv
import json
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

from waiting import hold, wait_for  # noqa: E402

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", SOURCE / "build"))
STILLHAND = pathlib.Path(os.environ.get("STILLHAND_PROGRAMS", BUILD / "bin")) / "stillhand"
RECORDER = BUILD / "bin" / "stillhand-recorder"
PUBLISH = BUILD / "tests" / "publish_samples"
RATE_HZ = 1000  # of each topic
TOPICS = ("raw_sample", "rig_truth", "sensed", "motor_command")
CTEST_SKIPPED = 77
LOST_LIMIT_S = 1.0
START_LIMIT_S = 15.0
START_POLL_S = 0.005
# Behind the first chunk: several flush intervals, so that every phase of one is hit.
LATEST_KILL_S = 1.5


class Broken(Exception):
    pass


def run(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)


def size_of(file):
    return file.stat().st_size if file.exists() else 0


def record_and_kill(file, domain, when_s, in_start_up):
    """Returns the monotonic time of the kill [s]."""
    recorder = subprocess.Popen([str(RECORDER), "--domain", str(domain), "--profiles", str(SOURCE / "qos/profiles.xml"),
                                 "--config", str(SOURCE / "deploy/config"), "--out", str(file)],
                                stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        def ended():
            status = recorder.poll()
            return status is not None and f"the recorder ended with status {status}"

        def wait(what, condition):
            wait_for(what, condition, START_LIMIT_S, START_POLL_S, Broken, ended)

        wait("file", file.exists)
        if not in_start_up:
            empty = size_of(file)
            wait("chunk", lambda: size_of(file) > max(empty, 4096))
        if why := hold(when_s, ended):
            raise Broken(why)
        return time.monotonic()
    finally:
        recorder.send_signal(signal.SIGKILL)
        recorder.wait()


def newest_stamps(file, folder):
    """{topic: monotonic time at which its newest sample in a recording was written [s]}."""
    exported = run(STILLHAND, "export", file, "--csv", folder)
    if exported.returncode != 0:
        raise Broken("export: " + exported.stderr)
    found = {}
    for topic in TOPICS:
        path = folder / f"stillhand_{topic}.csv"
        if not path.exists():  # killed before a first sample of it was in the file
            continue
        with open(path, encoding="utf-8") as table:
            stamps = [int(row["stamp_ns [ns]"]) for row in csv.DictReader(table)]
        if stamps:
            found[topic] = stamps[-1] * 1e-9
    return found


def check(file, folder, killed_s):
    """(messages read, messages lost, seconds lost); nothing to lose in a file without a chunk: 0, 0, None."""
    told = run(STILLHAND, "info", file, "--json", folder / "info.json")
    if told.returncode != 0:
        raise Broken(f"info: status {told.returncode}: {told.stderr}")
    info = json.loads((folder / "info.json").read_text())
    if run(STILLHAND, "verify", file).returncode != 1 or "as after a crash" not in told.stderr:
        raise Broken("a file that was cut off is not said to be: " + told.stderr)
    whole = folder / "whole.mcap"
    if run(STILLHAND, "recover", file, "--out", whole).returncode != 0 or run(STILLHAND, "verify", whole).returncode != 0:
        raise Broken("recover gives no whole file")
    if info["messages"] == 0:
        return 0, 0, None
    found = newest_stamps(file, folder / "tables")
    if not found:
        return info["messages"], 0, None
    lost_s = [max(killed_s - stamp_s, 0.0) for stamp_s in found.values()]
    return info["messages"], sum(int(gone_s * RATE_HZ) for gone_s in lost_s), max(lost_s)


def summary(lost_s, lost, messages, kills, empty):
    ordered = sorted(lost_s)
    middle, most = (ordered[len(ordered) // 2], ordered[-1]) if ordered else (0.0, 0.0)
    return (f"{kills} kills: every file opened; {empty} of them before a first message was in the file; "
            f"{messages} messages read, {lost} lost (at the end of each file); "
            f"lost time median {middle:.3f} s, most {most:.3f} s")


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--kills", type=int, default=200)
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--domain", type=int, default=214)
    words = words.parse_args()
    missing = [str(path) for path in (STILLHAND, RECORDER, PUBLISH) if not path.is_file()]
    if missing:
        print("skipped, not built:", ", ".join(missing))
        return CTEST_SKIPPED
    chance = random.Random(words.seed)
    publisher = subprocess.Popen([str(PUBLISH), "--domain", str(words.domain)], stdout=subprocess.PIPE, text=True)
    lost_s, lost, messages, empty = [], 0, 0, 0
    try:
        publisher.stdout.readline()  # it is at work
        for kill in range(words.kills):
            with tempfile.TemporaryDirectory(prefix="stillhand-") as folder:
                folder = pathlib.Path(folder)
                file = folder / "a.mcap"
                in_start_up = kill % 5 == 4
                when_s = chance.uniform(0.0, LATEST_KILL_S)
                try:
                    killed_s = record_and_kill(file, words.domain, when_s, in_start_up)
                    read, gone, gone_s = check(file, folder, killed_s)
                    if gone_s is not None and gone_s > LOST_LIMIT_S:
                        raise Broken(f"{gone_s:.3f} s lost")
                except Broken as error:
                    print(f"kill {kill} ({when_s:.3f} s behind the {'file' if in_start_up else 'first chunk'}): {error}")
                    return 1
                messages, lost = messages + read, lost + gone
                empty += gone_s is None
                lost_s += [] if gone_s is None else [gone_s]
    finally:
        publisher.terminate()
        publisher.wait()
    print(summary(lost_s, lost, messages, words.kills, empty))
    return 0


if __name__ == "__main__":
    sys.exit(main())
