#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Shapes that no kind of effect has: what the residual engine says of them, and what its model predicts.

Pairs of recordings from build/tests/planted_recordings, the same body on two rides without an effect, get one that is
computed here, from equations that the engine does not have: a gain that falls where the vibration of the last seconds
is large, a gain that wanders, a spring that is met on one side alone, a damping that depends on the position. The table
has a row for each shape and strength (RMS of what the shape adds, over that of the force): how often something is
reported, how often a free form of the right channel comes first, the error on held-out data after over before, and the
error of `predict` on the second ride over that of the linear model, median and worst.

    STILLHAND_BUILD=build python3 tests/benchmark/free_forms.py          # 12 pairs a row, about 15 minutes
    STILLHAND_BUILD=build python3 tests/benchmark/free_forms.py --count 3
"""
import argparse
import concurrent.futures
import json
import pathlib
import sys
import tempfile

import numpy

from no_harm import BUILD, error_of, run

STILLHAND = BUILD / "bin" / "stillhand"
RATE_HZ = 100.0
STRENGTHS = (0.1, 0.25)


def low_pass(x, time_s):
    """First order, from its mean on."""
    keep = numpy.exp(-1.0 / (time_s * RATE_HZ))
    out = numpy.empty_like(x)
    state = x.mean()
    for n, value in enumerate(x):
        state = keep * state + (1.0 - keep) * value
        out[n] = state
    return out


# What is added to one ride; `first` has the channels of the pair's first ride, from which the shape's places are taken.


def falls_with_vibration(ride, first, _):
    """- F (s - mean s), s the RMS of a_y over the last two seconds: the hand gives way."""
    size = [numpy.sqrt(low_pass(each["a_y"] ** 2, 2.0)) for each in (ride, first)]
    return -ride["f"] * (size[0] - size[1].mean())


def wanders(ride, _, random):
    """F times noise behind a low-pass of 5 s; another one in each ride."""
    return ride["f"] * low_pass(random.standard_normal(ride["f"].size), 5.0)


def one_sided(ride, first, _):
    """max(0, theta - its 75 % quantile)."""
    return numpy.maximum(0.0, ride["theta"] - numpy.quantile(first["theta"], 0.75))


def damped_in_the_middle(ride, first, _):
    """omega exp(-(theta/w)^2), w half the standard deviation of theta."""
    theta = ride["theta"] - first["theta"].mean()
    return ride["omega"] * numpy.exp(-((theta / (0.5 * first["theta"].std())) ** 2))


# Each with the channels that a free form of it is over; no form is over time.
SHAPES = {"gain falls with vibration": (falls_with_vibration, ("a_y",)), "gain wanders": (wanders, ()),
          "one-sided spring": (one_sided, ("theta",)),
          "damping by position": (damped_in_the_middle, ("omega", "theta"))}


def read(path):
    titles = path.read_text().split("\n", 1)[0]
    values = numpy.loadtxt(path, delimiter=",", skiprows=1)
    return titles, values, {title.split(" ")[0]: values[:, i].copy() for i, title in enumerate(titles.split(","))}


def altered(path, shape, strength, seed):
    """The pair with the shape in it; 0: without one."""
    pair = []
    first = read(path)[2]
    scale = None
    for number, each in enumerate((path, path.with_suffix(".again.csv"))):
        titles, values, ride = read(each)
        if strength > 0.0:
            added = SHAPES[shape][0](ride, first, numpy.random.default_rng(2 * seed + number))
            scale = scale or strength * first["f"].std() / added.std()
            values[:, list(ride).index("f")] += scale * added
        pair.append(each.with_name(f"{each.stem}-{shape.replace(' ', '_')}-{strength}.csv"))
        numpy.savetxt(pair[-1], values, delimiter=",", header=titles, comments="", fmt="%.9g")
    return pair


def judged(pair):
    seen, unseen = pair
    with tempfile.TemporaryDirectory() as holder:
        folder = pathlib.Path(holder)
        words = ("diagnose", seen, "--input", "a_y", "--output", "f", "--save")
        run(STILLHAND, *words, folder / "after.json", "--json", folder / "out.json")
        run(STILLHAND, *words, folder / "before.json", "--most-effects", 0)
        found = json.loads((folder / "out.json").read_text())
        found["ratio"] = found["final"]["heldout_rmse"] / found["baseline"]["heldout_rmse"]
        found["again"] = error_of(folder / "after.json", unseen, folder)[0] / error_of(folder / "before.json", unseen,
                                                                                      folder)[0]
        return found


def is_right(found, channels):
    """The first effect is a free form over one of these channels."""
    first = found["effects"][0]
    return first["kind"] == "free_form" and first["channel"] in channels


def row(shape, strength, found, channels):
    some = [each for each in found if each["effects"]]
    right = [each for each in some if is_right(each, channels)]
    others = sorted({each["effects"][0]["kind"] for each in some if each not in right})
    again = [each["again"] for each in found]
    print(f"| {shape} | {strength:g} | {len(some)} of {len(found)} | {len(right)}"
          f"{' (else ' + ', '.join(others) + ')' if others else ''} | "
          f"{numpy.median([each['ratio'] for each in found]):.2f} | {numpy.median(again):.2f}, {max(again):.2f} |",
          flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=12, help="pairs a row")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--snr", type=float, default=20.0, help="force over noise [dB]")
    arguments = parser.parse_args()
    print("| shape | strength | reported | first as a free form of the channel | after / before | on another ride |\n"
          "| --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(2) as pool:
        run(BUILD / "tests" / "planted_recordings", "--out", folder, "--count", arguments.count, "--kind", "none",
            "--twice", "--seed", arguments.seed, "--snr", arguments.snr, "--noise", "white", "--rate", RATE_HZ)
        plain = sorted(pathlib.Path(folder).glob("rec_????.csv"))
        for shape, (_, channels) in SHAPES.items():
            for strength in STRENGTHS:
                pairs = [altered(path, shape, strength, seed) for seed, path in enumerate(plain)]
                row(shape, strength, list(pool.map(judged, pairs)), channels)
        pairs = [altered(path, "no effect", 0.0, seed) for seed, path in enumerate(plain)]
        row("no effect", 0.0, list(pool.map(judged, pairs)), ())
    return 0


if __name__ == "__main__":
    sys.exit(main())
