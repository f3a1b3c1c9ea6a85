#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The residual engine on measured recordings that anybody can get, next to what is known of them.

The recordings are inside Debian packages. The script gets the packages with `apt-get download` (nothing is installed),
or takes them from --folder. SOURCES names package, file and licence of each. The project holds none of the data.

The columns: the effects found; the error on blocks that the fit did not see, before and after; the error on a record
that nothing was fitted to, without its first tenth (the start is unknown to every model). The last column has what is
known or published, and what a linear difference model by ordinary least squares leaves of the unseen record.

The engine's bounds in seconds mean a hand. Where a recording is slower, or its rate is not published, the CSV has 10
rows a second (PERIOD_S); `--period` tries another one.

Exit status: 0; 1 where a file is not the one of the RESULTS' figures, or where the effects make the error on the unseen
record more than 5 % larger; 77 where no recording is to be had.

    STILLHAND_BUILD=build python3 tests/benchmark/public_recordings.py                       # all, about a minute
    STILLHAND_BUILD=build python3 tests/benchmark/public_recordings.py --folder DIR          # with your own downloads
    STILLHAND_BUILD=build python3 tests/benchmark/public_recordings.py --only dryer --keep DIR   # leaves the CSV files
"""
import argparse
import bz2
import csv
import gzip
import hashlib
import json
import math
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

import numpy

from recorded_data import SKIPPED, columns_of, stillhand

NO_HARM = 1.05
# What the CSV states. Published: dryer. Not published: robot_arm, cd_arm. Slower: a day (ice_river).
PERIOD_S = {"dryer": 0.08, "robot_arm": 0.1, "cd_arm": 0.1, "ice_river": 0.1}
FOLDER = os.environ.get("STILLHAND_PUBLIC_DATA")

SLICOT = "usr/share/doc/libslicot-doc/examples/fortran77/"
SOURCES = {
    "dryer": dict(package="libslicot-doc", member=SLICOT + "IB01AD.dat.gz", licence="GPL-2+",
                  origin="DaISy 96-006, a laboratory hair dryer (Ljung)"),
    "robot_arm": dict(package="libslicot-doc", member=SLICOT + "IB03AD.dat.gz", licence="GPL-2+",
                      origin="DaISy 96-009, a flexible robot arm"),
    "cd_arm": dict(package="octave-control", member="usr/share/octave/packages/control-*/moen4.m", licence="GPL-3+",
                   origin="DaISy 96-007, the arm of a CD player"),
    "ice_river": dict(package="r-cran-tseries", member="usr/lib/R/site-library/tseries/data/ice.river.rda",
                      licence="GPL", origin="two Icelandic rivers and their weather, daily, 1972 to 1974 (Tong 1990)"),
}
# Of the CSV files that the figures in services/core/diagnosis/RESULTS.md were measured on.
SHA_256 = {
    "cd_arm_check.csv": "c3702146f9f68de3b3165017d930bd4cffe77a97aef73f7dc2de1ec0614a3f5a",
    "cd_arm_fit.csv": "565773823556d95e95599f5d99e96cd7ae3d139f926ceeafbaaa98faacf4d9f7",
    "dryer_check.csv": "76710ce0d407ef8923fafae2b2bb5b4142e281860dddf4baea6c4bd4cc68a301",
    "dryer_fit.csv": "794b23bac26167981532133e2d90a0524b006910a93d8c81d7f6acf5553e095c",
    "ice_river_check.csv": "3f2aa8599c5d29e271902c064b2ef0049986d631f6715a5406fd94150ff07b4f",
    "ice_river_fit.csv": "47573686d1014816549a04a80e1c83e03b5e890755c8235cad93ce8123a36e6d",
    "robot_arm_check.csv": "5dae7041f3f992b95d665b4b1d448725ef79488f5cf7dcdd9986c9d335cbb7d1",
    "robot_arm_fit.csv": "1577d2ef4d5c5aebc866797a657e6a333539cd487685f12d14098e60853d80ba",
}


class Missing(Exception):
    pass


def package_member(folder, source, scratch):
    """The file of a Debian package: from a .deb in `folder`, or from the archive that apt is set up for."""
    name = source["package"]
    found = sorted(folder.glob(f"{name}_*.deb")) if folder else []
    if not found:
        run = subprocess.run(["apt-get", "download", name], cwd=scratch, capture_output=True, text=True)
        found = sorted(scratch.glob(f"{name}_*.deb"))
        if not found:
            raise Missing(f"no package {name} in --folder, and apt-get download says: {run.stderr.strip()[-200:]}")
    opened = scratch / name
    subprocess.run(["dpkg-deb", "--extract", found[-1], opened], check=True)
    members = sorted(opened.glob(source["member"]))
    if not members:
        raise Missing(f"{found[-1].name} has no {source['member']}")
    return members[0]


def slicot_numbers(path):
    """The example's lines that hold one number: all of the first input, then all of the first output."""
    values = []
    for line in gzip.open(path, "rt"):
        words = line.split()
        if len(words) == 1:
            values.append(words[0])
    half = len(values) // 2
    return [values[:half], values[half:]]


