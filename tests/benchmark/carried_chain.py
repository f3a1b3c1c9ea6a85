#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What is named is carried: one table of verdict, saved model, prediction, export and motor, for pairs of recordings.

For each pair the fit record goes through `diagnose`, and once more with no effect (the linear model); `predict` runs
both models on the unseen record; `control-model` exports the model; `close-the-loop` judges what the motor leaves.

  verdict    error on held-out blocks, linear -> with effects, and `carried`, as the verdict's JSON gives them
  unseen     RMSE of measured - predicted on the unseen record, linear -> carried, and the least possible, where known
  carried    (linear - predicted) / (linear - least possible) on the unseen record; not where time alone is the cause
  exported   effects that the motor cancels, and the largest difference of exported and diagnosed model, where printed
  motor      RMS that the motor leaves of the unseen record, with the linear and with the carried model; which was kept

Named: `all` each true effect is named and nothing else, `part` at least one, `wrong`, `missed` (nothing is named);
without an effect `quiet` or `false alarm`; quiet is right too where the best linear model comes within 1 %
of the least possible error. Sets of pairs: a generator's (fresh_bodies.py), recordings in STILLHAND_DATA
(default: shared/data next to the checkout; measured or made elsewhere, no part of the project), planted_recordings.

    STILLHAND_BUILD=build python3 tests/benchmark/carried_chain.py --fresh 60 --seed 1 --json new.json
    STILLHAND_BUILD=build python3 tests/benchmark/carried_chain.py --field --planted 18 --json others.json
    python3 tests/benchmark/carried_chain.py --compare old.json new.json

--keep DIR holds every file, and a step whose files are there is not run again. Exit status: 0; 1 where a carried model
is more than 5 % worse than the linear one on an unseen record; 77 where no recording is to be had.
"""
import argparse
import json
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile

import numpy

from carried_pairs import column, field, folder_of_pairs, fresh, planted
from carried_table import WORST, compare, print_table, ratio
from recorded_data import BUILD, SKIPPED, SOURCE

sys.path.insert(0, str(SOURCE / "tests" / "naming"))

from score import judged  # noqa: E402

STEPS = ("diagnose", "predict", "export", "motor")
LIMIT_S = 900


def run(words, log):
    """Exit status, standard output, seconds of a processor; the texts go to `log`."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    try:
        done = subprocess.run([str(BUILD / "bin" / "stillhand"), *map(str, words)], capture_output=True, text=True,
                              timeout=LIMIT_S)
        status, out, error = done.returncode, done.stdout, done.stderr
    except subprocess.TimeoutExpired:
        status, out, error = 124, "", f"more than {LIMIT_S} s"
    log.write_text(f"{' '.join(map(str, words))}\nexit {status}\n{out}{error}")
    return status, out, error.strip(), resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def read(path):
    return json.loads(path.read_text()) if path.is_file() else None


