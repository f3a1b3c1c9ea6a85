#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`stillhand identify` next to NumPy's least squares and Octave's `arx`, on the same file.

    STILLHAND_BUILD=build /usr/bin/python3 tests/benchmark/identify_peers.py                # 10^3 to 10^5 rows
    STILLHAND_BUILD=build /usr/bin/python3 tests/benchmark/identify_peers.py --rows 1000 10000 100000 1000000 10000000

The file is CSV at 100 Hz. Each program starts, reads it, fits order 4 with nine parameters and prints: processor time,
median of --repeats, all programs take turns. `identify` does more than the peers, which fit the rows as they are: it
low-passes at 10 Hz, keeps every second row, checks the excitation, fits again without the last quarter and judges both.
`fit` is bare least squares of all rows, from samples in memory to nine parameters, in each program; ours through
tests/identify_speed. Coefficients of these fits: largest difference from NumPy's over the largest coefficient. Without
Octave (packages octave, octave-control) its columns are left out.
"""
import argparse
import json
import os
import pathlib
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile

import numpy

BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", "build"))
ORDER = 4
NUMPY = r"""
import sys, time, json, numpy
table = numpy.loadtxt(sys.argv[1], delimiter=",", skiprows=1)
a, f = table[:, 1], table[:, 2]
begin = time.process_time()
p = 4
rows = len(f) - p
matrix = numpy.empty((rows, 2 * p + 1))
for i in range(p + 1):
    matrix[:, i] = a[p - i:len(a) - i]
for j in range(1, p + 1):
    matrix[:, p + j] = -f[p - j:len(f) - j]
