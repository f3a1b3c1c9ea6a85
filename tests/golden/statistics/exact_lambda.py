#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes exact_lambda.hpp: Wilks' lambda (ST-8) of main effects in exact rational arithmetic."""
import csv
from fractions import Fraction


def determinant(matrix):
    """Gaussian elimination; no pivot of these positive definite matrices is zero."""
    rows, product = [row[:] for row in matrix], Fraction(1)
    for i in range(len(rows)):
        product *= rows[i][i]
        for k in range(i + 1, len(rows)):
            factor = rows[k][i] / rows[i][i]
            rows[k] = [a - factor * b for a, b in zip(rows[k], rows[i])]
    return product


def cross_products(vectors):
    columns = list(zip(*vectors))
    return [[sum(a * b for a, b in zip(x, y)) for y in columns] for x in columns]


def mean(vectors):
    return [sum(column) / len(vectors) for column in zip(*vectors)]


def lambdas(file, subjects, conditions, metrics):
    with open(file, newline="") as table:
        y = {(int(row["subject"]), int(row["condition"])): [Fraction(row[f"metric_{k + 1}"]) for k in range(metrics)]
             for row in csv.DictReader(table)
             if row["replicate"] == "1" and int(row["subject"]) <= subjects and int(row["condition"]) <= conditions}
    grand = mean(list(y.values()))
    by_subject = {s: mean([v for (i, _), v in y.items() if i == s]) for s, _ in y}
    by_condition = {c: mean([v for (_, j), v in y.items() if j == c]) for _, c in y}
    error = cross_products([[a - b - d + g for a, b, d, g in zip(v, by_subject[s], by_condition[c], grand)]
                            for (s, c), v in y.items()])
    for effect in ([by_condition[c] for _, c in y], [by_subject[s] for s, _ in y]):
        hypothesis = cross_products([[a - g for a, g in zip(v, grand)] for v in effect])
        total = [[a + b for a, b in zip(*rows)] for rows in zip(error, hypothesis)]
        yield float(determinant(error) / determinant(total))


def main():
    cases = [(1, "strong_effects.csv", 20, 3, 3), (2, "replicated.csv", 9, 6, 4), (2, "replicated.csv", 6, 2, 5)]
    with open("exact_lambda.hpp", "w") as out:
        out.write("// SPDX-License-Identifier: Apache-2.0\n// Written by exact_lambda.py; see ORIGIN.md.\n#pragma once\n\n"
                  "namespace stillhand::golden::statistics {\n\n"
                  "struct ExactLambda {\n  int set, subjects, conditions, metrics;\n  double condition, subject;\n};\n"
                  "inline constexpr ExactLambda kExactLambdas[] = {\n")
        for number, file, *sizes in cases:
            values = [number, *sizes, *lambdas(file, *sizes)]
            out.write("    {" + ", ".join(repr(v) for v in values) + "},\n")
        out.write("};\n\n}  // namespace stillhand::golden::statistics\n")


if __name__ == "__main__":
    main()
