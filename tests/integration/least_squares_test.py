#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The paper's Eq. 5 solved by NumPy on the same recording: parameters and frequency response to 1e-9."""
import json
import subprocess
import unittest

import numpy

import lab_process

FIT = lab_process.BUILD / "tests" / "pegged_fit"
ORDER = 4


class LeastSquaresTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        out = subprocess.run([FIT], capture_output=True, text=True, check=True).stdout
        cls.fit = json.loads(out)
        a = numpy.array(cls.fit["acceleration"])
        f = numpy.array(cls.fit["force"])
        rows = range(ORDER, len(f))
        matrix = numpy.array([[a[n - i] for i in range(ORDER + 1)] + [-f[n - j] for j in range(1, ORDER + 1)]
                              for n in rows])
        scale = numpy.linalg.norm(matrix, axis=0)  # else lstsq's rank cut-off sees two units as one
        solution, _, rank, _ = numpy.linalg.lstsq(matrix / scale, f[ORDER:], rcond=None)
        assert rank == 2 * ORDER + 1
        cls.parameters = solution / scale

    def test_parameters_agree_to_1e_9(self):
        ours = self.fit["numerator"] + self.fit["denominator"][1:]
        worst = numpy.max(numpy.abs(ours - self.parameters) / numpy.abs(self.parameters))
        print(f"largest relative difference of a parameter {worst:.1e}")
        self.assertLess(worst, 1e-9)

    def test_response_agrees_to_1e_9(self):
        worst = 0.0
        for hz, real, imaginary in self.fit["response"]:
            z = numpy.exp(-2j * numpy.pi * hz / self.fit["rate_hz"])
            powers = z ** numpy.arange(ORDER + 1)
            expected = (powers @ self.parameters[:ORDER + 1]) / (1.0 + powers[1:] @ self.parameters[ORDER + 1:])
            worst = max(worst, abs(complex(real, imaginary) - expected) / abs(expected))
        print(f"largest relative difference of the response {worst:.1e}")
        self.assertLess(worst, 1e-9)


if __name__ == "__main__":
    lab_process.main(FIT)