found = numpy.linalg.lstsq(matrix, f[p:], rcond=None)[0]
print(json.dumps({"fit_s": time.process_time() - begin, "parameters": list(found)}))
"""
OCTAVE = r"""
pkg load control;
args = argv();
table = dlmread(args{1}, ",", 1, 0);
# arx takes the input from one sample before on: moved by one, it sees the same sample too.
set = iddata(table(1:end-1, 3), table(2:end, 2), 0.01);
begin = cputime();
model = arx(set, "na", 4, "nb", 5, "nk", 0);
spent = cputime() - begin;
[num, den] = tfdata(model);  # of the input, then of the noise
num = [zeros(1, 5 - numel(num{1, 1})) num{1, 1}];
den = den{1, 1};
text = @(x) strjoin(arrayfun(@(y) sprintf("%.17g", y), x, "UniformOutput", false), ", ");
printf("{\"fit_s\": %.9g, \"parameters\": [%s]}\n", spent, text([num den(2:5)]));
"""


def write_recording(path, rows):
    """Band-limited motion through a body with poles at 3.3 and 9 Hz, 0.05 N of noise; block by block."""
    random = numpy.random.default_rng(1)
    poles = numpy.exp(numpy.array([-0.09 + 0.207j, -0.09 - 0.207j, -0.2 + 0.565j, -0.2 - 0.565j]))
    d = numpy.poly(poles).real
    c = -3.2 * d.sum() * numpy.array([0.1, 0.2, 0.4, 0.2, 0.1])
    impulse = numpy.zeros(400)
    for n in range(400):
        impulse[n] = (c[n] if n <= ORDER else 0.0) - sum(d[j] * impulse[n - j] for j in range(1, ORDER + 1) if n >= j)
    block = 1_000_000
    tail = numpy.zeros(len(impulse) - 1)
    with open(path, "w") as file:
        file.write("t [s],a_y [m/s^2],f [N]\n")
        for first in range(0, rows, block):
            count = min(block, rows - first)
            spectrum = numpy.fft.rfft(random.standard_normal(count))
            spectrum /= numpy.sqrt(1.0 + (numpy.fft.rfftfreq(count, 0.01) / 4.0) ** 4)
            a = numpy.fft.irfft(spectrum, count)
            a *= 1.6 / a.std()
            length = 1 << (count + 2 * len(impulse)).bit_length()
            whole = numpy.concatenate([tail, a])
            f = numpy.fft.irfft(numpy.fft.rfft(whole, length) * numpy.fft.rfft(impulse, length), length)
            f = f[len(tail):len(tail) + count] + 0.05 * random.standard_normal(count)
            tail = whole[-len(tail):]
            t = (first + numpy.arange(count)) * 0.01
            numpy.savetxt(file, numpy.column_stack([t, a, f]), delimiter=",", fmt=("%.2f", "%.9g", "%.9g"))


def timed(words):
    """Processor time of a program, all its threads, and what it printed."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run = subprocess.run([str(word) for word in words], capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if run.returncode:
        sys.exit(f"identify_peers: {words[0]}: {run.stderr.strip()[-400:]}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, run.stdout


def core(path):
    """Our least squares from samples in memory, through tests/identify_speed: seconds and parameters."""
    table = numpy.loadtxt(path, delimiter=",", skiprows=1)
    run = subprocess.run([BUILD / "tests" / "identify_speed", "3"], input=table[:, 1].tobytes() + table[:, 2].tobytes(),
                         capture_output=True, check=True)
    found = json.loads(run.stdout)
    return found["fit_all_samples"] / 1e3, found["parameters_all_samples"]


def main():
    words = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    words.add_argument("--rows", type=int, nargs="+", default=[1000, 10_000, 100_000])
    words.add_argument("--repeats", type=int, default=3)
    options = words.parse_args()
    octave = shutil.which("octave-cli") or shutil.which("octave")
    print("| rows | identify [s] | NumPy [s] | Octave [s] | NumPy/ours | Octave/ours | fit: ours, NumPy, Octave [ms] "
          "| coefficients: ours, Octave |\n| --- | --- | --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        (folder / "fit.py").write_text(NUMPY)
        (folder / "fit.m").write_text(OCTAVE)
        for rows in options.rows:
            path = folder / "recording.csv"
            write_recording(path, rows)
            programs = {"ours": [BUILD / "bin" / "stillhand", "identify", path, "--json", folder / "out.json"],
                        "numpy": ["/usr/bin/python3", folder / "fit.py", path]}
            if octave:
                programs["octave"] = [octave, "--no-gui", "--quiet", folder / "fit.m", path]
            spent = {name: [] for name in programs}
            fits = {name: [] for name in programs}
            parameters = {}
            for _ in range(options.repeats):
                for name, command in programs.items():
                    seconds, text = timed(command)
                    spent[name].append(seconds)
                    if name != "ours":
                        said = json.loads(text.strip().splitlines()[-1])
                        fits[name].append(said["fit_s"])
                        parameters[name] = numpy.array(said["parameters"])
                seconds, found = core(path)
                fits["ours"].append(seconds)
                parameters["ours"] = numpy.array(found)
            cpu = {name: statistics.median(each) for name, each in spent.items()}
            fit = {name: 1e3 * statistics.median(each) for name, each in fits.items()}
            scale = numpy.max(numpy.abs(parameters["numpy"]))
            off = {name: numpy.max(numpy.abs(each - parameters["numpy"])) / scale for name, each in parameters.items()}
            show = lambda table, name, form: form.format(table[name]) if name in table else "-"
            ratio = lambda name: f"{cpu[name] / cpu['ours']:.1f}" if name in cpu else "-"
            print(f"| {rows:.0e} | {cpu['ours']:.3f} | {cpu['numpy']:.3f} | {show(cpu, 'octave', '{:.3f}')} "
                  f"| {ratio('numpy')} | {ratio('octave')} "
                  f"| {fit['ours']:.2f}, {fit['numpy']:.2f}, {show(fit, 'octave', '{:.2f}')} "
                  f"| {off['ours']:.0e}, {show(off, 'octave', '{:.0e}')} |", flush=True)


if __name__ == "__main__":
    main()
