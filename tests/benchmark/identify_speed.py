#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The paper's least squares next to NumPy's, in one run, on the same 120 s recording at 100 Hz.

    STILLHAND_BUILD=build python3 tests/benchmark/identify_speed.py

Samples lie in memory before the clock starts, nine parameters are there when it stops; process start and file reading
count for neither.  Medians of 200 repetitions, in three rounds that take turns; the least of three counts on either side.
"""
import json
import os
import pathlib
import subprocess
import time

import numpy

try:
    import scipy.signal
except ImportError:
    scipy = None

BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", "build"))
ORDER = 4
REPETITIONS = 200
ROUNDS = 3


def recording():
    """Band-limited motion, a body with poles at 3.3 and 9 Hz, 0.05 N of noise."""
    random = numpy.random.default_rng(1)
    count = 12000
    spectrum = numpy.fft.rfft(random.standard_normal(count))
    hz = numpy.fft.rfftfreq(count, 0.01)
    spectrum /= numpy.sqrt(1.0 + (hz / 4.0) ** 4)
    a = numpy.fft.irfft(spectrum)
    a *= 1.6 / a.std()
    poles = numpy.exp(numpy.array([-0.09 + 0.207j, -0.09 - 0.207j, -0.2 + 0.565j, -0.2 - 0.565j]))
    d = numpy.poly(poles).real
    c = -3.2 * d.sum() * numpy.array([0.1, 0.2, 0.4, 0.2, 0.1])
    f = numpy.zeros(count)
    for n in range(ORDER, count):
        f[n] = c @ a[n - ORDER:n + 1][::-1] - d[1:] @ f[n - ORDER:n][::-1]
    return a, f + 0.05 * random.standard_normal(count)


def fit(a, f):
    rows = len(f) - ORDER
    matrix = numpy.empty((rows, 2 * ORDER + 1))
    for i in range(ORDER + 1):
        matrix[:, i] = a[ORDER - i:len(a) - i]
    for j in range(1, ORDER + 1):
        matrix[:, ORDER + j] = -f[ORDER - j:len(f) - j]
    return numpy.linalg.lstsq(matrix, f[ORDER:], rcond=None)[0]


def normal_equations(a, f):
    rows = len(f) - ORDER
    matrix = numpy.empty((rows, 2 * ORDER + 1))
    for i in range(ORDER + 1):
        matrix[:, i] = a[ORDER - i:len(a) - i]
    for j in range(1, ORDER + 1):
        matrix[:, ORDER + j] = -f[ORDER - j:len(f) - j]
    return numpy.linalg.solve(matrix.T @ matrix, matrix.T @ f[ORDER:])


def low_passed(samples):
    b, a = scipy.signal.butter(5, 10.0, fs=100.0)
    return scipy.signal.lfilter(b, a, samples)[::2]


def median_ms(work):
    times = []
    for _ in range(REPETITIONS):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return 1e3 * sorted(times)[REPETITIONS // 2]


def main():
    a, f = recording()
    ours, theirs = {}, {}

    def keep(least, found):
        for name, ms in found.items():
            least[name] = min(ms, least.get(name, ms))

    slow_a, slow_f = (low_passed(a), low_passed(f)) if scipy else (a[::2].copy(), f[::2].copy())
    for _ in range(ROUNDS):
        run = subprocess.run([BUILD / "tests" / "identify_speed", str(REPETITIONS)],
                             input=numpy.concatenate([a, f]).tobytes(), capture_output=True, check=True)
        printed = json.loads(run.stdout)
        parameters = numpy.array(printed.pop("parameters"))
        printed.pop("parameters_all_samples")
        assert printed.pop("finite")
        keep(ours, printed)
        keep(theirs, {"fit": median_ms(lambda: fit(slow_a, slow_f)), "fit_all_samples": median_ms(lambda: fit(a, f)),
                      "normal": median_ms(lambda: normal_equations(slow_a, slow_f))})
        if scipy:
            keep(theirs, {"low_pass_and_fit": median_ms(lambda: fit(low_passed(a), low_passed(f)))})

    rows = [("samples at 50 Hz (6000) to nine parameters", ours["fit"], theirs["fit"]),
            ("samples at 100 Hz (12000) to nine parameters", ours["fit_all_samples"], theirs["fit_all_samples"]),
            ("the same at 50 Hz next to numpy.linalg.solve(A.T @ A, A.T @ f)", ours["fit"], theirs["normal"]),
            ("all of fit_arx(), which also checks the excitation, fits again without\n  the last quarter and judges "
             "both runs on it, next to the same bare lstsq", ours["checked"], theirs["fit"])]
    if scipy:
        rows += [("10 Hz low-pass, every second sample, nine parameters", ours["low_pass_and_fit"],
                  theirs["low_pass_and_fit"]),
                 ("low-pass and fit_arx(), next to low-pass and bare lstsq", ours["low_pass_and_checked"],
                  theirs["low_pass_and_fit"])]
    else:
        print("scipy isn't installed: no low-pass to compare with; the samples at 50 Hz are every second one")
    print(f"numpy {numpy.__version__}" + (f", scipy {scipy.__version__}" if scipy else "") + "; times in ms")
    print("    ours   NumPy  ratio")
    for name, mine, other in rows:
        print(f"{mine:8.3f}{other:8.3f}{other / mine:7.1f}  {name}")
    if scipy:
        difference = numpy.max(numpy.abs(parameters - fit(slow_a, slow_f)) / numpy.abs(parameters))
        print(f"largest relative difference of a parameter {difference:.1e} (of two low-passes and two solvers)")


if __name__ == "__main__":
    main()
