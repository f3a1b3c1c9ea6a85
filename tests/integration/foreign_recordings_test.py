# SPDX-License-Identifier: Apache-2.0
"""Recordings of other programs: one recording in every format gives the same result, bit for bit.

The files are written by others: SciPy, h5py, Octave, Python's wave, libsndfile, the MCAP project's writer.  A case whose
writer is not installed is skipped.
"""
import datetime
import json
import os
import pathlib
import pty
import random
import re
import select
import shlex
import shutil
import struct
import subprocess
import sys
import unittest
import wave

import numpy

import lab_process
from lab_process import STILLHAND
from verb_case import SharedFolderCase, stillhand

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "interface"))
import mcap_official_reader_test as official  # noqa: E402

try:
    import scipy.io
except ImportError:
    scipy = None
try:
    import h5py
except ImportError:
    h5py = None
try:
    import soundfile
except (ImportError, OSError):
    soundfile = None

RATE_HZ = 100
ROWS = 3000
MAP = ["--map", "time=t [s]", "acc=a_y [m/s^2]", "force=f [N]"]
DAMAGED_EACH = 25
LABVIEW = ("LabVIEW Measurement\t\r\nSeparator\tTab\r\nDecimal_Separator\t.\r\n***End_of_Header***\t\r\n\t\r\n"
           "Channels\t2\t\t\r\nSamples\t3000\t3000\t\r\n***End_of_Header***\t\t\t\r\n")


def stamp(t):
    """Date and clock of a time [s] after the beginning, to the microsecond."""
    return datetime.datetime(2026, 11, 26, 9, 59, 50) + datetime.timedelta(microseconds=round(1e6 * t))


def draw():
    """Acceleration as noise below 6 Hz, and the force of a damped body that it shakes."""
    noise = numpy.fft.rfft(numpy.random.default_rng(5).standard_normal(ROWS))
    frequency = numpy.fft.rfftfreq(ROWS, 1.0 / RATE_HZ)
    noise[(frequency > 6.0) | (frequency < 0.2)] = 0.0
    acc = numpy.fft.irfft(noise, ROWS) * 4.0
    force = numpy.zeros(ROWS)
    for n in range(2, ROWS):
        force[n] = 1.8 * force[n - 1] - 0.83 * force[n - 2] + 0.1 * acc[n - 1]
    return numpy.arange(ROWS) / RATE_HZ, acc, force + 1e-3 * numpy.random.default_rng(6).standard_normal(ROWS)


def mark_class(item, name):
    """The attribute MATLAB_class as MATLAB writes it: a text of fixed length that a zero may end."""
    kind = h5py.h5t.C_S1.copy()
    kind.set_size(len(name))
    kind.set_strpad(h5py.h5t.STR_NULLTERM)
    attribute = h5py.h5a.create(item.id, b"MATLAB_class", kind, h5py.h5s.create(h5py.h5s.SCALAR))
    attribute.write(numpy.array(name, dtype=f"S{len(name)}"), mtype=kind)


