#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How long `stillhand diagnose` takes, from the process's start to its end, and the most memory it held.

    STILLHAND_BUILD=build python3 tests/benchmark/diagnose_speed.py
    STILLHAND_BUILD=build python3 tests/benchmark/diagnose_speed.py --planted    # four minutes

--planted: a recording of each kind of effect, and one without, under each of five noises, 120 s at 100 Hz with 8
channels, from build/tests/planted_recordings; wall clock of each, median and worst of all.  Limits 3 and 6 s.

Otherwise recordings are made here: band-limited motion, a body of fourth order, 40 dB of white noise and, planted, a path from a
second channel to the output that carries a quarter of its RMS.  Median of five runs for the short one; the hour once.
Exit status 1 where a limit is missed or the planted channel isn't named.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy

from no_harm import KINDS
from recorded_data import BUILD

NOISES = ("white", "low_pass", "pink", "heavy_tailed", "uneven")
SPARE = [("theta", "rad"), ("a_x", "m/s^2"), ("a_z", "m/s^2"), ("v", "m/s"), ("temp", "K")]


def band_noise(random, count, rate_hz, highest_hz, rms):
    spectrum = numpy.fft.rfft(random.standard_normal(count))
    hz = numpy.fft.rfftfreq(count, 1.0 / rate_hz)
    spectrum *= (hz > 0.3) / (1.0 + (hz / highest_hz) ** 8)
    x = numpy.fft.irfft(spectrum, count)
    return x * rms / x.std()


def through_body(x, rate_hz):
    """Modes at 2 and 5 Hz next to each other, in the frequency domain: no code in common with the engine's."""
    spectrum = numpy.fft.rfft(x)
    s = 2j * numpy.pi * numpy.fft.rfftfreq(len(x), 1.0 / rate_hz)
    response = 0.0
    for hz, damping, gain in ((2.0, 0.35, -2.0), (5.0, 0.3, -1.2)):
        w = 2.0 * numpy.pi * hz
        response = response + gain * w * w / (s * s + 2.0 * damping * w * s + w * w)
    return numpy.fft.irfft(spectrum * response, len(x))


def write_recording(path, seconds, rate_hz, channels, planted):
    random = numpy.random.default_rng(1)
    count = int(seconds * rate_hz)
    table = {"a_y [m/s^2]": band_noise(random, count, rate_hz, 6.0, 1.5)}
    table["f [N]"] = through_body(table["a_y [m/s^2]"], rate_hz)
    table["roll [rad]"] = band_noise(random, count, rate_hz, 3.0, 0.05)
    rms = table["f [N]"].std()
    if planted:
        table["f [N]"] += 0.25 * rms / 0.05 * table["roll [rad]"]
    table["f [N]"] += 0.01 * rms * random.standard_normal(count)
    for name, unit in SPARE[:channels - len(table)]:
        table[f"{name} [{unit}]"] = band_noise(random, count, rate_hz, 4.0, 1.0)
    digits = len(str(int(rate_hz))) - 1
    row = ",".join([f"%.{digits}f"] + ["%.6f"] * len(table)) + "\n"
    with open(path, "w", encoding="ascii") as file:
        file.write(",".join(["t [s]", *table]) + "\n")
        for first in range(0, count, 100000):
            part = numpy.column_stack([numpy.arange(first, min(first + 100000, count)) / rate_hz] +
                                      [x[first:first + 100000] for x in table.values()])
            file.write((row * len(part)) % tuple(part.ravel().tolist()))
    return len(table)


def diagnose(path, out):
    """Wall clock [s], processor time [s], peak resident memory [MiB], verdict."""
    begin = time.perf_counter()
    null = os.open(os.devnull, os.O_WRONLY)
    program = str(BUILD / "bin" / "stillhand")
    child = os.posix_spawn(program, [program, "diagnose", str(path), "--input", "a_y", "--output", "f", "--json", str(out)],
                           os.environ, file_actions=[(os.POSIX_SPAWN_DUP2, null, 1)])
    _, status, used = os.wait4(child, 0)
    wall_s = time.perf_counter() - begin
    os.close(null)
    if status != 0:
        sys.exit(f"{path.name}: exit status {os.waitstatus_to_exitcode(status)}")
    return wall_s, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024.0, json.loads(out.read_text())


