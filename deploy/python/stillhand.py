# SPDX-License-Identifier: Apache-2.0
"""Recordings, models and verbs of Stillhand from Python, with NumPy alone.

From a recording to a Bode plot:

>>> import stillhand
>>> sensed = stillhand.tables(RECORDING, "stillhand/sensed")["stillhand/sensed"]
>>> sensed.units["accel_y_m_s2"], len(sensed["t"]) > 1000
('m/s^2', True)
>>> found = stillhand.verb("identify", RECORDING)
>>> found["usable"]
True
>>> f_hz = numpy.geomspace(0.1, 20, 200)
>>> response = stillhand.frequency_response(found["model"], f_hz)  # [N/(m/s^2)]
>>> bool(abs(response).max() > 0.1)
True
>>> # pyplot.loglog(f_hz, abs(response)); pyplot.semilogx(f_hz, numpy.angle(response, deg=True))

What a verb refuses is a StillhandError with its own line:

>>> stillhand.verb("identify", "nowhere.mcap")  # doctest: +ELLIPSIS
Traceback (most recent call last):
...
stillhand.StillhandError: ...nowhere.mcap...
"""
import csv
import json
import os
import pathlib
import subprocess
import tempfile

import numpy


class StillhandError(RuntimeError):
    """A verb ended with a status other than 0; the text is its last line, `status` the status."""

    def __init__(self, text, status):
        super().__init__(text)
        self.status = status


class Table(dict):
    """Columns of one topic or file: {name: array}; text columns are lists. `units`: {name: unit}."""

    def __init__(self, columns, units):
        super().__init__(columns)
        self.units = units


def program():
    """The program: STILLHAND_PROGRAM, or `stillhand` of PATH."""
    return os.environ.get("STILLHAND_PROGRAM", "stillhand")


def _run(*words):
    try:
        done = subprocess.run([program(), *map(str, words)], capture_output=True, text=True, check=False)
    except FileNotFoundError:
        raise StillhandError(f"{program()}: no such program; set STILLHAND_PROGRAM", 127) from None
    if done.returncode != 0:
        raise StillhandError((done.stderr.strip().splitlines() or ["no reason given"])[-1], done.returncode)
    return done.stdout


def verb(name, *words, **options):
    """Runs a verb that takes --json and returns its result; `min_hz=1` stands for `--min-hz 1`, True for a flag, a list
    for the words of one option: `map=["time=t [s]", "acc=a_y [g]", "force=f [N]"]`.

    Raises StillhandError where the verb refuses.
    """
    for option, value in options.items():
        words += (f"--{option.replace('_', '-')}",)
        if value is not True:
            words += tuple(value) if isinstance(value, (list, tuple)) else (value,)
    return json.loads(_run(name, *words, "--json", "-"))


def read_csv(path):
    """A table with titles `name [unit]`, as every verb writes and reads it."""
    with open(path, newline="", encoding="utf-8") as file:
        titles = next(csv.reader(file), [])
        if len(titles) < 2:
            raise ValueError(f"{path}: got {titles}, want titles `name [unit]` with commas between them; "
                             "the verbs also read other tables")
        rows = list(csv.reader(file))
    columns, units = {}, {}
    for i, title in enumerate(titles):
        name, _, unit = title.partition(" [")
        cells = [row[i] for row in rows]
        try:
            columns[name] = numpy.array([cell or "nan" for cell in cells], dtype=float)
        except ValueError:
            columns[name] = cells
        units[name] = unit.removesuffix("]")
    return Table(columns, units)


def tables(recording, *topics):
    """{topic: Table} of a recording (MCAP; ROS 2 too), of all topics or of those named (patterns with * and ?).

    `t` is in seconds since the recording's start. Names and units are those of `stillhand export --csv`.
    """
    with tempfile.TemporaryDirectory(prefix="stillhand-") as folder:
        words = ["export", recording, "--csv", pathlib.Path(folder) / "tables"]
        _run(*words, *(["--topics", ",".join(topics)] if topics else []))
        read = {path.stem: read_csv(path) for path in (pathlib.Path(folder) / "tables").glob("*.csv")}
    names = {_table_name(topic["topic"]): topic["topic"] for topic in verb("info", recording)["topics"]}
    return {names.get(stem, stem): table for stem, table in read.items()}


def _table_name(topic):
    name = "".join(c if c.isalnum() else "_" for c in topic)
    return name if name[0].isalpha() else "x" + name


def frequency_response(model, f_hz):
    """Of a difference model, complex, at frequencies [Hz].

    model: a dict with `rate_hz`, `numerator`, `denominator` (powers of 1/z from 0 on), as `stillhand identify` and
    model.json hold them. Its unit is the output's per the input's.
    """
    z = numpy.exp(-2j * numpy.pi * numpy.asarray(f_hz) / model["rate_hz"])
    return numpy.polyval(model["numerator"][::-1], z) / numpy.polyval(model["denominator"][::-1], z)