class Chain:
    """One pair, step by step; what a step could not give is None, with the reason in `errors`."""

    def __init__(self, pair, folder):
        self.pair, self.folder = pair, folder
        self.errors = {}
        self.titles = ["--map", *pair.titles] if pair.titles else []
        folder.mkdir(parents=True, exist_ok=True)

    def step(self, name, words, made):
        """Runs a verb unless its file is there. Its time is kept for a later look."""
        note = self.folder / f"{name}.step.json"
        if not note.is_file():
            status, out, error, seconds = run(words, self.folder / f"{name}.log")
            note.write_text(json.dumps({"status": status, "out": out, "error": error, "cpu_s": seconds}))
        done = read(note)
        if done["status"] or not made.is_file():
            self.errors[name] = f"exit {done['status']}: {done['error'].splitlines()[-1] if done['error'] else ''}"
        return done

    def diagnose(self):
        verdict = self.folder / "verdict.json"
        words = ["diagnose", self.pair.train, *self.titles, "--save"]
        done = self.step("diagnose", [*words, self.folder / "model.json", "--json", verdict], verdict)
        linear = self.folder / "linear.json"
        found = (read(verdict) or {}).get("effects")
        if found == [] and not linear.is_file():  # it is the linear model
            shutil.copy(self.folder / "model.json", linear)
        if found != []:
            self.step("linear", [*words, linear, "--most-effects", 0], linear)
        verdict = read(verdict)
        if verdict is None:
            return {}
        kept = ("kind", "channel", "carried", "why_not_carried", "heldout_rmse_before", "heldout_rmse_after")
        effects = [{name: effect.get(name) for name in kept} for effect in verdict["effects"]]
        return {"verdict": verdict["verdict"], "effects": effects, "verdict_linear": verdict["baseline"]["heldout_rmse"],
                "verdict_after": verdict["final"]["heldout_rmse"],
                "verdict_carried": (verdict.get("carried") or {}).get("heldout_rmse"), "diagnose_cpu_s": done["cpu_s"]}

    def error_of(self, name):
        """RMSE on the rows of the unseen record, and what predict notes."""
        model, out = self.folder / f"{name}.json", self.folder / f"{name}.csv"
        if not model.is_file():
            return None, []
        done = self.step(f"predict_{name}", ["predict", model, self.pair.test, *self.titles, "--out", out], out)
        if not out.is_file():
            return None, []
        time, measured = column(self.pair.test, "f")
        # A jittered record is predicted on a grid.
        predicted = numpy.interp(time, *column(out, "f_model"))
        notes = [line[len("note: "):] for line in done["out"].splitlines() if line.startswith("note: ")]
        return self.pair.rms(time, measured - predicted), notes

    def predict(self):
        linear, _ = self.error_of("linear")
        carried, notes = self.error_of("model")
        return {"unseen_linear": linear, "unseen_carried": carried, "notes": notes,
                "least_possible": self.pair.least_possible(), "best_linear": self.pair.best_linear}

    def export(self):
        out, table = self.folder / "control.json", self.folder / "export.json"
        self.step("export", ["control-model", self.folder / "model.json", self.pair.train, *self.titles, "--save", out,
                             "--json", table], out)
        return {"export": (read(table) or {}).get("treatments")}

    def motor(self):
        out = self.folder / "loop"
        self.step("motor", ["close-the-loop", "--pegged", self.pair.train, "--unseen", self.pair.test,
                            *self.titles, "--threads", 1, "--out", out], out / "summary.json")
        summary = read(out / "summary.json")
        if not summary:
            return {}
        unseen = (summary.get("unseen") or [{}])[0]

        def left(name):
            return ((unseen.get(name) or {}).get("left") or {}).get("rms")
        findings = (summary.get("verdict") or {}).get("findings") or []
        return {"loop_findings": [finding.get("kind") for finding in findings], "loop_linear": left("linear"),
                "loop_augmented": left("augmented"), "motor_linear": left("motor_linear"),
                "motor_carried": left("motor_augmented"), "kept": unseen.get("kept", summary.get("kept")),
                "decided_on": unseen.get("decided_on", summary.get("decided_on"))}

    def row(self, steps):
        row = {"record": self.pair.name, "truth": self.pair.truth}
        for step in steps:
            row.update(getattr(self, step)())
        row["named"] = judged(self.pair.truth, row.get("effects"), self.pair.too_small)
        row["errors"] = self.errors
        return row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--fresh", type=int, default=0, metavar="N", help="pairs of fresh_bodies.py")
    parser.add_argument("--seed", type=int, default=1, help="of --fresh and --planted")
    parser.add_argument("--pairs", type=pathlib.Path, metavar="DIR", help="pairs that fresh_bodies.py has written")
    parser.add_argument("--field", nargs="?", const="", metavar="DIR", help="pairs in DIR or STILLHAND_DATA/field")
    parser.add_argument("--planted", type=int, default=0, metavar="N", help="pairs of planted_recordings, kinds in turn")
    parser.add_argument("--only", help="regular expression of names")
    parser.add_argument("--steps", default=",".join(STEPS))
    parser.add_argument("--json", type=pathlib.Path, help="the rows")
    parser.add_argument("--keep", type=pathlib.Path, metavar="DIR")
    parser.add_argument("--compare", nargs=2, type=pathlib.Path, metavar="JSON", help="rows of an old and a new program")
    words = parser.parse_args()
    if words.compare:
        compare(*(read(path) for path in words.compare))
        return 0
    with tempfile.TemporaryDirectory() as holder:
        folder = words.keep or pathlib.Path(holder)
        pairs = [*(fresh(folder / "fresh", words.fresh, words.seed) if words.fresh else []),
                 *(folder_of_pairs(words.pairs) if words.pairs else []),
                 *(field(words.field) if words.field is not None else []),
                 *(planted(folder / "planted", words.planted, words.seed) if words.planted else [])]
        pairs = [pair for pair in pairs if re.search(words.only or "", pair.name)]
        if not pairs:
            print("skipped: no recordings; see --help")
            return SKIPPED
        rows = []
        for pair in pairs:
            rows.append(Chain(pair, folder / "chain" / pair.name).row(words.steps.split(",")))
            print(f"{pair.name}: {rows[-1]['named'] or ''}", file=sys.stderr, flush=True)
            if words.json:  # after each pair: a run that is stopped keeps what it has
                words.json.write_text(json.dumps(rows, indent=1) + "\n")
    print_table(rows)
    return int(any((ratio(row) or 0.0) > WORST for row in rows))


if __name__ == "__main__":
    sys.exit(main())
