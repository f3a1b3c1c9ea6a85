#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How fast the control loop is, next to what the machine and two middlewares allow, in one run.

    tests/benchmark/loop_latency.py [--seconds 600] [--round 20] [--only lab,bare] [--lab NAME=PROGRAMS[,CONFIG]]...
                                    [--bare NAME=LOOP_FORWARD]...

The contenders take turns, a round of each and again, so that what else the machine does hits all alike:

  lab          a whole session (condition C) as `stillhand lab` starts it; latencies by the stamps of its recording
  bare         the same two topics and answers on plain Fast DDS: three processes that only forward (loop_forward)
  ddsperf      Cyclone DDS: `ddsperf ping 1kHz` and `pong`, 256 bytes, best effort (package cyclonedds-tools)
  cyclictest   how late the kernel wakes a thread, `cyclictest -p80 -i1000` (package rt-tests)

--lab adds the lab of another build, --bare the plain loop of another Fast DDS, so that both are of one run. Prints a
row a round on standard error, and at the end one table: medians over the rounds of p50, p99 and p99.9, and the worst of
all, in microseconds. All contenders run with SCHED_FIFO where the system grants it.
"""
import argparse
import datetime
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests" / "integration"))

from lab_process import BUILD, loose_settings, next_domain  # noqa: E402

QUANTILES = ("p50", "p99", "p999", "worst")
LOOPBACK = ('<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="127.0.0.1" multicast="true"/>'
            '</Interfaces></General></Domain></CycloneDDS>')


def real_time_words():
    """Words before a program that asks for no priority itself; none where the system refuses."""
    granted = subprocess.run(["chrt", "-f", "40", "true"], stderr=subprocess.DEVNULL, check=False).returncode == 0
    return ["chrt", "-f", "40"] if granted else []


def lab(programs, config, seconds, domain):
    """{row: figures} of one session."""
    with tempfile.TemporaryDirectory(prefix="stillhand-") as scratch:
        out = pathlib.Path(scratch) / "session"
        words = [programs / "stillhand", "lab", "--conditions", "C", "--identify-seconds", "5", "--trial-seconds",
                 str(seconds), "--seed", "2", "--headless", "--domain", str(domain), "--out", out, "--config",
                 loose_settings(pathlib.Path(scratch) / "config", config)]
        done = subprocess.run(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"the session failed: {done.stderr.strip()}")
        found = json.loads(subprocess.check_output([BUILD / "tests" / "loop_stamps", out / "session.mcap"]))
    rows = {row: found[row] for row in ("sensed", "command", "used", "sensed to command", "command to use")}
    for reader, topic in (("sensing", "raw_sample"), ("cancellation", "sensed"), ("rig", "motor_command")):
        receipt = found["receipts"].get(f"{reader} stillhand/{topic}", {})
        if receipt:
            rows[f"receipt of {topic}"] = {"p50": receipt["p50"], "p99": receipt["p99"], "worst": receipt["worst"]}
    rows["counts"] = {"same tick [%]": 100.0 * found["same_cycle_share"], "unanswered": found["unanswered"],
                      "ticks": found["ticks"]}
    return rows


def bare(program, seconds, domain):
    text = subprocess.check_output([program, str(seconds), str(domain)], text=True)
    found = json.loads(text)
    return {row: found[row] for row in ("command", "received", "used")}


def ddsperf(seconds, domain, first):
    words = [*first, "ddsperf", "-u", "-T", "S256", "-i", str(domain), "-D"]
    environment = {**os.environ, "CYCLONEDDS_URI": LOOPBACK}
    pong = subprocess.Popen([*words, str(seconds + 3), "pong"], env=environment, stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL)
    try:
        text = subprocess.run([*words, str(seconds + 1), "ping", "1kHz"], env=environment, stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, text=True, check=False).stdout
    finally:
        pong.terminate()
        pong.wait()
    # A line a second; the first one holds the discovery.
    found = re.findall(r"50% ([\d.]+)us .*?99% ([\d.]+)us max ([\d.]+)us", text)[1:]
    if not found:
        raise RuntimeError(f"ddsperf printed no latency: {text.strip()}")
    columns = [[float(value) for value in column] for column in zip(*found)]
    return {"round trip": {"p50": statistics.median(columns[0]), "p99": statistics.median(columns[1]),
                           "worst": max(columns[2])}}


def cyclictest(seconds):
    text = subprocess.run(["cyclictest", "-p80", "-i1000", "-m", "-q", f"-D{seconds}", "-h5000"], check=True,
                          stdout=subprocess.PIPE, text=True).stdout
    counts = [int(n) for _, n in re.findall(r"^(\d{6}) (\d+)", text, re.MULTILINE)]
    late = int(re.search(r"Histogram Overflows: (\d+)", text).group(1))
    total = sum(counts) + late

    def quantile(share):
        seen = 0
        for microseconds, count in enumerate(counts):
            seen += count
            if seen > share * total:
                return float(microseconds)
        return float(len(counts))

    return {"wake-up": {"p50": quantile(0.5), "p99": quantile(0.99), "p999": quantile(0.999),
                        "worst": float(re.search(r"Max Latencies: (\d+)", text).group(1))}}


def summary(rounds):
    """{row: {quantile: median over the rounds; of "worst" the worst}}"""
    rounds = [found for found in rounds if found]
    rows = {}
    for row in rounds[0]:
        rows[row] = {}
        for key in rounds[0][row]:
            values = [found[row][key] for found in rounds if key in found.get(row, {})]
            rows[row][key] = max(values) if key == "worst" else statistics.median(values)
    return rows


def print_table(results):
    print(f"{'contender':14} {'row':26} {'p50':>9} {'p99':>9} {'p99.9':>9} {'worst':>9}   [us]")
    for name, rounds in results.items():
        for row, figures in summary(rounds).items():
            if row == "counts":
                print(f"{name:14} " + ", ".join(f"{key} {value:.4g}" for key, value in figures.items()))
                continue
            cells = [f"{figures[key]:9.0f}" if key in figures else f"{'-':>9}" for key in QUANTILES]
            print(f"{name:14} {row:26} " + " ".join(cells))


def print_ratios(results):
    """Ratios of the same round, then their median: what both had to bear cancels out."""
    for name in results:
        peer_name = name.replace("lab", "bare") if name.replace("lab", "bare") in results else "bare"
        if not name.startswith("lab") or peer_name not in results:
            continue
        pairs = [(mine, peer) for mine, peer in zip(results[name], results[peer_name]) if mine and peer]
        for row in ("command", "used") if pairs else ():
            ratios = {key: [mine[row][key] / peer[row][key] for mine, peer in pairs] for key in QUANTILES[:3]}
            print(f"{name} / {peer_name}, {row}: " + ", ".join(f"{key} {statistics.median(values):.2f}"
                                                      for key, values in ratios.items()))


def take_turns(calls, turns, results):
    """Appends each contender's figures of each turn; None where it failed."""
    for turn in range(turns):
        for name, call in calls.items():
            try:
                results[name].append(call())
            except (RuntimeError, subprocess.CalledProcessError) as error:
                print(f"round {turn}, {name}: {error}", file=sys.stderr)
                results[name].append(None)
                continue
            print(f"round {turn}, {name}: {json.dumps(results[name][-1])}", file=sys.stderr)


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--seconds", type=int, default=600, help="of each contender in all [600]")
    words.add_argument("--round", type=int, default=20, help="seconds of a turn [20]")
    words.add_argument("--only", default="lab,bare,ddsperf,cyclictest")
    words.add_argument("--lab", action="append", default=[], metavar="NAME=PROGRAMS[,CONFIG]")
    words.add_argument("--bare", action="append", default=[], metavar="NAME=LOOP_FORWARD")
    options = words.parse_args()
    first = real_time_words()
    domain = next_domain()
    calls = {}
    chosen = options.only.split(",")
    config = SOURCE / "deploy" / "config"
    if "lab" in chosen:
        calls["lab"] = lambda: lab(BUILD / "bin", config, options.round, domain)
    for each in options.lab:
        name, _, place = each.partition("=")
        programs, _, own = place.partition(",")
        calls[f"lab {name}"] = lambda programs=programs, own=own: lab(
            pathlib.Path(programs or BUILD / "bin"), pathlib.Path(own or config), options.round, domain)
    if "bare" in chosen:
        calls["bare"] = lambda: bare(BUILD / "tests" / "loop_forward", options.round, domain)
    for each in options.bare:
        name, _, program = each.partition("=")
        calls[f"bare {name}"] = lambda program=program: bare(program, options.round, domain)
    if "ddsperf" in chosen and shutil.which("ddsperf"):
        calls["ddsperf"] = lambda: ddsperf(options.round, domain, first)
    if "cyclictest" in chosen and shutil.which("cyclictest"):
        calls["cyclictest"] = lambda: cyclictest(options.round)
    results = {name: [] for name in calls}
    take_turns(calls, max(1, options.seconds // options.round), results)
    print(f"{datetime.date.today()}, {os.cpu_count()} cores, kernel {os.uname().release}, "
          f"SCHED_FIFO {'granted' if first else 'refused'}, "
          f"{options.seconds} s of each contender in turns of {options.round} s")
    results = {name: rounds for name, rounds in results.items() if any(rounds)}
    print_table(results)
    print_ratios(results)


if __name__ == "__main__":
    sys.exit(main())