def measured(folder, name, seconds, rate_hz, channels, planted, repetitions):
    path = folder / f"{name}.csv"
    channels = write_recording(path, seconds, rate_hz, channels, planted)
    runs = sorted((diagnose(path, folder / "out.json") for _ in range(repetitions)), key=lambda run: run[0])
    wall_s, processor_s, peak_mib, verdict = runs[repetitions // 2]
    found = [(effect["kind"], effect["channel"]) for effect in verdict["effects"]]
    expected = [("coupled_input", "roll")] if planted else []
    row = (f"{seconds:6.0f} s at {rate_hz:4.0f} Hz, {channels} channels, {'one effect' if planted else 'none'}",
           path.stat().st_size / 2.0 ** 20, wall_s, processor_s, peak_mib, found)
    path.unlink()
    return row, found[:1] == expected


def planted(folder):
    """A row for each kind of effect; exit status 1 where the median or the worst is beyond its limit."""
    recordings = str(BUILD / "tests" / "planted_recordings")
    print("| kind | " + " | ".join(NOISES) + " |\n| --- |" + " --- |" * len(NOISES))
    all_s = []
    for kind in KINDS:
        row = []
        for noise in NOISES:
            subprocess.run([recordings, "--kind", kind, "--noise", noise, "--strength", "0.1", "--snr", "16", "--seed",
                            "77", "--least-evidence", "0", "--count", "1", "--out", folder], check=True,
                           stdout=subprocess.DEVNULL)
            row.append(diagnose(folder / "rec_0001.csv", folder / "out.json")[0])
        all_s += row
        print(f"| {kind} | " + " | ".join(f"{wall_s:.1f}" for wall_s in row) + " |", flush=True)
    median_s, worst_s = statistics.median(all_s), max(all_s)
    print(f"{len(all_s)} recordings: median {median_s:.1f} s (limit 3), worst {worst_s:.1f} s (limit 6)")
    return 0 if median_s <= 3.0 and worst_s <= 6.0 else 1


def main():
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    words.add_argument("--folder", help="where the recordings are made; the hour takes 0.3 GB")
    words.add_argument("--only", choices=["short", "hour"])
    words.add_argument("--planted", action="store_true", help="every kind of effect under every noise")
    words.add_argument("--repetitions", type=int, default=5)
    words = words.parse_args()
    cases = []
    if words.only != "hour":
        cases += [("short", 120.0, 100.0, 8, True, words.repetitions, 3.0, None),
                  ("short_none", 120.0, 100.0, 8, False, words.repetitions, 3.0, None)]
    if words.only != "short":
        cases += [("hour", 3600.0, 1000.0, 3, True, 1, 60.0, 1024.0), ("hour_wide", 3600.0, 1000.0, 8, True, 1, 60.0, 1024.0)]
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} before")
    if words.planted:
        with tempfile.TemporaryDirectory(dir=words.folder) as folder:
            sys.exit(planted(pathlib.Path(folder)))
    print(f"{'recording':45}   MiB   wall s (limit)   CPU s  peak MiB (limit)  found")
    good = True
    with tempfile.TemporaryDirectory(dir=words.folder) as folder:
        for *case, limit_s, limit_mib in cases:
            (name, size, wall_s, processor_s, peak_mib, found), named = measured(pathlib.Path(folder), *case)
            limit = f" ({limit_mib:.0f})" if limit_mib else ""
            print(f"{name:45}{size:6.0f}{wall_s:9.2f} ({limit_s:.0f}){processor_s:11.2f}{peak_mib:10.0f}{limit:8}  {found}",
                  flush=True)
            good = good and named and wall_s <= limit_s and (limit_mib is None or peak_mib <= limit_mib)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
