#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reading a table as every verb does, next to NumPy, SciPy, h5py and the MCAP project's own library.

    STILLHAND_BUILD=build /usr/bin/python3 tests/benchmark/read_tables.py [--rows 1000000] [--repeats 5]

Times at 1 kHz, an acceleration and a force; the files are written by SciPy, h5py and `numpy.savetxt` with 17 digits.
The MCAP file is a bag of ROS 2 without chunks, a message of each of two topics a row; its peer is @mcap/core with
Foxglove's deserialiser (Node.js), from the packages of `tests/interface/mcap_official_reader`.
Whole programs in turn: processor time with their children [s], median of --repeats, and the most memory [MB]. Ours also
puts the rows on their grid and looks for gaps; the others only fill arrays.
"""
import argparse
import multiprocessing
import os
import pathlib
import statistics
import struct
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests/integration"))

BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", "build")).resolve()
BAG_MAP = ["--map", "/imu.accel.linear.y=a_y", "/stick.wrench.force.y=f"]
MAP = ["--map", "t=t [s]", "a=a_y [m/s^2]", "f=f [N]"]
PEERS = {
    "csv": "import sys, numpy; numpy.loadtxt(sys.argv[1], delimiter=',', skiprows=1)",
    "mat": "import sys, scipy.io; scipy.io.loadmat(sys.argv[1])",
    "h5": "import sys, h5py; f = h5py.File(sys.argv[1]); [f[n][()] for n in f]",
}
MCAP_PEER = """
import { readFileSync } from "node:fs";
import { McapStreamReader } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
const [file, rows] = process.argv.slice(1);
const reader = new McapStreamReader();
reader.append(readFileSync(file));
const readers = new Map();
const columns = new Map();
for (let record; (record = reader.nextRecord()); ) {
  if (record.type === "Schema") {
    readers.set(record.id, new MessageReader(parse(new TextDecoder().decode(record.data), { ros2: true })));
    columns.set(record.id, new Float64Array(Number(rows)));
  } else if (record.type === "Message") {
    const value = readers.get(record.channelId).readMessage(record.data);
    columns.get(record.channelId)[record.sequence] = value.accel?.linear.y ?? value.wrench.force.y;
  }
}
"""


def write_bag(path, time_s, values):
    """The bag of `field_files`, whose messages all have one length, with other rows."""
    import field_files
    import numpy
    with tempfile.TemporaryDirectory() as folder:
        few = field_files.bag(pathlib.Path(folder), messages=lambda *_: None).read_bytes()
    end = few.rindex(field_files.record(15, bytes(4)))
    kind = numpy.dtype([("code", "u1"), ("length", "<u8"), ("channel", "<u2"), ("sequence", "<u4"), ("log", "<u8"),
                        ("published", "<u8"), ("cdr", "V4"), ("sec", "<i4"), ("nanosec", "<u4"), ("frame", "V8"),
                        ("vectors", "<f8", 6)])
    rows = numpy.zeros((len(time_s), len(values)), kind)
    rows["code"], rows["length"] = 5, kind.itemsize - 9
    rows["channel"] = [1, 2]
    rows["sequence"] = numpy.arange(len(time_s))[:, None]
    ns = numpy.round(time_s * 1e9).astype(numpy.int64) + 1_700_000_000_000_000_000
    rows["log"] = rows["published"] = ns[:, None]
    rows["sec"], rows["nanosec"] = (ns // 10**9)[:, None], (ns % 10**9)[:, None]
    rows["cdr"], rows["frame"] = numpy.void(bytes((0, 1, 0, 0))), numpy.void(struct.pack("<I4x", 1))
    for column, each in enumerate(values):
        rows["vectors"][:, column, 1] = each
    path.write_bytes(few[:end] + rows.tobytes() + few[end:])


def write(folder, rows):
    """In a process of its own: what a program starts with counts as its memory."""
    import h5py
    import numpy
    import scipy.io
    noise = numpy.random.default_rng(3)
    columns = {"t": numpy.arange(rows) / 1000.0, "a": noise.standard_normal(rows), "f": noise.standard_normal(rows)}
    numpy.savetxt(folder / "table.csv", numpy.column_stack(list(columns.values())), delimiter=",", header="t,a,f",
                  comments="", fmt="%.17g")
    scipy.io.savemat(folder / "table.mat", columns)
    with h5py.File(folder / "table.h5", "w") as file:
        for name, values in columns.items():
            file[name] = values
    write_bag(folder / "table.mcap", columns["t"], [columns["a"], columns["f"]])


def cost(words, folder="."):
    """Processor time [s] and most memory [MB] of one program, run in that folder, and its children."""
    os.chdir(folder if pathlib.Path(folder).is_dir() else ".")
    pid = os.posix_spawn(words[0], [str(word) for word in words], os.environ,
                         file_actions=[(os.POSIX_SPAWN_OPEN, 1, "/dev/null", os.O_WRONLY, 0)])
    _, status, used = os.wait4(pid, 0)
    if status != 0:
        sys.exit(f"read_tables: {words} ended with {status}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024.0


def programs(kind, file, rows):
    """What reads the file: ours, and the peer."""
    ours = [str(BUILD / "tests/read_tables"), file]
    if kind != "mcap":
        return [*ours, *MAP], [sys.executable, "-c", PEERS[kind], file]
    return [*ours, *BAG_MAP], ["/usr/bin/node", "--input-type=module", "-e", MCAP_PEER, file, rows]


def main():
    words = argparse.ArgumentParser()
    words.add_argument("--rows", type=int, default=1_000_000)
    words.add_argument("--repeats", type=int, default=5)
    options = words.parse_args()
    packages = BUILD / "tests/mcap_official_reader"  # where Node.js finds the MCAP project's library
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        writing = multiprocessing.Process(target=write, args=(folder, options.rows))
        writing.start()
        writing.join()
        print("| file | MB | ours [s] | peer [s] | ours / peer | ours [MB] | peer [MB] |\n| --- " + "| --- " * 6 + "|")
        for kind in (*PEERS, *(["mcap"] if packages.is_dir() else [])):
            file = folder / f"table.{kind}"
            ours, peer = programs(kind, file, options.rows)
            runs = [(cost(ours), cost(peer, packages)) for _ in range(options.repeats)]
            (ours, our_mb), (theirs, their_mb) = (
                tuple(statistics.median(run[who][i] for run in runs) for i in (0, 1)) for who in (0, 1))
            print(f"| {kind} | {file.stat().st_size / 1e6:.0f} | {ours:.2f} | {theirs:.2f} | {ours / theirs:.2f} | "
                  f"{our_mb:.0f} | {their_mb:.0f} |", flush=True)


if __name__ == "__main__":
    main()
