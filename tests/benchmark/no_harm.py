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
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy

from carried_chain import Chain
from carried_pairs import Pair
from carried_table import WORST, ratio
from recorded_data import BUILD, SOURCE

KINDS = (*re.findall(r'"(\w+)"', (SOURCE / "tests/planted/kind.hpp").read_text()), "none")
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
    words += ["--gaps"] if condition.get("gaps") else []
    subprocess.run([BUILD / "tests" / "planted_recordings", "--out", folder, "--count", "1", "--twice", *map(str, words)],
                   check=True, stdout=subprocess.DEVNULL)
    pair = folder / "rec_0001.csv", folder / "rec_0001.again.csv"
    if condition.get("jitter"):
        random = numpy.random.default_rng(seed)
        for path in pair:
            jittered(path, random)
    return Pair(kind, *pair, settle_s=0.0)


def judged(kind, which, seed):
    """A row of carried_chain.py."""
    with tempfile.TemporaryDirectory() as holder:
        folder = pathlib.Path(holder)
        row = Chain(planted(folder, kind, CONDITIONS[which], seed), folder / "chain").row(("diagnose", "predict"))
    return row | {"case": f"{kind} condition {which} seed {seed}", "ratio": ratio(row)}


def line(row):
    if row["errors"]:
        return f"{row['case']}: {row['errors']}"
    found = [effect["kind"] for effect in row["effects"]] or "nothing"
    return f"{row['case']}: found {found}, {row['unseen_linear']:.4g} -> {row['unseen_carried']:.4g} N ({row['ratio']:.3f})"


def print_table(rows):
    rows = [row for row in rows if row["ratio"] is not None]
    print("| planted | pairs | before, median [N] | after, median [N] | ratio, median | worst |\n| --- | --- | --- | --- | --- | --- |")
    for kind in dict.fromkeys(row["record"] for row in rows):
        own = [row for row in rows if row["record"] == kind]
        before, after, middle = (numpy.median([row[name] for row in own])
                                 for name in ("unseen_linear", "unseen_carried", "ratio"))
        print(f"| {kind} | {len(own)} | {before:.3f} | {after:.3f} | {middle:.3f} | {max(row['ratio'] for row in own):.3f} |")
    ratios = [row["ratio"] for row in rows]
    print(f"{len(rows)} pairs: ratio {numpy.median(ratios):.3f} in the median, {max(ratios):.3f} at worst; "
          f"{sum(each > WORST for each in ratios)} above {WORST}")


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
    rows = []
    for number, (kind, which) in enumerate(cases):
        rows.append(judged(kind, which, 1000 * words.seed + number))
        if words.verbose:
            print(line(rows[-1]), *rows[-1].get("notes", ()), sep="\n    ", flush=True)
    print_table(rows)
    worse = [row for row in rows if row["ratio"] is None or not row["ratio"] <= WORST]
    for row in worse:
        print(f"no_harm: worse than the linear model: {line(row)}", file=sys.stderr)
    sys.exit(1 if worse else 0)


if __name__ == "__main__":
    main()
