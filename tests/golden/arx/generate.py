#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes exact_fit.hpp: a short record and its least-squares fit (ID-2) in exact rational arithmetic."""
from fractions import Fraction

ORDER = 4
SAMPLES = 160


def numbers(seed):
    """Linear congruential generator of Numerical Recipes; upper 16 bits, centred."""
    state = seed
    while True:
        state = (1664525 * state + 1013904223) % 2**32
        yield (state >> 16) - 32768


def record():
    """Noise through a resonant filter with noise on the output, rounded to 1/4096: exact in binary."""
    source = numbers(1)
    a = [Fraction(next(source), 4096) for _ in range(SAMPLES)]
    c = [-2.9, 4.1, -3.0, 1.2, 0.3]
    d = [-2.2, 2.0, -0.9, 0.2]
    f = []
    for n in range(SAMPLES):
        value = sum(c[i] * float(a[n - i]) for i in range(5) if n >= i)
        value -= sum(d[j - 1] * float(f[n - j]) for j in range(1, 5) if n >= j)
        f.append(Fraction(round(value * 4096), 4096))
    return a, [x + Fraction(next(source), 4096 * 16) for x in f]


def solve(matrix, right):
    """Gauss elimination; exact, so any non-zero pivot will do."""
    rows = [list(row) + [b] for row, b in zip(matrix, right)]
    size = len(rows)
    for k in range(size):
        pivot = next(r for r in range(k, size) if rows[r][k] != 0)
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for r in range(size):
            if r != k:
                factor = rows[r][k] / rows[k][k]
                rows[r] = [x - factor * y for x, y in zip(rows[r], rows[k])]
    return [rows[k][size] / rows[k][k] for k in range(size)]


def fit(a, f):
    """Paper Eqs 4 and 5: b = (A^T A)^-1 A^T f."""
    rows = [
        [a[n - i] for i in range(ORDER + 1)] + [-f[n - j] for j in range(1, ORDER + 1)]
        for n in range(ORDER, SAMPLES)
    ]
    size = 2 * ORDER + 1
    normal = [[sum(row[i] * row[j] for row in rows) for j in range(size)] for i in range(size)]
    right = [sum(row[i] * f[n + ORDER] for n, row in enumerate(rows)) for i in range(size)]
    return solve(normal, right)


def array(name, values):
    text = ",\n    ".join(repr(float(v)) for v in values)
    return f"inline constexpr double {name}[] = {{\n    {text}}};\n"


def main():
    a, f = record()
    parameters = fit(a, f)
    with open("exact_fit.hpp", "w", encoding="ascii") as out:
        out.write("// SPDX-License-Identifier: Apache-2.0\n// Written by generate.py; see ORIGIN.md.\n")
        out.write("#pragma once\n\nnamespace stillhand::golden {\n\n")
        out.write(array("kAcceleration_m_s2", a) + array("kForce_n", f))
        out.write(array("kNumerator", parameters[: ORDER + 1]))
        out.write(array("kDenominatorFromD1", parameters[ORDER + 1 :]))
        out.write("\n}  // namespace stillhand::golden\n")


if __name__ == "__main__":
    main()
