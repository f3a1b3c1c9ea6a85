#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""No harm: a model with the effects that were found predicts an unseen recording no worse than the linear one.

Pairs of recordings from build/tests/planted_recordings: the same body and effect on two rides. `diagnose` sees the
first one, `predict` runs its model and the linear baseline on the second one. The table has a row for each kind; the
exit status is 1 where a model with effects is more than 5 % worse than the linear one in any case.

    STILLHAND_BUILD=build python3 tests/benchmark/no_harm.py            # 152 pairs, about 20 minutes
    STILLHAND_BUILD=build python3 tests/benchmark/no_harm.py --short    # three pairs, about 20 s
    STILLHAND_BUILD=build python3 tests/benchmark/no_harm.py --kinds drift,tone --seed 7 --verbose
"""
import argparse
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", SOURCE / "build"))
WORST = 1.05
KINDS = ("delay", "resonance", "coupled_input", "coulomb_friction", "nonlinear_stiffness", "asymmetry", "hysteresis",
         "dead_zone", "output_saturation", "input_saturation", "position_ripple", "tone", "drift", "time_varying_gain",
         "regime_change", "clock_drift", "bilinear", "transients", "none")
# Noise of 5, 10, 16 and 30 % of the force, and what else is rough, in turn.
CONDITIONS = (
    dict(snr=26, strength=0.25),
    dict(snr=20, strength=0.1, again_length=60),
    dict(snr=16, strength=0.25, gaps=True),
    dict(snr=10.5, strength=0.25, noise="low_pass"),
    dict(snr=20, strength=0.25, rate=50, length=90),
    dict(snr=26, strength=0.1, jitter=True),
    dict(snr=20, strength=0.25, rate=500, again_rate=1000, length=60),
    dict(snr=16, strength=0.1, rate=2000, length=40, again_length=30),
)
SHORT = (("drift", 0), ("clock_drift", 4), ("transients", 2))
JITTER_ROWS = 5  # a jittered recording takes one of five rows


def run(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"no_harm: {' '.join(str(word) for word in words)}\n{done.stderr.strip()}")
    return done.stdout


def jittered(path, random):
    """Every fifth row, or the one before or after it."""
    rows = path.read_text().splitlines()
    count = (len(rows) - 1) // JITTER_ROWS
    taken = JITTER_ROWS * numpy.arange(1, count) + random.integers(-1, 2, count - 1)
    path.write_text("\n".join([rows[0], *(rows[1 + row] for row in taken)]) + "\n")


def planted(folder, kind, condition, seed):
    rate = condition.get("rate", 100) * (JITTER_ROWS if condition.get("jitter") else 1)
    words = ["--kind", kind, "--snr", condition["snr"], "--strength", condition["strength"], "--seed", seed, "--rate", rate,
             "--least-evidence", 0, "--noise", condition.get("noise", "white"), "--length", condition.get("length", 120)]
    for name in ("again_length", "again_rate"):
        if name in condition:
            words += ["--" + name.replace("_", "-"), condition[name]]
    run(BUILD / "tests" / "planted_recordings", "--out", folder, "--count", 1, "--twice", *words,
        *(["--gaps"] if condition.get("gaps") else []))
    pair = folder / "rec_0001.csv", folder / "rec_0001.again.csv"
    if condition.get("jitter"):
        random = numpy.random.default_rng(seed)
        for path in pair:
            jittered(path, random)
    return pair


def column(path, name):
    with open(path, newline="") as file:
        rows = csv.reader(file)
        titles = [title.split(" [")[0] for title in next(rows)]
        at, time = titles.index(name), titles.index("t")
        values = numpy.array([(row[time], row[at]) for row in rows], dtype=float)
    return values[:, 0], values[:, 1]


def error_of(model, unseen, folder):
    """Root mean square of measured - predicted, and what predict noted."""
    out = folder / "prediction.csv"
    said = run(BUILD / "bin" / "stillhand", "predict", model, unseen, "--out", out)
    time, predicted = column(out, "f_model")
    # A jittered recording is predicted on a grid.
    measured = numpy.interp(time, *column(unseen, "f"))
    notes = [line[len("note: "):] for line in said.splitlines() if line.startswith("note: ")]
    return float(numpy.sqrt(numpy.mean((measured - predicted) ** 2))), notes


class Pair:
    def __init__(self, kind, which, seed):
        self.kind, self.which, self.seed = kind, which, seed
        with tempfile.TemporaryDirectory() as holder:
            folder = pathlib.Path(holder)
            seen, unseen = planted(folder, kind, CONDITIONS[which], seed)
            stillhand, out = BUILD / "bin" / "stillhand", folder / "out.json"
            run(stillhand, "diagnose", seen, "--save", folder / "after.json", "--json", out)
            run(stillhand, "diagnose", seen, "--save", folder / "before.json", "--most-effects", 0)
            self.found = [effect["kind"] for effect in json.loads(out.read_text())["effects"]]
            self.before, _ = error_of(folder / "before.json", unseen, folder)
            self.after, self.notes = error_of(folder / "after.json", unseen, folder)
        self.ratio = self.after / self.before

    def __str__(self):
        return (f"{self.kind} condition {self.which} seed {self.seed}: found {self.found or 'nothing'}, "
                f"{self.before:.4g} -> {self.after:.4g} N ({self.ratio:.3f})")


def print_table(pairs):
    print("| planted | pairs | before, median [N] | after, median [N] | ratio, median | worst |\n| --- | --- | --- | --- | --- | --- |")
    for kind in dict.fromkeys(pair.kind for pair in pairs):
        own = [pair for pair in pairs if pair.kind == kind]
        before, after, ratio = (numpy.median([getattr(pair, name) for pair in own]) for name in ("before", "after", "ratio"))
        print(f"| {kind} | {len(own)} | {before:.3f} | {after:.3f} | {ratio:.3f} | {max(pair.ratio for pair in own):.3f} |")
    ratios = [pair.ratio for pair in pairs]
    print(f"{len(pairs)} pairs: ratio {numpy.median(ratios):.3f} in the median, {max(ratios):.3f} at worst; "
          f"{sum(ratio > WORST for ratio in ratios)} above {WORST}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--short", action="store_true", help="three pairs")
    parser.add_argument("--kinds", default=",".join(KINDS), help="kinds, comma-separated")
    parser.add_argument("--conditions", default=",".join(str(i) for i in range(len(CONDITIONS))))
    parser.add_argument("--seed", type=int, default=1, help="of the first pair")
    parser.add_argument("--verbose", action="store_true", help="a line for each pair")
    words = parser.parse_args()
    cases = SHORT if words.short else [(kind, int(which)) for kind in words.kinds.split(",")
                                       for which in words.conditions.split(",")]
    pairs = []
    for number, (kind, which) in enumerate(cases):
        pairs.append(Pair(kind, which, 1000 * words.seed + number))
        if words.verbose:
            print(pairs[-1], *pairs[-1].notes, sep="\n    ", flush=True)
    print_table(pairs)
    worse = [pair for pair in pairs if not pair.ratio <= WORST]
    for pair in worse:
        print(f"no_harm: worse than the linear model: {pair}", file=sys.stderr)
    sys.exit(1 if worse else 0)


if __name__ == "__main__":
    main()
