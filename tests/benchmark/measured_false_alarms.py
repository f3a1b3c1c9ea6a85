#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""False alarms on measured signals: nothing is missing, and every signal was measured.

A problem is a stretch of a measured input, the output that a linear body gives for it, and measured noise: a stretch of
another recording that has nothing to do with the input, at a random place, with a random sign, scaled to a share of the
output. So the right verdict is "nothing missing". The linear body is the one that `diagnose --most-effects 0` fits to
the recording of the input, or the paper's second-order body where the recording has no output.

An alarm is a verdict "effects found". The noise is a real one and may hold a tone, a drift, bursts or a change of its
own; alarms whose effects are all of time alone are counted apart. So is "unexplained residual", which is no effect.
Exit status 1 where the alarms are more than `--rate` allows (exact binomial, 5 %), 77 without the recordings.

    STILLHAND_BUILD=build python3 tests/benchmark/measured_false_alarms.py              # 90 problems, some ten minutes
    STILLHAND_BUILD=build python3 tests/benchmark/measured_false_alarms.py --draws 8 --seed 2 --verbose
"""
import argparse
import collections
import json
import math
import pathlib
import sys
import tempfile

import numpy

from recorded_data import DATA, column, needs, stillhand

ROWS = 6000
LEVELS = (0.05, 0.15, 0.4)  # noise over output, RMS
OF_TIME_ALONE = {"tone", "drift", "transients", "regime_change", "time_varying_gain", "clock_drift"}
# Recording, input, output (none: the paper's body), rows a second.
BODIES = {
    "treadmill": ("treadmill_fast1", "belt_acceleration", "pitch_moment", 100.0),
    "silverbox": ("silverbox_train", "u", "y", 610.35),
    "car": ("car_ride", "a_y", None, 104.0),
}
# Recording, channel; its slow part is taken off (a running mean over 2 s).
NOISES = {
    "road, vertical": ("car_ride", "a_z"),
    "road, forward": ("car_ride", "a_x"),
    "belt, residual": ("treadmill_slow1", "pitch_moment"),
    "rotating belt": ("treadmill_slow1", "belt_velocity"),
}


def without_slow_part(values, rate_hz):
    width = int(2.0 * rate_hz) | 1
    padded = numpy.pad(values, width // 2, mode="edge")
    return values - numpy.convolve(padded, numpy.ones(width) / width, mode="valid")


def second_order(motion, rate_hz):
    """The paper's form, 1.5 Hz with a damping ratio of 0.3: far inside what the engine's body can be."""
    radius = math.exp(-0.3 * 2.0 * math.pi * 1.5 / rate_hz)
    turn = 2.0 * math.pi * 1.5 * math.sqrt(1.0 - 0.3**2) / rate_hz
    force = numpy.zeros(len(motion))
    for n in range(2, len(motion)):
        force[n] = (2.0 * radius * math.cos(turn) * force[n - 1] - radius**2 * force[n - 2] + motion[n - 1])
    return force


def linear_output(scratch, recording, name, output, rate_hz):
    """What a linear body makes of the whole recording's input."""
    motion = column(recording, name)
    if output is None:
        motion = without_slow_part(motion, rate_hz)
        return motion, second_order(motion, rate_hz)
    model, prediction = scratch / "linear.json", scratch / "linear.csv"
    stillhand("diagnose", recording, "--input", name, "--output", output, "--model", "arx", "--most-effects", 0,
              "--save", model)
    stillhand("predict", model, recording, "--out", prediction)
    return motion, column(prediction, f"{output}_model")


def noise_of(scratch, recording, channel):
    values = column(recording, channel)
    if channel == "pitch_moment":  # without what the belt's acceleration explains
        values = values - linear_output(scratch, recording, "belt_acceleration", channel, 100.0)[1]
    return without_slow_part(values, 100.0)


def stretch(values, rows, random):
    first = random.integers(0, len(values) - rows + 1)
    return values[first:first + rows]


def verdict(scratch, motion, output, rate_hz):
    recording, out = scratch / "problem.csv", scratch / "problem.json"
    with open(recording, "w") as file:
        file.write("t [s],u [-],y [-]\n")
        file.writelines(f"{n / rate_hz:.7f},{u:.9g},{y:.9g}\n" for n, (u, y) in enumerate(zip(motion, output)))
    stillhand("diagnose", recording, "--input", "u", "--output", "y", "--model", "arx", "--json", out)
    answer = json.loads(out.read_text())
    return answer["verdict"], [effect["kind"] for effect in answer["effects"]]


def most_allowed(problems, rate):
    """The largest count of alarms that a true rate of `rate` reaches or passes with a probability above 5 %."""
    tail, count = 1.0, 0
    while True:
        tail -= math.comb(problems, count) * rate**count * (1.0 - rate) ** (problems - count)
        if tail <= 0.05:
            return count
        count += 1


def survey(scratch, bodies, draws, random, verbose):
    noises = {name: noise_of(scratch, DATA / f"{source}.csv", channel) for name, (source, channel) in NOISES.items()}
    counts = collections.defaultdict(collections.Counter)
    for body in bodies:
        source, name, output, rate_hz = BODIES[body]
        whole, answer = linear_output(scratch, DATA / f"{source}.csv", name, output, rate_hz)
        for noise in noises:
            if NOISES[noise][0] == source:
                continue
            for level in LEVELS:
                for _ in range(draws):
                    at = random.integers(0, len(whole) - ROWS + 1)
                    force = answer[at:at + ROWS]
                    disturbance = random.choice([-1.0, 1.0]) * stretch(noises[noise], ROWS, random)
                    disturbance *= level * numpy.std(force) / numpy.std(disturbance)
                    said, kinds = verdict(scratch, whole[at:at + ROWS], force + disturbance, rate_hz)
                    alone = bool(kinds) and set(kinds) <= OF_TIME_ALONE
                    said = "effects of time alone" if alone else said
                    counts[body, noise].update(["problems", said, *kinds])
                    if verbose:
                        print(f"{body}, {noise}, {level}, row {at}: {said} {kinds}", file=sys.stderr, flush=True)
    return counts


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--draws", type=int, default=3, help="problems for each body, noise and level")
    parser.add_argument("--body", choices=BODIES, action="append", help="this one; may be given again")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rate", type=float, default=0.05, help="the rate of false alarms asked for")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    needs("car_ride.csv")
    with tempfile.TemporaryDirectory() as holder:
        random = numpy.random.default_rng(options.seed)
        counts = survey(pathlib.Path(holder), options.body or BODIES, options.draws, random, options.verbose)
    shown = ("problems", "effects found", "effects of time alone", "unexplained residual")
    print("| body | noise | problems | alarms | of time alone | unexplained | kinds |\n" + "| --- " * 7 + "|")
    total = collections.Counter()
    for (body, noise), count in counts.items():
        total.update(count)
        kinds = ", ".join(f"{kind} {n}" for kind, n in count.most_common() if kind not in (*shown, "nothing missing"))
        print(f"| {body} | {noise} | {' | '.join(str(count[each]) for each in shown)} | {kinds} |")
    print(f"| all | | {' | '.join(str(total[each]) for each in shown)} | |")
    allowed = most_allowed(total["problems"], options.rate)
    print(f"at a rate of {options.rate:g}, at most {allowed} alarms of {total['problems']} are chance")
    sys.exit(1 if total["effects found"] > allowed else 0)


if __name__ == "__main__":
    main()
