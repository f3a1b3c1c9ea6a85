#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fresh recordings: bodies, rides and effects that neither the residual engine nor the project's simulators know.

Each record is a pair: rec_0001_train.csv (120 s) and rec_0001_test.csv (90 s), two rides of one body at 100 Hz with
jitter, gaps and sensor noise; rec_0001_test.noise_free.csv holds what the inputs determine of the test's force, and
rec_0001.truth.json the effects, their sizes, the error of the best linear model and the least error possible. Of six
records one has no effect; of the others every second one's first effect is of a well-known kind. A record is
determined by the seed and its number.

    python3 tests/naming/fresh_bodies.py --count 60 --seed 1 --out DIR      # about 10 s of a processor a record
    python3 tests/naming/fresh_bodies.py --count 60 --sealed TRUTH --out DIR

A sealed set has a seed that nobody chose or knows, and its records are shuffled. DIR holds what a tool may read and
seal.sha256, the digests of TRUTH, which stays with the judge until the entries are in. The same with --seed, which is
in the truth, makes the set again.
"""
import argparse
import hashlib
import json
import os
import pathlib
import secrets
import sys

import numpy
import scipy.signal

import fresh_effects
from fresh_rides import LEAD_S, RATE_HZ, ROW_HZ, Body, Ride, drawn_levels, involuntary

TRAIN_S, TEST_S, CALIBRATION_S = 120.0, 90.0, 40.0
SHARES = (0.05, 0.40)  # of the force that a linear model leaves because of an effect
VAF = (0.80, 0.97)
TWO_EFFECTS = 0.4
NO_EFFECT_EVERY = 6
TAPS = 200  # 2 s
EDGE_HZ = 10.0
CHANNELS = {"a_y": ("m/s^2", 0.02), "a_x": ("m/s^2", 0.02), "a_z": ("m/s^2", 0.02), "roll": ("rad", 0.0003),
            "theta": ("rad", 0.0003), "omega": ("rad/s", 0.01), "temp": ("degC", 0.02), "grip": ("N", 0.2), "f": ("N", 0.02)}
ALWAYS = ("a_y", "theta", "omega", "f")


def rms(values):
    return float(numpy.sqrt(numpy.mean(numpy.square(values))))


def regressors(a, taps=TAPS):
    padded = numpy.concatenate([numpy.full(taps - 1, a[0]), a])
    return numpy.lib.stride_tricks.sliding_window_view(padded, taps)[:, ::-1]


def best_linear(train, test):
    """Prediction of the test's force by a response of 2 s, fitted on train with the prior that it decays (TC kernel;
    Chen, Ohlsson and Ljung 2012); its width and weight are chosen on the last quarter of train."""
    (a, f), (a_test, _) = train, test
    x, split = regressors(a - a.mean()), int(0.75 * a.size)
    offset = f.mean()
    index = numpy.arange(1, TAPS + 1)

    def fit(rows, decay, weight):
        root = numpy.linalg.cholesky(decay ** numpy.maximum.outer(index, index) + 1e-12 * numpy.eye(TAPS))
        z = x[rows] @ root
        normal = z.T @ z
        normal += weight * numpy.trace(normal) / TAPS * numpy.eye(TAPS)
        return root @ numpy.linalg.solve(normal, z.T @ (f[rows] - offset))

    tried = [(rms(f[split:] - offset - x[split:] @ fit(slice(TAPS, split), decay, weight)), decay, weight)
             for decay in (0.9, 0.95, 0.98) for weight in (1e-5, 1e-3, 1e-1)]
    return offset + regressors(a_test - a.mean()) @ fit(slice(TAPS, None), *min(tried)[1:])


def left_by_linear(a, f):
    """RMS that a plain response of 1 s leaves of a noise-free force, fitted on the same samples."""
    x = numpy.column_stack([regressors(a, 100), numpy.ones(a.size)])[100:]
    return rms(f[100:] - x @ numpy.linalg.lstsq(x, f[100:], rcond=1e-6)[0])


def at_rows(signal):
    """Samples of t >= 0 at ROW_HZ."""
    return signal[int(LEAD_S * RATE_HZ)::RATE_HZ // ROW_HZ]


def forces(body, effects, columns):
    """The force that the inputs determine, for each column (ride, strength of each effect)."""
    length = max(ride.t.size for ride, _ in columns)
    felt = numpy.zeros((len(columns), length))
    for row, (ride, strengths) in zip(felt, columns):
        a = ride.a_y
        for effect, s in zip(effects, strengths):
            a = effect.felt(a, ride, s) if effect.felt else a
        row[:ride.t.size] = a
    strength = numpy.array([strengths for _, strengths in columns], dtype=float).T
    inside = [(effect.element, effect.law(s)) for effect, s in zip(effects, strength) if effect.law]
    reflex = [effect.reflex(s) for effect, s in zip(effects, strength) if effect.reflex]
    out = body.force(felt, inside, reflex[0] if reflex else None)
    return [force[:ride.t.size] + sum(effect.added(ride, s) for effect, s in zip(effects, strengths) if effect.added)
            for force, (ride, strengths) in zip(out, columns)]


def behind(force, effects, ride, strengths):
    for effect, s in zip(effects, strengths):
        force = effect.mapped(force, ride, s) if effect.mapped else force
    return force


def sensed(ride, effects, strengths):
    return next((effect.sensed(ride, s) for effect, s in zip(effects, strengths) if effect.sensed), ride.a_y)


def calibrated(body, effect, ride, share):
    """Strength at which a linear model leaves `share` of the force, or the one that comes nearest."""
    columns = [(ride, (s,)) for s in effect.strengths]
    left = []
    for force, (_, strengths) in zip(forces(body, [effect], columns), columns):
        f = at_rows(behind(force, [effect], ride, strengths))
        sound = numpy.all(numpy.isfinite(f)) and f.std() < 1e3
        left.append(left_by_linear(at_rows(sensed(ride, [effect], strengths)), f) / f.std() if sound else 0.0)
    left = numpy.array(left)
    reach = int(numpy.argmax(left)) + 1  # beyond its maximum an effect becomes linear again
    if share >= left[:reach].max():
        return float(effect.strengths[reach - 1])
    return float(numpy.exp(numpy.interp(share, numpy.maximum.accumulate(left[:reach]), numpy.log(effect.strengths[:reach]))))


class Record:
    def __init__(self, seed, number, known, outside):
        self.seed, self.number = seed, number
        self.random = random = numpy.random.default_rng([seed, number])
        kind = random.choice(["slow", "wide", "road", "multisine"])
        self.body = Body(random)
        levels = drawn_levels(random)
        self.rides = [Ride(random, kind, TRAIN_S, levels), Ride(random, kind, TEST_S, levels)]
        short = Ride(random, kind, CALIBRATION_S, levels)
        scales = fresh_effects.Scales(self.body, short)
        self.effects, self.strengths = [], []
        for makes in self.chosen(known, outside):
            effect = makes(random, scales)
            share = random.uniform(*SHARES)
            self.effects.append(effect)
            self.strengths.append(calibrated(self.body, effect, short, share) if effect.calibrated else 1.0)
        self.simulate()

    def chosen(self, known, outside):
        if self.number % NO_EFFECT_EVERY == NO_EFFECT_EVERY - 1:
            return []
        turn = self.number - self.number // NO_EFFECT_EVERY
        first = (known, outside)[turn % 2][turn // 2 % len((known, outside)[turn % 2])]
        second = (known, outside)[self.random.integers(2)]
        second = second[self.random.integers(len(second))]
        two = self.random.random() < TWO_EFFECTS and second is not first
        return [first, second] if two else [first]

    def simulate(self):
        """Of both rides the force with all effects, and for the truth without each one."""
        full = tuple(self.strengths)
        sets = [full] + [tuple(0.0 if j == i else s for j, s in enumerate(full)) for i in range(len(full))]
        columns = [(ride, strengths) for ride in self.rides for strengths in sets]
        made = forces(self.body, self.effects, columns)
        noise = [involuntary(self.random, ride) for ride in self.rides]
        determined = made[0][int(LEAD_S * RATE_HZ):]
        vaf = self.random.uniform(*VAF)
        self.noise_n = determined.std() * numpy.sqrt(1.0 / vaf - 1.0)
        count = len(sets)
        self.a_y = [sensed(ride, self.effects, full) for ride in self.rides]
        self.free = [behind(made[i * count], self.effects, ride, full) for i, ride in enumerate(self.rides)]
        self.without = [behind(made[count + i], self.effects, self.rides[1], strengths) for i, strengths in enumerate(sets)][1:]
        self.measured = [behind(made[i * count] + self.noise_n * noise[i], self.effects, ride, full)
                         for i, ride in enumerate(self.rides)]

    def rows(self, which, kept):
        """Times and columns of one recording."""
        random, ride = self.random, self.rides[which]
        count = int(ride.length_s * ROW_HZ)
        jitter_s = random.choice([0.0, 0.0003, 0.001])
        times = numpy.arange(count) / ROW_HZ + numpy.clip(jitter_s * random.standard_normal(count), -0.004, 0.004)
        times[0] = 0.0
        there = random.random(count) > random.choice([0.0, 0.002, 0.01])
        for _ in range(random.integers(0, 4)):
            start = random.integers(0, count - 200)
            there[start:start + int(random.uniform(5, 150))] = False
        there[0] = there[-1] = True
        times = times[there]
        signals = {name: getattr(ride, name) for name in CHANNELS if name not in ("a_y", "f")}
        signals.update(a_y=self.a_y[which], f=self.measured[which])
        table = {"t": numpy.round(times, 6)}
        for name in kept:
            noise = CHANNELS[name][1]
            value = numpy.interp(times, ride.t, signals[name]) + noise * random.standard_normal(times.size)
            digit = 0.5 * noise  # quantised as converters do, at half of the noise
            table[name] = digit * numpy.round(value / digit)
        return table, numpy.interp(times, ride.t, self.free[which])

    def channels(self):
        """a_y, stick and force always; of the others each in three of four records, but those of an effect always."""
        needed = {part for effect in self.effects for part in (effect.channel or "").split("*")}
        return [name for name in CHANNELS if name in ALWAYS or name in needed or self.random.random() < 0.75]

    def write(self, folder, sealed=None, place=None):
        """@param sealed  where the truth and the force of the test go, if not to the folder
        @param place  its number in the folder, if not its own"""
        name = f"rec_{(self.number if place is None else place) + 1:04d}"
        kept = self.channels()
        (train, _), (test, free) = self.rows(0, kept), self.rows(1, kept)
        write_csv(folder / f"{name}_train.csv", train)
        if sealed:
            write_csv(folder / f"{name}_test.csv", {column: test[column] for column in test if column != "f"})
        truth = sealed or folder
        write_csv(truth / f"{name}_test.csv", test)
        write_csv(truth / f"{name}_test.noise_free.csv", {"t": test["t"], "f_noise_free": numpy.round(free, 5)})
        (truth / f"{name}.truth.json").write_text(json.dumps(self.truth((train, test), free), indent=1) + "\n")

    def truth(self, tables, free):
        grid = [(at_rows(a), at_rows(f)) for a, f in zip(self.a_y, self.measured)]
        linear = best_linear(*grid)
        truth = at_rows(self.free[1])
        measured = grid[1][1]
        rows = tables[1]
        on_rows = numpy.interp(rows["t"], numpy.arange(linear.size) / ROW_HZ, linear)
        low = scipy.signal.butter(4, EDGE_HZ, fs=ROW_HZ, output="sos")

        def below(values):
            return rms(scipy.signal.sosfiltfilt(low, values))
        effects = []
        for effect, strength, without in zip(self.effects, self.strengths, self.without):
            effects.append({"kind": effect.kind, "known": effect.known, "channel": effect.channel, "element": effect.element,
                            "right": effect.right, "strength": strength, "parameters_at_strength_1": effect.parameters,
                            "share_of_force": rms(truth - at_rows(without)) / truth.std()})
        return {"seed": self.seed, "record": self.number + 1, "ride": self.rides[0].kind, "masses": self.body.mass.size,
                "reflex_delay_s": self.body.delay_steps / RATE_HZ, "effects": effects,
                "not_linear_share": left_by_linear(grid[1][0], truth) / truth.std(),
                "involuntary_rms_n": self.noise_n,
                "test": {"force_rms_n": float(rows["f"].std()), "linear_rmse_n": rms(rows["f"] - on_rows),
                         "oracle_rmse_n": rms(rows["f"] - free), "linear_rmse_10_hz_n": below(measured - linear),
                         "oracle_rmse_10_hz_n": below(measured - truth)}}


def write_csv(path, table):
    units = dict({name: unit for name, (unit, _) in CHANNELS.items()}, t="s", f_noise_free="N")
    titles = ",".join(f"{name} [{units[name]}]" for name in table)
    numpy.savetxt(path, numpy.column_stack(list(table.values())), delimiter=",", header=titles, comments="", fmt="%.7g")


def write_seal(truth, path):
    """Digests of the truth's files, as `sha256sum -c` reads them."""
    lines = [f"{hashlib.sha256(file.read_bytes()).hexdigest()}  {file.name}\n" for file in sorted(truth.glob("rec_*"))]
    path.write_text("".join(lines))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--seed", type=int, help="default: 1; of a sealed set drawn")
    parser.add_argument("--sealed", type=pathlib.Path, metavar="TRUTH",
                        help="an empty folder for what a tool may not read")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    words = parser.parse_args()
    for folder in filter(None, (words.out, words.sealed)):
        folder.mkdir(parents=True, exist_ok=True)
    if words.sealed and (any(any(folder.iterdir()) for folder in (words.out, words.sealed))
                         or words.out.resolve() == words.sealed.resolve()):
        parser.error("a sealed set wants two empty folders")
    seed = words.seed if words.seed is not None else secrets.randbits(64) if words.sealed else 1
    deck = numpy.random.default_rng([seed, 1 << 20])
    known, outside = (list(deck.permutation(numpy.array(kinds, dtype=object)))
                      for kinds in (fresh_effects.KNOWN, fresh_effects.OUTSIDE))
    # A record's own number says whether it has an effect.
    order = numpy.random.default_rng([seed, 1 << 21]).permutation(words.count) if words.sealed else range(words.count)
    for place, number in enumerate(order):
        record = Record(seed, int(number), known, outside)
        record.write(words.out, words.sealed, place)
        what = "sealed" if words.sealed else ", ".join(effect.kind for effect in record.effects) or "no effect"
        print(f"rec_{place + 1:04d}: {what}", flush=True)
    if words.sealed:
        write_seal(words.sealed, words.out / "seal.sha256")
        for path in words.out.iterdir():  # how long a record took says something of it
            os.utime(path, (0, 0))


if __name__ == "__main__":
    sys.exit(main())
