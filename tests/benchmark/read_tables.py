#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reading a table as every verb does, next to NumPy, SciPy and h5py.

    STILLHAND_BUILD=build /usr/bin/python3 tests/benchmark/read_tables.py [--rows 1000000] [--repeats 5]

Times at 1 kHz, an acceleration and a force; the files are written by SciPy, h5py and `numpy.savetxt` with 17 digits.
Whole programs in turn: processor time with their children [s], median of --repeats, and the most memory [MB]. Ours also
puts the rows on their grid and looks for gaps; the others only fill arrays.
"""
import argparse
import os
import pathlib
import statistics
import sys
import tempfile

import h5py
import numpy
import scipy.io

BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", "build"))
MAP = ["--map", "t=t [s]", "a=a_y [m/s^2]", "f=f [N]"]
PEERS = {
    "csv": "import sys, numpy; numpy.loadtxt(sys.argv[1], delimiter=',', skiprows=1)",
    "mat": "import sys, scipy.io; scipy.io.loadmat(sys.argv[1])",
    "h5": "import sys, h5py; f = h5py.File(sys.argv[1]); [f[n][()] for n in f]",
}


def write(folder, rows):
    noise = numpy.random.default_rng(3)
    columns = {"t": numpy.arange(rows) / 1000.0, "a": noise.standard_normal(rows), "f": noise.standard_normal(rows)}
    numpy.savetxt(folder / "table.csv", numpy.column_stack(list(columns.values())), delimiter=",", header="t,a,f",
                  comments="", fmt="%.17g")
    scipy.io.savemat(folder / "table.mat", columns)
    with h5py.File(folder / "table.h5", "w") as file:
        for name, values in columns.items():
            file[name] = values


def cost(words):
    """Processor time [s] and most memory [MB] of one program and its children."""
    pid = os.posix_spawn(words[0], [str(word) for word in words], os.environ,
                         file_actions=[(os.POSIX_SPAWN_OPEN, 1, "/dev/null", os.O_WRONLY, 0)])
    _, status, used = os.wait4(pid, 0)
    if status != 0:
        sys.exit(f"read_tables: {words} ended with {status}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024.0


def main():
    words = argparse.ArgumentParser()
    words.add_argument("--rows", type=int, default=1_000_000)
    words.add_argument("--repeats", type=int, default=5)
    options = words.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write(folder, options.rows)
        print("| file | MB | ours [s] | peer [s] | ours / peer | ours [MB] | peer [MB] |\n| --- " + "| --- " * 6 + "|")
        for kind, peer in PEERS.items():
            file = folder / f"table.{kind}"
            runs = [(cost([str(BUILD / "tests/read_tables"), file, *MAP]),
                     cost([sys.executable, "-c", peer, file])) for _ in range(options.repeats)]
            (ours, our_mb), (theirs, their_mb) = (
                tuple(statistics.median(run[who][i] for run in runs) for i in (0, 1)) for who in (0, 1))
            print(f"| {kind} | {file.stat().st_size / 1e6:.0f} | {ours:.2f} | {theirs:.2f} | {ours / theirs:.2f} | "
                  f"{our_mb:.0f} | {their_mb:.0f} |", flush=True)


if __name__ == "__main__":
    main()
