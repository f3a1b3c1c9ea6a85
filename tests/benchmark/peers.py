# SPDX-License-Identifier: Apache-2.0
"""Two plain models of an output from one input, fitted by least squares: what a verdict has to be better than."""
import itertools
import math

import numpy

ROWS = 8000  # of the training file, at most: the peers stay within seconds


def rms(values):
    return math.sqrt(float(numpy.mean(values**2)))


def least_squares(columns, wanted, ridge=1e-9):
    square = columns.T @ columns
    square += ridge * numpy.trace(square) / len(square) * numpy.eye(len(square))
    return numpy.linalg.solve(square, columns.T @ wanted)


class ImpulseResponse:
    """y(n) = h + sum_k h_k u(n - k), ridge, before the first sample the input rests at it."""

    SIZES = [(taps, ridge) for taps in (30, 100, 300) for ridge in (1e-8, 1e-5, 1e-3)]

    def __init__(self, u, y, size):
        self.taps, ridge = size
        self.numbers = least_squares(self.columns(u), y, ridge)

    def columns(self, u):
        past = numpy.concatenate([numpy.full(self.taps, u[0]), u])
        lags = numpy.lib.stride_tricks.sliding_window_view(past, self.taps + 1)[:, ::-1]
        return numpy.column_stack([lags, numpy.ones(len(u))])

    def run(self, u, y, given):
        return self.columns(u) @ self.numbers


class Narx:
    """All products of up to `degree` of the last outputs and inputs; free run from the given samples."""

    SIZES = [(lags, degree) for lags in (1, 2, 3, 4) for degree in (1, 2, 3)]

    def __init__(self, u, y, size):
        self.lags, degree = size
        self.scale = max(numpy.abs(u).max(), 1e-12), max(numpy.abs(y).max(), 1e-12)
        u, y = u / self.scale[0], y / self.scale[1]
        variables = range(2 * self.lags + 1)
        self.products = [list(term) for d in range(degree + 1)
                         for term in itertools.combinations_with_replacement(variables, d)]
        rows = numpy.array([self.variables(u, y, n) for n in range(self.lags, len(y))])
        self.numbers = least_squares(numpy.column_stack([rows[:, term].prod(axis=1) for term in self.products]),
                                     y[self.lags:])

    def variables(self, u, y, n):
        return numpy.concatenate([y[n - self.lags:n], u[n - self.lags:n + 1]])

    def run(self, u, y, given):
        u, model = u / self.scale[0], y / self.scale[1]
        padded = [numpy.array(term + [2 * self.lags + 1] * (3 - len(term))) for term in self.products]
        table = numpy.array(padded)
        for n in range(max(given, self.lags), len(y)):
            values = numpy.append(self.variables(u, model, n), 1.0)
            model[n] = numpy.clip(values[table].prod(axis=1) @ self.numbers, -10, 10)
        return model * self.scale[1]


def chosen(kind, u, y, given=0):
    """The model of the size with the least error on the last quarter, fitted to all rows."""
    u, y = u[:ROWS], y[:ROWS]
    quarter = 3 * len(y) // 4
    best = {}
    for size in kind.SIZES:
        if size[0] * 4 > quarter:
            continue
        model = kind(u[:quarter], y[:quarter], size)
        best[size] = rms(model.run(u[quarter:], y[quarter:].copy(), given)[given:] - y[quarter + given:])
    return kind(u, y, min(best, key=best.get))
