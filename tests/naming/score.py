#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Scores an entry: what it named in each recording, and its prediction of the unseen one (README.md).

    python3 tests/naming/score.py RECORDINGS ENTRY [ENTRY...] [--each]

RECORDINGS is what fresh_bodies.py wrote, an ENTRY a folder with rec_0001.json ({"effects": [{"kind", "channel"}]}) and
rec_0001.csv (`t [s],f [N]`), either or both for every recording. Exit status 0; 2 for an entry that cannot be read.
"""
import argparse
import csv
import hashlib
import json
import math
import pathlib
import sys

import numpy

SETTLE_S = 2.0  # the first seconds of a prediction do not count: it does not know the state at the start
HARM = 1.05     # times the error of the best linear response
BELOW_NOISE = 0.9  # times the least possible error: no model gets there
VERDICTS = ("all", "part", "wrong", "missed", "quiet", "false alarm")


class Unreadable(Exception):
    pass


def matches(effect, named):
    """A free form of the right channel is right too: of a shape without a name nothing more can be said."""
    if named["kind"] == "free_form":
        return bool(named["channel"]) and named["channel"] in (effect.get("channel") or "").split("*")
    return any(kind == named["kind"] and channel in (None, named["channel"]) for kind, channel in effect["right"])


def judged(truth, named, too_small=False):
    """One of VERDICTS; None without an answer.  @param too_small  a linear model does as well: nothing named is right"""
    if truth is None or named is None:
        return None
    if not truth:
        return "false alarm" if named else "quiet"
    if not named:
        return "quiet" if too_small else "missed"
    hit = [any(matches(effect, each) for each in named) for effect in truth]
    others = [each for each in named if not any(matches(effect, each) for effect in truth)]
    if all(hit) and not others:
        return "all"
    return "part" if any(hit) and len(others) <= len(named) - len(others) else "wrong"


def table(path):
    """Columns by name, without units."""
    with open(path, newline="", encoding="utf-8-sig") as file:
        rows = list(csv.reader(file))
    try:
        values = numpy.array(rows[1:], dtype=float)
        return {title.split(" [")[0]: values[:, column] for column, title in enumerate(rows[0])}
    except (ValueError, IndexError) as error:
        raise Unreadable(f"{path}: {error}") from error


def effects_of(path):
    try:
        effects = json.loads(path.read_text())["effects"]
        named = [{"kind": each["kind"], "channel": each.get("channel")} for each in effects]
        if isinstance(effects, list) and all(isinstance(each["kind"], str) for each in named):
            return named
        raise ValueError("a kind is a text")
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise Unreadable(f'{path}: want {{"effects": [{{"kind": ..., "channel": ...}}]}} ({error!r})') from error


def error_of(prediction, measured):
    """RMS of measured - predicted [N] on the rows that count."""
    predicted = table(prediction)
    if not {"t", "f"} <= set(predicted):
        raise Unreadable(f"{prediction}: want the columns t [s] and f [N]")
    if not numpy.all(numpy.diff(predicted["t"]) > 0) or predicted["t"][0] > measured["t"][0] + SETTLE_S:
        raise Unreadable(f"{prediction}: want the time of the recording, ascending, from {measured['t'][0]:g} s on")
    counts = measured["t"] - measured["t"][0] >= SETTLE_S
    if predicted["t"][-1] < measured["t"][-1] - 0.1:
        raise Unreadable(f"{prediction}: ends at {predicted['t'][-1]:g} s, the recording at {measured['t'][-1]:g} s")
    left = measured["f"] - numpy.interp(measured["t"], predicted["t"], predicted["f"])
    value = float(numpy.sqrt(numpy.mean(left[counts] ** 2)))
    if not numpy.isfinite(value):
        raise Unreadable(f"{prediction}: the force is not finite")
    return value


def scored(recordings, entry):
    """One row for each recording."""
    rows = []
    for label in sorted(recordings.glob("*.truth.json")):
        name = label.name.split(".")[0]
        truth = json.loads(label.read_text())
        linear, least = truth["test"]["linear_rmse_n"], truth["test"]["oracle_rmse_n"]
        answer, prediction = entry / f"{name}.json", entry / f"{name}.csv"
        named = effects_of(answer) if answer.is_file() else None
        error = error_of(prediction, table(recordings / f"{name}_test.csv")) if prediction.is_file() else None
        if error is not None and error < BELOW_NOISE * least:
            raise Unreadable(f"{prediction}: the error is below the noise; was the force of the test read?")
        rows.append({"name": name, "truth": truth["effects"], "named": named, "linear": linear, "least": least,
                     "verdict": judged(truth["effects"], named, linear < 1.01 * least), "error": error})
    if not rows:
        raise Unreadable(f"{recordings}: no *.truth.json; make them with fresh_bodies.py")
    for answer, ending in (("named", "json"), ("error", "csv")):
        absent = [row["name"] for row in rows if row[answer] is None]
        if 0 < len(absent) < len(rows):
            raise Unreadable(f"{entry}: no {absent[0]}.{ending}; an entry has one for every record, or none")
    if all(row["named"] is None and row["error"] is None for row in rows):
        raise Unreadable(f"{entry}: neither rec_0001.json nor rec_0001.csv is there")
    return rows


def digest(recordings):
    """Of all files, so that two people know that they have the same."""
    total = hashlib.sha256()
    for path in sorted(recordings.glob("rec_*")):
        total.update(path.name.encode() + b"\0" + path.read_bytes())
    return total.hexdigest()[:16]


def summary(rows):
    """Counts of the verdicts; of the predictions the error over the least possible one, and the harm."""
    count = {verdict: sum(row["verdict"] == verdict for row in rows) for verdict in VERDICTS}
    predicted = [row for row in rows if row["error"] is not None]
    if not predicted:
        return count, None
    over = numpy.array([row["error"] / row["least"] for row in predicted])
    left = numpy.array([(row["error"] - row["least"]) / (row["linear"] - row["least"]) for row in predicted
                        if row["truth"] and row["linear"] > 1.01 * row["least"]] or [math.nan])
    harm = sum(row["error"] > HARM * row["linear"] for row in predicted)
    return count, (float(numpy.median(over)), float(numpy.quantile(over, 0.9)), float(numpy.median(left)), harm,
                   len(predicted))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recordings", type=pathlib.Path)
    parser.add_argument("entries", type=pathlib.Path, nargs="+")
    parser.add_argument("--each", action="store_true", help="a line for each recording, too")
    words = parser.parse_args()
    if len({entry.name for entry in words.entries}) < len(words.entries):
        parser.error("two entries have one name")
    try:
        results = {entry.name: scored(words.recordings, entry) for entry in words.entries}
        same = digest(words.recordings)
    except (Unreadable, OSError) as error:
        print(f"score: {error}", file=sys.stderr)
        return 2
    print(f"{len(next(iter(results.values())))} recordings, digest {same}\n")
    print("| entry | " + " | ".join(VERDICTS) + " | error over the least: median, 90 % below | of what a linear model "
          "leaves, left | harm |\n" + "| --- " * (len(VERDICTS) + 4) + "|")
    for name, rows in results.items():
        count, error = summary(rows)
        figures = f"{error[0]:.2f}, {error[1]:.2f} | {100 * error[2]:.0f} % | {error[3]} of {error[4]}" if error else "- | - | -"
        print(f"| {name} | " + " | ".join(str(count[verdict]) for verdict in VERDICTS) + f" | {figures} |")
    for name, rows in results.items() if words.each else ():
        print(f"\n{name}")
        for row in rows:
            truth = ", ".join(f"{each['kind']} {each['channel'] or ''}".strip() for each in row["truth"]) or "no effect"
            named = "-" if row["named"] is None else \
                ", ".join(f"{each['kind']} {each['channel'] or ''}".strip() for each in row["named"]) or "nothing"
            error = "" if row["error"] is None else f"{row['least']:.2f} {row['error']:.2f} {row['linear']:.2f} N"
            print(f"{row['name']}  {row['verdict'] or '-':12} {truth}  |  {named}  |  {error}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
