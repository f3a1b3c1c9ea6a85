#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How large an effect has to be for the residual engine to find it, by kind and by noise.

build/tests/power_curves plants effects of any size under five noises and asks the engine; none is drawn again because
it is weak. The size of an effect is what a linear model of fourth order leaves of it (RMS), over the noise (RMS). Two
logistic curves are fitted to the answers, "something was found" and "the right kind and channel, and nothing else":

    ln(P / (1 - P)) = a_kind + c_noise + b_noise ln(size)

Printed are the false alarms by noise, the size at which each kind is found in half and in nine of ten recordings of
white noise, and how much larger it has to be under the other noises.

    STILLHAND_BUILD=build python3 tests/benchmark/power_curves.py                # 720 and 2,000: two hours on two cores
    STILLHAND_BUILD=build python3 tests/benchmark/power_curves.py --rows FILE    # of an earlier run
"""
import argparse
import csv
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy

from recorded_data import BUILD

RIDGE = 0.05  # a kind that is always found has no curve of its own: pulled to the common one


def rows_of(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        for name in ("strength", "noise_over_force", "size_over_noise", "limit_over_noise", "half_over_noise", "seconds"):
            row[name] = float(row[name])
        row["found"] = row["found"].split("+") if row["found"] else []
        row["right"] = row["right"] == "1"
    return rows


class Curves:
    """The logistic model, by penalised maximum likelihood (Newton's steps)."""

    def __init__(self, rows, answer):
        self.kinds = sorted({row["kind"] for row in rows})
        self.noises = sorted({row["noise"] for row in rows}, key=lambda noise: (noise != "white", noise))
        x = numpy.array([self.columns(row["kind"], row["noise"], row["size_over_noise"]) for row in rows])
        y = numpy.array([float(answer(row)) for row in rows])
        # Free: the common level and slope, the first two columns.
        penalty = RIDGE * numpy.eye(x.shape[1])
        penalty[0, 0] = penalty[1, 1] = 1e-6
        self.numbers = numpy.zeros(x.shape[1])
        for _ in range(100):
            p = 1.0 / (1.0 + numpy.exp(-x @ self.numbers))
            slope = x.T @ (y - p) - penalty @ self.numbers
            curvature = (x.T * (p * (1.0 - p))) @ x + penalty
            step = numpy.linalg.solve(curvature, slope)
            self.numbers += step * min(1.0, 2.0 / max(abs(step)))
            if max(abs(step)) < 1e-9:
                break

    def columns(self, kind, noise, size):
        log = math.log(max(size, 1e-4))
        of_noise = [float(noise == each) for each in self.noises]
        return [1.0, log, *(float(kind == each) for each in self.kinds), *of_noise, *(log * each for each in of_noise)]

    def size_at(self, share, kind, noise):
        level = float(numpy.dot(self.columns(kind, noise, 1.0), self.numbers))
        slope = float(numpy.dot(self.columns(kind, noise, math.e), self.numbers)) - level
        return math.exp((math.log(share / (1.0 - share)) - level) / slope)


def wilson(count, of):
    """95 % of a share."""
    z, p = 1.96, count / of
    middle = (p + z * z / (2 * of)) / (1 + z * z / of)
    half = z * math.sqrt(p * (1 - p) / of + z * z / (4 * of * of)) / (1 + z * z / of)
    return max(0.0, middle - half), min(1.0, middle + half)


def share(count, of):
    low, high = wilson(count, of)
    return f"{count} of {of}, {100 * count / of:.2f} % ({100 * low:.2f} to {100 * high:.2f})"


def print_alarms(rows):
    noises = sorted({row["noise"] for row in rows}, key=lambda noise: (noise != "white", noise))
    print("| noise, no effect planted | something found | which |\n| --- | --- | --- |")
    for noise in [*noises, "all"]:
        own = [row for row in rows if noise in (row["noise"], "all")]
        alarms = [row for row in own if row["found"]]
        kinds = sorted(row["found"][0] for row in alarms)
        named = ", ".join(f"{kind} {kinds.count(kind)}" for kind in dict.fromkeys(kinds))
        print(f"| {noise} | {share(len(alarms), len(own))} | {named if noise == 'all' else ''} |")


def print_sizes(rows, found, right):
    print("\n| kind | recordings | found | right | size found in 50, 90 % | named right in 50, 90 % |\n"
          "| --- | --- | --- | --- | --- | --- |")
    for kind in found.kinds:
        own = [row for row in rows if row["kind"] == kind]
        sizes = [curves.size_at(at, kind, "white") for curves in (found, right) for at in (0.5, 0.9)]
        print(f"| {kind} | {len(own)} | {sum(bool(row['found']) for row in own)} | {sum(row['right'] for row in own)} | "
              f"{sizes[0]:.2f}, {sizes[1]:.2f} | {sizes[2]:.2f}, {sizes[3]:.2f} |")
    print("\n| noise | found | right | size over that of white noise, found in 50 % | limit quoted over noise, median |\n"
          "| --- | --- | --- | --- | --- |")
    for noise in found.noises:
        own = [row for row in rows if row["noise"] == noise]
        ratio = numpy.median([found.size_at(0.5, kind, noise) / found.size_at(0.5, kind, "white")
                              for kind in found.kinds])
        limits = [row["limit_over_noise"] for row in own if not row["found"]]
        print(f"| {noise} | {sum(bool(row['found']) for row in own)} of {len(own)} | {sum(row['right'] for row in own)} | "
              f"{ratio:.2f} | {numpy.median(limits) if limits else float('nan'):.3f} |")


def print_limits(rows):
    """How often an effect is found that is smaller or larger than the kind's own planted limit says.

    A kind that the model has already is hardly ever found once more, so its limit is infinite: it is left out.
    """
    print("\n| size over what the verdict quotes for its kind | found |\n| --- | --- |")
    edges = (0.0, 0.25, 0.5, 1.0, 2.0, 4.0, math.inf)
    for low, high in zip(edges, edges[1:]):
        own = [row for row in rows if 0.0 < row["half_over_noise"] < math.inf
               and low <= row["size_over_noise"] / row["half_over_noise"] < high]
        if own:
            print(f"| {low:g} to {high:g} | {share(sum(bool(row['found']) for row in own), len(own))} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=8, help="recordings of each kind under each noise")
    parser.add_argument("--none", type=int, default=400, help="recordings without an effect under each noise")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rows", type=pathlib.Path, help="rows of an earlier run, instead of a new one")
    parser.add_argument("--keep", type=pathlib.Path, help="keeps the rows there")
    words = parser.parse_args()
    with tempfile.TemporaryDirectory() as holder:
        path = words.rows or words.keep or pathlib.Path(holder) / "rows.csv"
        if not words.rows:
            done = subprocess.run([str(BUILD / "tests" / "power_curves"), "--out", str(path), "--count",
                                   str(words.count), "--none", str(words.none), "--seed", str(words.seed)])
            if done.returncode:
                return done.returncode
        rows = rows_of(path)
    without = [row for row in rows if row["kind"] == "none"]
    planted = [row for row in rows if row["kind"] != "none"]
    seconds = [row["seconds"] for row in rows]
    print(f"{len(rows)} recordings; a diagnosis took {numpy.median(seconds):.2f} s of one core in the median, "
          f"{max(seconds):.1f} s at most\n")
    if without:
        print_alarms(without)
    if planted:
        found, right = Curves(planted, lambda row: bool(row["found"])), Curves(planted, lambda row: row["right"])
        print_sizes(planted, found, right)
        print_limits(planted)
    return 0


if __name__ == "__main__":
    sys.exit(main())
