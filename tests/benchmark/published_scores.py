#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The residual engine on public benchmark sets, next to the scores that others published and two plain models.

One call a set, without a setting: `stillhand diagnose TRAIN --save MODEL`, then `stillhand predict MODEL TEST
--start-from-output N`, N the samples that the benchmark gives away. The score is the free-run RMS error of the test
file behind these samples, in its own unit: of the linear model, and of the model with the effects that are carried. Two
peers are fitted here by least squares, each with its size chosen on the last quarter of the training file: a long
impulse response (FIR, ridge), and a polynomial difference model (NARX) that predicts from its own output. Where there
is no linear model, the mean of the training file's output takes its place.

The files are not part of the project: `<set>_train.csv` and `<set>_test.csv` in --folder or in its benchmarks/.

Exit status: 0; 1 where the effects make the test error more than 5 % larger, from that start or without one; 77 where
no file is to be had.

    STILLHAND_BUILD=build python3 tests/benchmark/published_scores.py [--only SET] [--pictures DIR]
"""
import argparse
import dataclasses
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy

from peers import ImpulseResponse, Narx, chosen, rms

SKIPPED = 77
NO_HARM = 1.05
SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", SOURCE / "build"))
FOLDER = pathlib.Path(os.environ.get("STILLHAND_DATA", SOURCE.parent / "shared/data"))


@dataclasses.dataclass(frozen=True)
class Set:
    """A benchmark: its columns, the unit and scale of its score, what is known of its physics."""

    input: str
    output: str
    given: int
    unit: str
    scale: float  # of the score's unit over the prediction's, which is SI's
    known: str
    published: str = "-"
    train: str = ""  # set whose training file is used
    raw: float = 1.0  # of the score's unit over the file's


# The published scores: arXiv 2405.10779, tables 3 and 4; linear, then the best.
SETS = {
    "tanks": Set("u", "y", 5, "V", 1, "outflow by the root of a level, overflow", "0.588, 0.191"),
    "emps_forward": Set("u", "y", 20, "mm", 1, "an integrator, Coulomb friction, an offset", "5.53, 0.452"),
    "wiener_hammerstein": Set("u", "y", 50, "mV", 1e3, "filter, diode, filter", "43.4, 0.241", raw=1e3),
    "ced_prbs1": Set("u", "y", 4, "V", 1, "the sensor gives the size of the speed"),
    "ced_prbs2": Set("u", "y", 4, "V", 1, "the same"),
    "ced_prbs3": Set("u", "y", 4, "V", 1, "the same"),
    "heating": Set("u", "y", 5, "degC", 1, "power by the square of the voltage"),
    "hydraulic_actuator": Set("u", "p", 10, "MPa", 1, "valve: flow by the root of a pressure"),
    "ball_and_beam": Set("angle", "x", 5, "mm", 1e3, "two integrators", raw=1e3),
    "silverbox": Set("u", "y", 50, "mV", 1e3, "an odd cubic spring", "6.95, 0.301", raw=1e3),
    "silverbox_arrow": Set("u", "y", 50, "mV", 1e3, "the same, beyond the amplitude of the training", "14.2, 0.60",
                           train="silverbox", raw=1e3),
}


def file_of(folder, name):
    found = [path for path in (folder / "benchmarks" / name, folder / name) if path.is_file()]
    return found[0] if found else None


def columns_of(path, names):
    with open(path) as file:
        titles = [title.split(" [")[0].strip() for title in file.readline().split(",")]
    table = numpy.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
    return [table[:, titles.index(name)] for name in names]


def peer_error(kind, train, test, given):
    return rms(chosen(kind, *train, given).run(test[0], test[1].copy(), given)[given:] - test[1][given:])


class Failed(Exception):
    pass


def stillhand(*words):
    run = subprocess.run([str(BUILD / "bin" / "stillhand"), *map(str, words)], capture_output=True, text=True)
    if run.returncode:
        raise Failed(run.stderr.strip())


def named(verdict, model):
    """The kinds that were found, in brackets those that no other recording shares."""
    left = {(each["kind"], each["form"]) for each in model.get("carried", {}).get("left_out", [])}
    words = [f"({each['kind']})" if (each["kind"], each.get("form")) in left else each["kind"]
             for each in verdict["effects"]]
    return ", ".join(words) or verdict["verdict"]


class Score:
    """One diagnosis and the errors on the test file, in the benchmark's unit."""

    def __init__(self, bench, train, test, scratch, pictures):
        began = time.monotonic()
        ask = ["diagnose", train, "--input", bench.input, "--output", bench.output]
        page = ["--report", pictures] if pictures else []
        picture = ["--picture", pictures / "unseen.png"] if pictures else []
        stillhand(*ask, "--save", scratch / "model.json", "--json", scratch / "verdict.json", *page)
        self.seconds = time.monotonic() - began
        self.effects = named(*(json.loads((scratch / name).read_text()) for name in ("verdict.json", "model.json")))
        columns = [columns_of(path, [bench.input, bench.output]) for path in (train, test)]
        asked = ["--start-from-output", bench.given]
        self.carried = self.error("model.json", bench, test, scratch, [*asked, *picture])
        try:
            stillhand(*ask, "--most-effects", 0, "--save", scratch / "linear.json")
            self.linear_model = ""
            self.linear = self.error("linear.json", bench, test, scratch, asked)
            rested = [self.error(model, bench, test, scratch, []) for model in ("model.json", "linear.json")]
            self.harm = max(self.carried / self.linear, rested[0] / rested[1])
        except Failed:
            self.linear_model = " (none: a constant)"
            self.linear = bench.raw * rms(columns[1][1][bench.given:] - columns[0][1].mean())
            self.harm = self.carried / self.linear
        self.fir, self.narx = (bench.raw * peer_error(kind, *columns, bench.given) for kind in (ImpulseResponse, Narx))

    @staticmethod
    def error(model, bench, test, scratch, words):
        stillhand("predict", scratch / model, test, "--out", scratch / "out.csv", *words)
        predicted, measured = columns_of(scratch / "out.csv", [f"{bench.output}_model", bench.output])
        return bench.scale * rms((predicted - measured)[bench.given:])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=pathlib.Path, default=FOLDER, help="the files (default: STILLHAND_DATA)")
    parser.add_argument("--only", choices=SETS, action="append", help="this set; may be given again")
    parser.add_argument("--pictures", type=pathlib.Path,
                        help="folder for a folder a set: the page of its effects, with their curves and bands, and a "
                             "picture of the test file; the time is then that of the page, too")
    options = parser.parse_args()
    wrong, rows = [], 0
    print("| set, known of it | named (in brackets: not carried) | published: linear, best | linear, with effects "
          "| FIR, NARX | time [s] |\n| --- | --- | --- | --- | --- | --- |")
    for name in options.only or SETS:
        bench = SETS[name]
        train = file_of(options.folder, f"{bench.train or name}_train.csv")
        test = file_of(options.folder, f"{name}_test.csv") or file_of(options.folder, f"{name}.csv")
        if train is None or test is None:
            print(f"skipped: {name}: no files in {options.folder}")
            continue
        rows += 1
        pictures = options.pictures / name if options.pictures else None
        with tempfile.TemporaryDirectory() as scratch:
            try:
                score = Score(bench, train, test, pathlib.Path(scratch), pictures)
            except Failed as why:
                print(f"| {name}: {bench.known} | {str(why).partition(' (')[0]} | {bench.published} {bench.unit} | | | |")
                continue
        print(f"| {name}: {bench.known} | {score.effects} | {bench.published} {bench.unit} | {score.linear:.3g}{score.linear_model}, "
              f"{score.carried:.3g} | {score.fir:.3g}, {score.narx:.3g} | {score.seconds:.1f} |", flush=True)
        if score.harm > NO_HARM:
            wrong.append(f"{name}: the effects harm on the test file")
    for line in wrong:
        print(f"published_scores: {line}", file=sys.stderr)
    sys.exit(1 if wrong else 0 if rows else SKIPPED)


if __name__ == "__main__":
    main()
