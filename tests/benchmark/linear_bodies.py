#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Linear bodies that ring or settle slowly, and nothing else: what does `diagnose` call missing?

60 s at 100 Hz, an input of 0.2 to 10 Hz with random phases, white noise of 2 % of the output. One row for each body: a
mode at 2 Hz that decays within the time stated, or a real pole with that time constant. The right verdict is "nothing
missing", and the right error is the noise, 0.02. No row is judged: the bound of DG-1 makes slow real poles wrong today.

    STILLHAND_BUILD=build python3 tests/benchmark/linear_bodies.py     # half a minute
"""
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy

BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", pathlib.Path(__file__).resolve().parents[2] / "build"))
ROWS, PERIOD_S, NOISE, MODE_HZ = 6000, 0.01, 0.02, 2.0
BODIES = (("mode", 1.0), ("mode", 2.0), ("mode", 5.0), ("mode", 15.0), ("real pole", 0.5), ("real pole", 1.0),
          ("real pole", 2.0), ("real pole", 4.0))


def excitation(random):
    frequencies = numpy.fft.rfftfreq(ROWS, PERIOD_S)
    phases = numpy.exp(2j * math.pi * random.random(len(frequencies)))
    motion = numpy.fft.irfft(numpy.where((frequencies >= 0.2) & (frequencies <= 10.0), phases, 0.0), ROWS)
    return motion / numpy.std(motion)


def denominator(body, time_s):
    radius = math.exp(-PERIOD_S / time_s)
    if body == "mode":
        return [-2.0 * radius * math.cos(2.0 * math.pi * MODE_HZ * PERIOD_S), radius**2]
    return [-radius]


def response(motion, poles):
    output = numpy.zeros(ROWS)
    for n in range(1, ROWS):
        output[n] = motion[n - 1] - sum(a * output[n - 1 - k] for k, a in enumerate(poles) if n > k)
    return output / numpy.std(output)


def verdict(folder, motion, output):
    recording, out = folder / "linear.csv", folder / "linear.json"
    with open(recording, "w") as file:
        file.write("t [s],u [V],y [V]\n")
        file.writelines(f"{n * PERIOD_S:.2f},{motion[n]:.9g},{output[n]:.9g}\n" for n in range(ROWS))
    run = subprocess.run([BUILD / "bin" / "stillhand", "diagnose", recording, "--input", "u", "--output", "y", "--model",
                          "arx", "--json", out], capture_output=True, text=True)
    if run.returncode:
        sys.exit(f"linear_bodies: {run.stderr.strip()}")
    return json.loads(out.read_text())


def main():
    random = numpy.random.default_rng(1)
    motion = excitation(random)
    print("| body | decays in [s] | baseline, final [V] | effects |\n| --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as holder:
        for body, time_s in BODIES:
            output = response(motion, denominator(body, time_s)) + NOISE * random.standard_normal(ROWS)
            said = verdict(pathlib.Path(holder), motion, output)
            errors = f"{said['baseline']['heldout_rmse']:.4f}, {said['final']['heldout_rmse']:.4f}"
            kinds = ", ".join(effect["kind"] for effect in said["effects"]) or said["verdict"]
            print(f"| {body} | {time_s:g} | {errors} | {kinds} |", flush=True)


if __name__ == "__main__":
    main()
