#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Mend, cancel or leave: what `close-the-loop` predicts against what the simulated rig does.

    tests/benchmark/repair_worth.py build/bin/stillhand --effects 501-512

Each effect is sealed in a rig with another person and other seeds.  The same session runs again on
a rig without it: same person, motion, target, remnant.  Real changes of the tracking error are
those of the repeats, pair by pair: C+ less C' with the effect, and C' without less C' with it.
"""
import argparse
import json
import math
import pathlib
import statistics
import subprocess
import tempfile


def session(program, effect, seed, people, out):
    subprocess.run([program, "close-the-loop", "--undeclared-effect", str(effect), "--seed", str(seed),
                    "--subject", str(1 + seed % people), "--out", str(out)],
                   check=True, stdout=subprocess.DEVNULL)
    return json.loads((out / "summary.json").read_text())


def errors(summary, condition):
    return summary["conditions"][condition]["rms_error_mm"]["repeats"]


def change(before, after):
    """Mean and half of its 95 % interval (Student, 10 repeats)."""
    each = [b - a for a, b in zip(before, after)]
    return statistics.mean(each), 2.262 * statistics.stdev(each) / math.sqrt(len(each))


def row(program, effect, people, folder):
    seed = 1000 + effect
    with_it = session(program, effect, seed, people, folder / f"with{effect}")
    truth = with_it["truth"]
    name = truth["kind"] + ", " + truth["place"]
    if truth["kind"] == "none":
        return f"{effect} none: {len(with_it['repair']['effects'])} effects in the list"
    without = session(program, 0, seed, people, folder / f"without{effect}")
    left = errors(with_it, "C'")
    mended, mended_half = change(left, errors(without, "C'"))
    plus, plus_half = change(left, errors(with_it, "C+"))
    text = (f"{effect} {name}: left {statistics.mean(left):.1f} mm, really mended {mended:+.2f} "
            f"± {mended_half:.2f}, C+ {plus:+.2f} ± {plus_half:.2f}; ")
    if not with_it["repair"]["effects"]:
        return text + "nothing that counts was found"
    for worth in with_it["repair"]["effects"]:
        text += worth["kind"] + ("" if truth["verdict_right"] else " (verdict wrong)")
        if worth["why_not"]:
            text += f": {worth['why_not']}; "
            continue
        for way in ("mended", "cancelled"):
            if worth["change_mm"][way]:
                low, high = worth["change_mm"][way]["interval95"]
                text += f", {way} {worth['change_mm'][way]['mean']:+.2f} [{low:+.2f}, {high:+.2f}]"
        text += f", {worth['advice']}; "
    repair = with_it["repair"]
    return text + f"C' {repair['modelled_mm']:.1f} for {repair['measured_mm']:.1f} mm"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--effects", default="501-512", help="seeds, first-last")
    parser.add_argument("--people", type=int, default=7)
    options = parser.parse_args()
    first, last = (int(each) for each in options.effects.split("-"))
    with tempfile.TemporaryDirectory() as folder:
        for effect in range(first, last + 1):
            print(row(options.program, effect, options.people, pathlib.Path(folder)), flush=True)


if __name__ == "__main__":
    main()