def octave_columns(path, name):
    """The matrix `name` of the last test in an Octave file, as columns of text."""
    text = re.sub(r"^%!", "", path.read_text(), flags=re.MULTILINE)
    matrix = re.findall(rf"^ *{name} = \[([^\]]*)\]", text, flags=re.MULTILINE)[-1]
    return [list(column) for column in zip(*(row.split() for row in matrix.strip().splitlines()))]


def r_numbers(path):
    """The longest vector of real numbers in an R data file (bzip2, XDR): type 14, count, big-endian doubles."""
    raw = bz2.decompress(path.read_bytes())
    found = []
    for at in range(len(raw) - 8):
        if raw[at + 3] != 14:
            continue
        count = struct.unpack_from(">i", raw, at + 4)[0]
        if len(found) < count <= (len(raw) - at - 8) // 8:
            found = struct.unpack_from(f">{count}d", raw, at + 8)
    return [f"{number:.10g}" for number in found]


def write(path, period_s, titles, columns):
    """One CSV of the project's format; numbers stay the text that they were."""
    with open(path, "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["t [s]", *titles])
        for row, numbers in enumerate(zip(*columns)):
            out.writerow([f"{row * period_s:.10g}", *numbers])
    return path


def pair(out, name, period_s, titles, columns, middle=None):
    """The record that is fitted, and the one that is not: its second half, or what comes after `middle` rows."""
    middle = middle or len(columns[0]) // 2
    return [write(out / f"{name}_{part}.csv", period_s, titles, [column[rows] for column in columns])
            for part, rows in (("fit", slice(middle)), ("check", slice(middle, None)))]


def dryer(path, out, period_s):
    return pair(out, "dryer", period_s, ["voltage [V]", "temperature [V]"], slicot_numbers(path))


def robot_arm(path, out, period_s):
    return pair(out, "robot_arm", period_s, ["torque [-]", "acceleration [-]"], slicot_numbers(path))


def cd_arm(path, out, period_s):
    titles = ["force_1 [-]", "force_2 [-]", "deviation_1 [-]", "deviation_2 [-]"]
    return pair(out, "cd_arm", period_s, titles, octave_columns(path, "UY"))


def ice_river(path, out, period_s):
    """Two years to fit, and one that is not seen."""
    numbers = r_numbers(path)
    days = len(numbers) // 4
    lowland, glacier, precipitation, temperature = (numbers[days * i:days * (i + 1)] for i in range(4))
    titles = ["temperature [C]", "precipitation [mm]", "glacier_river [m^3/s]", "lowland_river [m^3/s]"]
    return pair(out, "ice_river", period_s, titles, [temperature, precipitation, glacier, lowland], middle=731)


# What is run on each CSV pair: inputs, output, what is known of the effect.
STUDIES = {
    "dryer": [dict(inputs="voltage", output="temperature", known="nearly linear, with a dead time")],
    "robot_arm": [dict(inputs="torque", output="acceleration", known="linear, two modes with little damping")],
    "cd_arm": [dict(inputs="force_1,force_2", output="deviation_1", known="linear, many modes, from a closed loop"),
               dict(inputs="force_1,force_2", output="deviation_2", known="the same")],
    "ice_river": [dict(inputs="temperature,precipitation", output="glacier_river", kink="temperature",
                       known="ice melts above 0 degrees only; the season"),
                  dict(inputs="temperature,precipitation", output="lowland_river", known="no glacier: little of it")],
}


def rms(values):
    return math.sqrt(float(numpy.mean(values**2)))


def with_columns(path, names, to):
    """The file without the other outputs: what is measured at the same time would be taken for a cause."""
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    at = [column for column, title in enumerate(rows[0]) if title.split(" [")[0] in ("t", *names)]
    with open(to, "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([row[column] for column in at] for row in rows)
    return to


class Reference:
    """A linear difference model by ordinary least squares, of the order that predicts the fit record's end best."""

    def __init__(self, inputs, output):
        part = 2 * len(output) // 3
        errors = {}
        for order in range(1, 13):
            numbers = self.fitted([u[:part] for u in inputs], output[:part], order)
            wrong = self.run(numbers, inputs, output, order)[part:] - output[part:]
            errors[order] = rms(wrong)
        self.order = min(errors, key=errors.get)
        self.numbers = self.fitted(inputs, output, self.order)

    @staticmethod
    def row(inputs, output, n, order):
        return numpy.concatenate([[1.0], output[n - order:n], *(u[n - order:n + 1] for u in inputs)])

    def fitted(self, inputs, output, order):
        matrix = numpy.array([self.row(inputs, output, n, order) for n in range(order, len(output))])
        return numpy.linalg.lstsq(matrix, output[order:], rcond=None)[0]

    def run(self, numbers, inputs, output, order):
        """A free run; only the first samples are the measured ones."""
        model = output.copy()
        for n in range(order, len(output)):
            model[n] = numpy.clip(numbers @ self.row(inputs, model, n, order), -1e6, 1e6)
        return model

    def decay(self):
        """The longest time in which a pole decays, in rows."""
        return -1.0 / math.log(max(abs(numpy.roots([1.0, *-self.numbers[self.order:0:-1]]))))

    def errors(self, inputs, output):
        return self.run(self.numbers, inputs, output, self.order) - output


class Study:
    """One diagnosis, and free runs of its model and of the linear one on the record that it did not see."""

    def __init__(self, scratch, fit, check, inputs, output):
        names = inputs.split(",")
        fit = with_columns(fit, [*names, output], scratch / "asked_fit.csv")
        check = with_columns(check, [*names, output], scratch / "asked_check.csv")
        self.scratch, self.check, self.output = scratch, check, output
        words = ["diagnose", fit, "--input", inputs, "--output", output]
        stillhand(*words, "--save", scratch / "model.json", "--json", scratch / "out.json")
        stillhand(*words, "--most-effects", 0, "--save", scratch / "linear.json")
        self.verdict = json.loads((scratch / "out.json").read_text())
        self.measured = columns_of(check, [output])[0]
        self.reference = Reference(columns_of(fit, names), columns_of(fit, [output])[0])
        self.wrong = {"effects": self.predicted("model.json"), "linear": self.predicted("linear.json"),
                      "by hand": self.reference.errors(columns_of(check, names), self.measured)}

    def kinked(self, fit, names, channel):
        """By hand, with the positive part of a channel as one more input: the error on the unseen record."""
        inputs = [columns_of(path, names) + [numpy.maximum(columns_of(path, [channel])[0], 0.0)]
                  for path in (fit, self.check)]
        wrong = Reference(inputs[0], columns_of(fit, [self.output])[0]).errors(inputs[1], self.measured)
        return rms(wrong[len(wrong) // 10:])

    def predicted(self, model):
        stillhand("predict", self.scratch / model, self.check, "--out", self.scratch / "prediction.csv")
        return columns_of(self.scratch / "prediction.csv", [f"{self.output}_model"])[0] - self.measured

    def settled(self, which):
        """Without the first tenth: the start is unknown to every model."""
        return rms(self.wrong[which][len(self.measured) // 10:])

    def rows(self, name, known):
        verdict, unit = self.verdict, self.verdict["output_unit"]
        spread = rms(self.measured - self.measured.mean())
        effects = ", ".join(f"{effect['kind']} ({effect['form']})" for effect in verdict["effects"])
        yield name, "verdict", f"{verdict['verdict']}: {effects}" if effects else verdict["verdict"], known
        for when, part in (("before", verdict["baseline"]), ("after", verdict["final"])):
            low, high = part["ci95"]
            yield name, f"RMSE {when}, held out [{unit}]", f"{part['heldout_rmse']:.4g} ({low:.4g} to {high:.4g})", ""
        for which, words in (("linear", "linear model"), ("effects", "with the effects")):
            found = self.settled(which)
            yield (name, f"unseen, {words}, settled [{unit}]", f"{found:.4g} ({100 * found / spread:.1f} %)",
                   f"{self.settled('by hand'):.4g} by hand, order {self.reference.order}, decays in "
                   f"{self.reference.decay():.3g} rows")
        for which in ("linear", "effects"):
            yield name, f"unseen, {which}, whole [{unit}]", f"{rms(self.wrong[which]):.4g}", ""


def prepared(name, options, scratch, out):
    """The CSV pair of a recording, and the names of those that are not the files of the RESULTS' figures."""
    path = package_member(options.folder, SOURCES[name], scratch)
    files = globals()[name](path, out, options.period or PERIOD_S[name])
    if options.period:
        return files, []
    return files, [file.name for file in files if SHA_256[file.name] != hashlib.sha256(file.read_bytes()).hexdigest()]


def judged(name, options, scratch, out):
    """Prints the rows of a recording; returns what is wrong."""
    (fit, check), other = prepared(name, options, scratch, out)
    wrong = [f"{each} is not the file of the figures in RESULTS" for each in other]
    for asked in STUDIES[name]:
        study = Study(scratch, fit, check, asked["inputs"], asked["output"])
        for row in study.rows(f"{name}, {asked['output']}", asked["known"]):
            print(f"| {' | '.join(row)} |", flush=True)
        if "kink" in asked:
            kinked = study.kinked(fit, asked["inputs"].split(","), asked["kink"])
            print(f"| {name}, {asked['output']} | unseen, by hand, kink at 0 of {asked['kink']} | {kinked:.4g} | |")
        if study.settled("effects") > NO_HARM * study.settled("linear"):
            wrong.append(f"{name}, {asked['output']}: the effects harm on the unseen record")
    return wrong


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=pathlib.Path, default=FOLDER and pathlib.Path(FOLDER),
                        help="your downloads: .deb files (default: STILLHAND_PUBLIC_DATA)")
    parser.add_argument("--only", choices=SOURCES, action="append", help="this recording; may be given again")
    parser.add_argument("--period", type=float, help="seconds between two rows of the CSV, instead of PERIOD_S")
    parser.add_argument("--keep", type=pathlib.Path, help="folder in which the CSV files stay")
    return parser.parse_args()


def main():
    options = arguments()
    wrong, recordings = [], 0
    print("| recording | figure | found | known or by hand |\n| --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as holder:
        scratch = pathlib.Path(holder)
        out = options.keep or scratch
        out.mkdir(parents=True, exist_ok=True)
        for name in options.only or SOURCES:
            try:
                wrong += judged(name, options, scratch, out)
                recordings += 1
            except Missing as why:
                print(f"skipped: {name}: {why}")
    for line in wrong:
        print(f"public_recordings: {line}", file=sys.stderr)
    sys.exit(1 if wrong else 0 if recordings else SKIPPED)


if __name__ == "__main__":
    main()
