# SPDX-License-Identifier: Apache-2.0
"""Pairs of recordings for carried_chain.py: one to fit, one that nothing was fitted to."""
import csv
import dataclasses
import json
import pathlib
import subprocess
import sys
import typing

import numpy
import scipy.signal

from recorded_data import BUILD, DATA, SOURCE

# Titles and units that recordings of others use, in SI.
TITLES = ("Time (s)=t [s]", "Acc Y (g)=a_y [g]", "Force (lbf)=f [lbf]", "Temp=temp [degC]")  # for --map
OTHERS = {"Time (s)": ("t", 1.0), "Force (lbf)": ("f", 4.4482216152605)}


def column(path, name):
    with open(path, newline="") as file:
        rows = csv.reader(file)
        titles = [OTHERS.get(title, (title.split(" [")[0], 1.0)) for title in next(rows)]
        where = [next(i for i, (own, _) in enumerate(titles) if own == wanted) for wanted in ("t", name)]
        values = numpy.array([[float(row[i]) * titles[i][1] for i in where] for row in rows])
    return values[:, 0], values[:, 1]


@dataclasses.dataclass
class Pair:
    name: str
    train: pathlib.Path
    test: pathlib.Path
    truth: typing.Optional[list] = None  # [{"kind", "right": [[kind, channel or null]]}]; [] no effect; None unknown
    noise_free: typing.Optional[pathlib.Path] = None
    known_least: typing.Optional[float] = None
    best_linear: typing.Optional[float] = None  # error of a long response on the unseen record
    edge_hz: typing.Optional[float] = None  # low-pass of every error on the unseen record, as that of known_least
    settle_s: float = 2.0  # a free run does not know the state at the start
    titles: tuple = ()  # --map of every verb
    too_small: bool = False  # a linear model does as well within 1 %: nothing named is right

    def least_possible(self):
        """RMS of what the inputs do not determine, over the rows that count."""
        if self.noise_free is None:
            return self.known_least
        time, measured = column(self.test, "f")
        _, free = column(self.noise_free, "f_noise_free")
        return self.rms(time, measured - free)

    def rms(self, time, error):
        """Root mean square of the unseen record's error over the rows that count."""
        if self.edge_hz:
            grid = numpy.arange(time[0], time[-1], 0.01)
            time, error = grid, numpy.interp(grid, time, error)
            low = scipy.signal.butter(4, self.edge_hz, fs=100.0, output="sos")
            error = scipy.signal.sosfiltfilt(low, error)
        return float(numpy.sqrt(numpy.mean(error[time - time[0] >= self.settle_s] ** 2)))


def folder_of_pairs(folder):
    """What fresh_bodies.py writes."""
    pairs = []
    for path in sorted(folder.glob("*.truth.json")):
        name = path.name.split(".")[0]
        label = json.loads(path.read_text())
        effects, errors = label["effects"], label["test"]
        truth = [{"kind": effect["kind"], "channel": effect["channel"], "known": effect["known"], "right": effect["right"]}
                 for effect in effects]
        pairs.append(Pair(name, folder / f"{name}_train.csv", folder / f"{name}_test.csv", truth,
                          folder / f"{name}_test.noise_free.csv", best_linear=errors["linear_rmse_n"],
                          too_small=errors["linear_rmse_n"] < 1.01 * errors["oracle_rmse_n"]))
    return pairs


def fresh(folder, count, seed):
    if not (folder / f"rec_{count:04d}.truth.json").is_file():
        subprocess.run([sys.executable, SOURCE / "tests" / "naming" / "fresh_bodies.py", "--count", str(count), "--seed",
                        str(seed), "--out", folder], check=True, stdout=subprocess.DEVNULL)
    return folder_of_pairs(folder)


# Truth and least possible error on the test file [N], 10 Hz wide: README of the recordings.
FIELD = {"noisy_c03": ("pinched Bouc-Wen spring", 1.64, [["hysteresis", None]]),
         "noisy_c09": ("sensor tilts with roll", 4.85, [["coupled_input", "roll"]]),
         "noisy_c14": ("temperature with a thermal lag", 3.28, [["coupled_input", "temp"]]),
         "noisy_d01": ("friction in the stick and a path of a_x", 3.88, None),
         "arm_friction_ride": ("Coulomb friction in the arm", None, [["coulomb_friction", None], ["hysteresis", None]])}


def field(folder):
    folder = pathlib.Path(folder) if folder else DATA / "field"
    pairs = []
    for name, (kind, least, right) in FIELD.items():
        ends = ("_a.csv", "_b.csv") if name == "arm_friction_ride" else ("_train.csv", "_test.csv")
        truth = [{"kind": kind, "right": right}] if right else [
            {"kind": "friction in the stick", "right": [["coulomb_friction", "omega"]]},
            {"kind": "path of a_x", "right": [["coupled_input", "a_x"]]}]
        pairs.append(Pair(name, folder / (name + ends[0]), folder / (name + ends[1]), truth, known_least=least,
                          edge_hz=least and 10.0, titles=TITLES if name == "arm_friction_ride" else ()))
    return [pair for pair in pairs if pair.train.is_file()]


def planted(folder, count, seed):
    if not folder.is_dir():
        subprocess.run([BUILD / "tests" / "planted_recordings", "--out", folder, "--count", str(count), "--seed", str(seed),
                        "--list", "--twice"], check=True, stdout=subprocess.DEVNULL)
    pairs = []
    for path in sorted(folder.glob("*.truth.json")):
        record = path.name.split(".")[0]
        label = json.loads(path.read_text())
        truth = []
        for each in label["effects"]:
            # Inside the body a verdict names no channel.
            channels = [name for name in each["channels"] if name != "a_y"] + each["also_right"]
            truth.append({"kind": each["kind"], "right": [[each["kind"], channel] for channel in channels or [None]]})
        pairs.append(Pair(f"planted_{record}", folder / f"{record}.csv", folder / f"{record}.again.csv", truth,
                          known_least=label.get("noise_rms_n")))
    return pairs
