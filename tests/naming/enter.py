#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes an entry for score.py with one of the tools below: an example of how to adapt another one.

    STILLHAND_BUILD=build python3 tests/naming/enter.py stillhand RECORDINGS ENTRY
    python3 tests/naming/enter.py narx RECORDINGS ENTRY

`stillhand` names and predicts (`diagnose`, `predict`). Three predict alone, from a_y: `narx`, a polynomial difference
model, `fir`, a long impulse response, and `octave`, the state space of octave-control (`moen4`, SLICOT). A tool sees
rec_0001_train.csv, and of rec_0001_test.csv every column but the force.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "benchmark"))

from peers import ImpulseResponse, Narx, chosen  # noqa: E402
from score import table  # noqa: E402

BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", "build"))
RATE_HZ = 100.0


def write_force(path, time, force):
    numpy.savetxt(path, numpy.column_stack([time, force]), delimiter=",", header="t [s],f [N]", comments="", fmt="%.7g")


def without_force(path, to):
    columns = path.read_text().splitlines()
    kept = [i for i, title in enumerate(columns[0].split(",")) if not title.startswith("f [")]
    to.write_text("".join(",".join(row.split(",")[i] for i in kept) + "\n" for row in columns))


def stillhand(train, test, entry, name):
    program = BUILD / "bin" / "stillhand"
    with tempfile.TemporaryDirectory() as holder:
        folder = pathlib.Path(holder)
        hidden, model, verdict, out = (folder / file for file in ("test.csv", "model.json", "verdict.json", "out.csv"))
        without_force(test, hidden)
        subprocess.run([program, "diagnose", train, "--save", model, "--json", verdict], check=True,
                       stdout=subprocess.DEVNULL)
        subprocess.run([program, "predict", model, hidden, "--out", out], check=True, stdout=subprocess.DEVNULL)
        effects = json.loads(verdict.read_text())["effects"]
        named = [{"kind": each["kind"], "channel": each.get("channel")} for each in effects]
        (entry / f"{name}.json").write_text(json.dumps({"effects": named}, indent=1) + "\n")
        predicted = table(out)
        write_force(entry / f"{name}.csv", predicted["t"], predicted["f_model"])


def on_grid(path, column):
    """A recording has jitter and gaps; a difference model needs equal steps."""
    rows = table(path)
    grid = numpy.arange(rows["t"][0], rows["t"][-1], 1.0 / RATE_HZ)
    return grid, numpy.interp(grid, rows["t"], rows[column])


# Order and offset by the script; the last quarter chooses.  moen4 without an order asks for one.
MOEN4 = """
pkg load control
d = dlmread('train.csv'); unseen = dlmread('test.csv'); offset = mean(d(:,2)); d(:,2) -= offset;
part = floor(0.75 * rows(d)); least = Inf;
for n = 2:2:12
  model = moen4(iddata(d(1:part,2), d(1:part,1), STEP), n, 's', 30);
  left = std(d(part+1:end,2) - lsim(model, d(part+1:end,1)));
  if left < least, least = left; order = n; end
end
model = moen4(iddata(d(:,2), d(:,1), STEP), order, 's', 30);
dlmwrite('out.csv', offset + lsim(model, unseen), 'precision', 8);
"""


def octave(train, test, entry, name):
    (_, u), (_, y) = on_grid(train, "a_y"), on_grid(train, "f")
    time, unseen = on_grid(test, "a_y")
    with tempfile.TemporaryDirectory() as holder:
        folder = pathlib.Path(holder)
        numpy.savetxt(folder / "train.csv", numpy.column_stack([u, y]), delimiter=",")
        numpy.savetxt(folder / "test.csv", unseen)
        subprocess.run(["octave-cli", "--no-gui", "--quiet", "--eval", MOEN4.replace("STEP", str(1.0 / RATE_HZ))],
                       cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        write_force(entry / f"{name}.csv", time, numpy.loadtxt(folder / "out.csv"))


def peer(kind):
    def enter(train, test, entry, name):
        (_, u), (_, y) = on_grid(train, "a_y"), on_grid(train, "f")
        time, unseen = on_grid(test, "a_y")
        offset = y.mean()
        model = chosen(kind, u, y - offset)
        write_force(entry / f"{name}.csv", time, offset + model.run(unseen, numpy.zeros(unseen.size), 0))
    return enter


TOOLS = {"stillhand": stillhand, "octave": octave, "narx": peer(Narx), "fir": peer(ImpulseResponse)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool", choices=TOOLS)
    parser.add_argument("recordings", type=pathlib.Path)
    parser.add_argument("entry", type=pathlib.Path)
    words = parser.parse_args()
    words.entry.mkdir(parents=True, exist_ok=True)
    for train in sorted(words.recordings.glob("*_train.csv")):
        name = train.name.removesuffix("_train.csv")
        if not (words.entry / f"{name}.csv").is_file():  # a run that was stopped goes on
            TOOLS[words.tool](train, words.recordings / f"{name}_test.csv", words.entry, name)
            print(name, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