class ForeignRecordingsTest(SharedFolderCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.time, cls.acc, cls.force = draw()
        cls.own = cls.folder / "own.csv"
        cls.table(cls.own, "t [s],a_y [m/s^2],f [N]")
        cls.wanted = cls.identified(cls.own)

    @classmethod
    def samples(cls):
        return zip(map(float, cls.time), map(float, cls.acc), map(float, cls.force))

    @classmethod
    def table(cls, path, header, separator=",", decimal=".", end="\n", encoding="utf-8", first=lambda t: repr(t)):
        lines = [header]
        for t, acc, force in cls.samples():
            cells = [first(t), repr(acc), repr(force)]
            lines.append(separator.join(cell.replace(".", decimal) for cell in cells))
        path.write_bytes((end.join(lines) + end).encode(encoding))

    @classmethod
    def identified(cls, *words):
        out = cls.folder / "out.json"
        out.unlink(missing_ok=True)
        run = stillhand("identify", *words, "--json", out)
        if run.returncode != 0:
            raise AssertionError(run.stderr + run.stdout)
        result = json.loads(out.read_text())
        return {key: result[key] for key in
                ("model", "heldout", "frequency_response", "measured_response", "sample_rate_hz", "samples")}

    def assert_same(self, *words):
        self.assertEqual(self.identified(*words), self.wanted)

    # Text

    def test_text_tables_of_every_form(self):
        cases = [
            ("plain.csv", dict(header="time,acc,force"), MAP),
            ("german.csv", dict(header='\ufeff"time";"acc";"force"', separator=";", decimal=",", end="\r\n"), MAP),
            ("tabs.txt", dict(header="time\tacc\tforce", separator="\t", decimal=","), MAP),
            ("excel.txt", dict(header="time\tacc\tforce", separator="\t", decimal=",", encoding="utf-16"), MAP),
            ("blanks.dat", dict(header="# made by a logger\n# time acc force", separator="   "), MAP),
            ("units.csv", dict(header="Gerät 3;;\nDatum: heute\n\nt;a_y;f\n[s];[m/s²];[N]", separator=";", decimal=",",
                               encoding="windows-1252"), []),
            ("ms.csv", dict(header="t (ms);a_y (m/s²);f (N)", separator=";", decimal=",",
                            first=lambda t: str(round(1000 * t))), []),
            ("us.csv", dict(header="stamp,acc,force", first=lambda t: str(round(1e6 * t))),
             ["--map", "stamp=t [us]", "acc=a_y", "force=f"]),
            ("bare.csv", dict(header="x,x,x"), ["--map", "#1=t", "#2=a_y", "#3=f"]),
            ("unmarked.csv", dict(header="time,acc,force", encoding="utf-16-le"), MAP),
            ("old.csv", dict(header="time,acc,force", end="\r"), MAP),
            ("no_break.csv", dict(header="t\u00a0[s],a_y\u00a0[m/s^2],f\u00a0[N]"), []),
            ("rate.csv", dict(header="100\ntime,acc,force"), MAP),
            ("ends.csv", dict(header="time,acc,force", end=",\n"), MAP),
            ("labview.lvm", dict(header=LABVIEW + "X_Value\tacc\tforce\tComment", separator="\t", end="\r\n"),
             ["--map", "X_Value=t [s]", "acc=a_y", "force=f"]),
            ("stamps.csv", dict(header="time,acc,force", first=lambda t: stamp(t).isoformat()), MAP),
            ("clock.csv", dict(header="time,acc,force", first=lambda t: stamp(t).time().isoformat()), MAP),
        ]
        for name, form, words in cases:
            with self.subTest(name):
                path = self.folder / name
                self.table(path, **form)
                self.assert_same(path, *words)

    def test_separator_and_decimal_sign_can_be_stated(self):
        path = self.folder / "stated.csv"
        self.table(path, "time;acc;force", separator=";", decimal=",")
        self.assert_same(path, *MAP, "--separator", "semicolon", "--decimal", "comma")
        self.refused_for("no rows of numbers", "identify", path, *MAP, "--separator", "tab")
        self.refused_for("--decimal: got 'x'", "identify", path, *MAP, "--decimal", "x")

    def test_the_refusal_holds_the_mapping_that_would_do(self):
        path = self.folder / "refused.csv"
        self.table(path, "time,acc,force")
        line = self.refused("identify", path)
        words = shlex.split(re.search(r"add (--map .*) \(or", line).group(1))
        self.assertEqual(words, MAP)
        self.assert_same(path, *words)

    def test_missing_cells_are_a_gap(self):
        path = self.folder / "missing.csv"
        self.table(path, "time,acc,force")
        lines = path.read_text().split("\n")
        for row in (500, 501, 900):
            lines[row] = lines[row].split(",")[0] + ",,"
        path.write_text("\n".join(lines))
        out = self.folder / "missing.json"
        self.run_verb("identify", path, *MAP, "--json", out)
        self.assertIn("3 of 3000 rows lack a value", " ".join(json.loads(out.read_text())["notes"]))

    # MATLAB

    @unittest.skipIf(scipy is None, "SciPy is not installed")
    def test_matlab_5(self):
        for compressed in (False, True):
            path = self.folder / f"v5_{compressed}.mat"
            scipy.io.savemat(path, {"time": self.time, "fs": 100.0, "name": "ride",
                                    "log": {"acc": self.acc.reshape(-1, 1), "force": self.force.reshape(1, -1)},
                                    "both": numpy.column_stack([self.acc, self.force])}, do_compression=compressed)
            self.assert_same(path, "--map", "time=t [s]", "log.acc=a_y", "log.force=f")
            self.assert_same(path, "--map", "time=t [s]", "both(:,1)=a_y", "both(:,2)=f [N]")
            self.assert_same(path, "--map", "both(:,1)=a_y", "both(:,2)=f [N]", "--sample-rate", 100)
        self.refused_for("'log.acc=a_y [m/s^2]' 'log.force=f [N]'", "identify", path)

    @unittest.skipIf(scipy is None, "SciPy is not installed")
    def test_matlab_cells_and_an_element_for_each_signal(self):
        signals = numpy.zeros(40, dtype=[("Name", "O"), ("Data", "O")])
        for i in range(40):
            signals[i] = (f"signal {i}", {16: self.acc, 39: self.force}.get(i, numpy.zeros(ROWS)))
        cells = numpy.empty(3, dtype=object)
        cells[:] = [self.time, self.acc, "ride"]
        path = self.folder / "dspace.mat"
        scipy.io.savemat(path, {"rec": {"X": self.time, "Y": signals}, "cells": cells})
        self.assert_same(path, "--map", "rec.X=t [s]", "rec.Y(17).Data=a_y", "rec.Y(40).Data=f [N]")
        self.assert_same(path, "--map", "cells{1}=t [s]", "cells{2}=a_y", "rec.Y(40).Data=f [N]")
        scipy.io.savemat(path, {"z": self.acc + 1j * self.force, "cube": numpy.zeros((50, 3, 3))})
        self.refused_for("z (complex numbers), cube (3 dimensions)", "identify", path)

    @unittest.skipIf(h5py is None, "h5py is not installed")
    def test_matlab_7_3(self):
        path = self.folder / "v73.mat"
        with h5py.File(path, "w", userblock_size=512) as file:
            for name, values in (("time", self.time), ("acc", self.acc)):
                file[name] = values.reshape(1, -1)  # a column vector of MATLAB
                mark_class(file[name], b"double")
            group = file.create_group("log")
            mark_class(group, b"struct")
            group["force"] = self.force.reshape(1, -1)
            mark_class(group["force"], b"double")
        # MathWorks: a text of 116 bytes, 8 of offset, the version 0x0200 and the mark of the byte order.
        head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + struct.pack("<H", 0x0200) + b"IM"
        with open(path, "r+b") as file:
            file.write(head)
        self.assert_same(path, "--map", "time=t [s]", "acc=a_y", "log.force=f")

    @unittest.skipIf(shutil.which("octave-cli") is None, "Octave is not installed")
    def test_what_octave_writes(self):
        script = (f"d = dlmread('{self.own}', ',', 1, 0); time = d(:,1); acc = d(:,2); force = d(:,3); "
                  f"save('-v7', '{self.folder}/o7.mat', 'time', 'acc', 'force'); "
                  f"save('-v6', '{self.folder}/o6.mat', 'time', 'acc', 'force'); "
                  f"save('-hdf5', '{self.folder}/o.h5', 'time', 'acc', 'force');")
        subprocess.run(["octave-cli", "--norc", "--eval", script], check=True, capture_output=True, timeout=120)
        self.assert_same(self.folder / "o7.mat", *MAP)
        self.assert_same(self.folder / "o6.mat", *MAP)
        self.assert_same(self.folder / "o.h5", "--map", "time/value=t [s]", "acc/value=a_y", "force/value=f")

    # HDF5

    @unittest.skipIf(h5py is None, "h5py is not installed")
    def test_hdf5(self):
        path = self.folder / "ride.h5"
        record = numpy.zeros(ROWS, dtype=[("time", "f8"), ("acc", "f8"), ("n", "i4"), ("force", "f8")])
        record["time"], record["acc"], record["force"] = self.time, self.acc, self.force
        with h5py.File(path, "w") as file:
            for name, values, unit in (("t", self.time, "s"), ("a_y", self.acc, "m/s^2"), ("f", self.force, "N")):
                file.create_dataset(f"run/{name}", data=values, compression="gzip", chunks=(500,)).attrs["units"] = unit
            file["matrix"] = numpy.vstack([self.acc, self.force])
            file["table"] = record
            file["picture"] = numpy.zeros((200, 300))
            file["short"] = numpy.zeros(200)
            for name, values in (("a_y", self.acc), ("f", self.force)):
                packed = file.create_dataset(f"packed/{name}", data=values * 1024.0 - 512.0)
                packed.attrs["scale_factor"], packed.attrs["add_offset"] = 2.0**-10, 0.5
            file["pose"] = numpy.zeros(9, dtype=[("at", [("x", "f8")])])
            file["elsewhere"] = h5py.ExternalLink("/etc/passwd", "/x")
        self.assert_same(path, "--map", "run/t=t", "run/a_y=a_y", "run/f=f")
        self.assert_same(path, "--map", "table.time=t [s]", "table.acc=a_y", "table.force=f")
        self.assert_same(path, "--map", "matrix[0,:]=a_y", "matrix[1,:]=f", "--sample-rate", 100)
        packed = self.identified(path, "--map", "packed/a_y=a_y [m/s^2]", "packed/f=f [N]", "--sample-rate", 100)
        key = "free_run_vaf_percent"
        self.assertAlmostEqual(packed["heldout"][key], self.wanted["heldout"][key], 6)
        self.assertIn("3000 values of 'run/t' and 200 of 'short'",
                      self.refused("identify", path, "--map", "run/t=t", "short=a_y"))
        self.refused_for("no column of", "identify", path, "--map", "run/t=t", "elsewhere=a_y")
        with h5py.File(path, "w") as file:
            file["pose"] = numpy.zeros(9, dtype=[("at", [("x", "f8")])])
        self.refused_for("pose.at (a compound)", "identify", path)

    def test_our_own_exports_come_back(self):
        bag = self.ros_bag()
        mat, hdf5 = self.folder / "e.mat", self.folder / "e.h5"
        self.run_verb("export", bag, "--mat", mat, "--hdf5", hdf5)
        tables = [f"x{topic}" for topic in ("_imu_data", "_stick_wrench")]
        self.assert_same(hdf5, "--map", f"{tables[0]}/linear_acceleration_y=a_y", f"{tables[1]}/wrench_force_y=f",
                         "--sample-rate", RATE_HZ)
        self.assert_same(mat, "--map", f"{tables[0]}.linear_acceleration_y=a_y", f"{tables[1]}.wrench_force_y=f",
                         "--sample-rate", RATE_HZ)

    # Sound

    def test_a_wav_file_of_whole_numbers(self):
        """Two channels of 16 bits; a sample of 1 stands for 5 g and 40 N."""
        counts = [numpy.round(values / limit * 32767).astype("<i2")
                  for values, limit in ((self.acc, 49.05), (self.force, 40.0))]
        path, table = self.folder / "logger.wav", self.folder / "logger.csv"
        with wave.open(str(path), "wb") as file:
            file.setnchannels(2)
            file.setsampwidth(2)
            file.setframerate(RATE_HZ)
            file.writeframes(numpy.column_stack(counts).tobytes())
        lines = ["t [s],a_y [m/s^2],f [N]"]
        for n in range(ROWS):
            lines.append(f"{n / RATE_HZ!r},{int(counts[0][n]) / 32768 * 49.05!r},{int(counts[1][n]) / 32768 * 40.0!r}")
        table.write_text("\n".join(lines) + "\n")
        self.assertEqual(
            self.identified(path, "--map", "channel 1=a_y [m/s^2] * 49.05", "channel 2=f [N] * 40"),
            self.identified(table))
        self.refused_for("--map 'channel 1=a_y [m/s^2]' 'channel 2=f [N]'", "identify", path)
        whole = path.read_bytes()
        path.write_bytes(whole[: len(whole) * 2 // 3])
        self.run_verb("identify", path, "--map", "channel 1=a_y [m/s^2] * 49.05", "channel 2=f [N] * 40", "--json",
                      self.folder / "cut.json")
        self.assertIn("cut off", " ".join(json.loads((self.folder / "cut.json").read_text())["notes"]))

    @unittest.skipIf(soundfile is None, "soundfile is not installed")
    def test_a_wav_file_of_doubles(self):
        path = self.folder / "double.wav"
        soundfile.write(path, numpy.column_stack([self.acc, self.force]), RATE_HZ, subtype="DOUBLE")
        self.assert_same(path, "--map", "channel 1=a_y [m/s^2]", "channel 2=f [N]")

    # ROS 2

    def ros_bag(self):
        path = self.folder / "ros.mcap"
        if not path.exists():
            try:
                official.install()
            except SystemExit:
                self.skipTest("the MCAP project's library cannot be installed")
            written = official.node("write_ros2.mjs", self.own, path)
            self.assertEqual(written.returncode, 0, written.stderr)
        return path

    def test_a_ros_2_recording(self):
        words = ["--map", "/imu/data.linear_acceleration.y=a_y", "/stick/wrench.wrench.force.y=f"]
        self.assert_same(self.ros_bag(), *words)
        line = self.refused("identify", self.ros_bag())
        self.assertIn("'/imu/data.linear_acceleration.y=a_y [m/s^2]'", line)
        self.assertIn("'/stick/wrench.wrench.force.y=f [N]'", line)

    # Verbs, terminal, damage

    def test_the_other_verbs_read_it_too(self):
        path = self.folder / "verbs.csv"
        self.table(path, "time;acc;force", separator=";", decimal=",")
        model, out = self.folder / "model.json", self.folder / "prediction.csv"
        for words in (["diagnose", path, *MAP, "--most-effects", "0", "--save", model],
                      ["predict", model, path, *MAP[:3], "--out", out],
                      ["control-model", model, path, *MAP, "--save", self.folder / "control.json"],
                      ["close-the-loop", "--pegged", path, *MAP, "--out", self.folder / "loop"]):
            self.run_verb(*words)
        self.assertGreater(len(out.read_text().splitlines()), 2900)

    def test_a_mapping_file_is_asked_for_and_written(self):
        path, mapping = self.folder / "asked.csv", self.folder / "ride.yaml"
        self.table(path, "when,acc,force")
        self.refused_for("--map-file: got", "identify", path, "--map-file", mapping)
        primary, secondary = pty.openpty()
        answers = ["", "acc [m/s^2]", "", ""]
        lab = subprocess.Popen([STILLHAND, "identify", str(path), "--map-file", str(mapping)], stdin=secondary,
                               stdout=subprocess.PIPE, stderr=secondary)
        os.close(secondary)
        shown = ""
        for answer in answers:
            while not re.search(r"\([^)]*\): $", shown):
                ready, _, _ = select.select([primary], [], [], 30)
                self.assertTrue(ready, shown)
                shown += os.read(primary, 4096).decode()
            os.write(primary, (answer + "\n").encode())
            shown += os.read(primary, 1).decode()  # the echo
        output, _ = lab.communicate(timeout=60)
        os.close(primary)
        self.assertEqual(lab.returncode, 0, shown)
        self.assertIn("free run", output.decode())
        self.assertIn("when=t [s]", mapping.read_text())
        self.assert_same(path, "--map-file", mapping)

    def test_a_damaged_file_is_read_or_refused_in_one_line(self):
        files = {"a.csv": MAP, "a.wav": ["--map", "channel 1=a_y [m/s^2]", "channel 2=f [N]"]}
        self.table(self.folder / "a.csv", "time;acc;force", separator=";", decimal=",")
        with wave.open(str(self.folder / "a.wav"), "wb") as file:
            file.setnchannels(2)
            file.setsampwidth(2)
            file.setframerate(RATE_HZ)
            file.writeframes(numpy.round(numpy.column_stack([self.acc, self.force]) * 500).astype("<i2").tobytes())
        if scipy is not None:
            scipy.io.savemat(self.folder / "a.mat", {"time": self.time, "acc": self.acc, "log": {"force": self.force}})
            files["a.mat"] = ["--map", "time=t [s]", "acc=a_y", "log.force=f"]
        if h5py is not None:
            with h5py.File(self.folder / "a.h5", "w") as file:
                for name, values in (("time", self.time), ("acc", self.acc), ("force", self.force)):
                    file.create_dataset(name, data=values, compression="gzip")
            files["a.h5"] = MAP
        random.seed(20241125)
        ends = {}
        for name, words in files.items():
            whole = (self.folder / name).read_bytes()
            out = self.folder / "damaged.json"
            for round_ in range(DAMAGED_EACH):
                spoilt = bytearray(whole)
                if round_ % 2:
                    del spoilt[random.randrange(len(spoilt)):]
                # Most of a file is numbers; the structure lies at its beginning and end.
                places = [len(spoilt), min(len(spoilt), 2000)]
                for _ in range(random.randrange(1, 6)):
                    if spoilt:
                        spoilt[random.randrange(max(1, random.choice(places)))] ^= 1 << random.randrange(8)
                path = self.folder / ("spoilt-" + name)
                path.write_bytes(spoilt)
                out.unlink(missing_ok=True)
                run = stillhand("identify", path, *words, "--json", out)
                with self.subTest(name, round=round_):
                    self.assertIn(run.returncode, (0, 2), run.stderr)
                    self.assertEqual(out.exists(), run.returncode == 0)
                    if run.returncode == 2:
                        self.assertEqual(run.stderr.count("\n"), 1, run.stderr)
                ends.setdefault(name, set()).add(run.returncode)
        for name, seen in ends.items():
            self.assertIn(2, seen, name + " was never refused: the damage is too small")


if __name__ == "__main__":
    lab_process.main()
