# SPDX-License-Identifier: Apache-2.0
"""Rides and bodies for fresh_bodies.py: motion channels, a multi-mode body with a stretch reflex, involuntary force.

Written from physics and literature alone, without a look at the residual engine or at the project's other simulators.

Body: a chain of masses on springs and dampers, lateral positions q relative to the platform [m]:

    M q'' + C q' + K q = -M 1 a_y + n + r,    f = k_grip q_hand + c_grip q_hand'

The hand is held by the stick; f is the force of the hand on it, positive to the right. n is what an effect adds inside
the body, r the stretch reflex between trunk and arm. The linear part is integrated exactly (matrix exponential, a_y
linear between samples); n and r are held for one step of 0.5 ms, which is 0.18 % RMS of the force away from steps of
0.125 ms with a gap in the grip, 0.08 % with any other effect (2026-11-26).
"""
import numpy
import scipy.linalg
import scipy.signal

RATE_HZ = 2000
LEAD_S = 5.0  # simulated before t = 0, so that a record begins within the motion
G_M_S2 = 9.81
ROW_HZ = 100
CHANNEL_BANDS_HZ = {"a_x": (0.3, 4.0), "a_z": (0.7, 6.0), "roll": (0.03, 0.6), "theta": (0.1, 1.8)}
ELEMENTS = {3: ("seat", "shoulder", "wrist"), 4: ("seat", "shoulder", "elbow", "wrist"),
            5: ("seat", "waist", "shoulder", "elbow", "wrist")}


def shaped_noise(random, count, gain, rate_hz=RATE_HZ):
    """Gaussian noise with the amplitude gain(frequency [Hz]), RMS 1."""
    lines = numpy.fft.rfftfreq(count, 1.0 / rate_hz)
    size = gain(lines)
    size[0] = 0.0
    noise = numpy.fft.irfft(size * numpy.exp(2j * numpy.pi * random.random(lines.size)) *
                            numpy.sqrt(random.exponential(1.0, lines.size)), count)
    return noise / noise.std()


def band(low_hz, high_hz, slope=4):
    """Gain of a band-pass with Butterworth slopes."""
    def gain(lines):
        lines = numpy.maximum(lines, 1e-6)
        return 1.0 / numpy.sqrt((1.0 + (low_hz / lines) ** (2 * slope)) * (1.0 + (lines / high_hz) ** (2 * slope)))
    return gain


def road_gain(mode_hz):
    """A road after ISO 8608 (displacement ~ 1/n^2 in power, so velocity is white) through a body mode, ratio 0.35."""
    def gain(lines):
        s = 1j * lines / mode_hz
        return numpy.abs(s * (1.0 + 0.7 * s) / (1.0 + 0.7 * s + s * s)) * band(0.4, 5.0, 2)(lines)
    return gain


def drawn_levels(random):
    """RMS of each channel over the rides of one person [its SI unit]; of the grip the middle.

    a_y as on motion platforms for feedthrough studies, 0.7 to 2 m/s^2 (Venrooij 2014, chapter 3).
    """
    edges = {"a_y": (0.7, 1.5), "a_x": (0.5, 1.2), "a_z": (0.4, 1.0), "roll": (0.04, 0.12), "theta": (0.08, 0.16),
             "temp": (1.0, 3.0), "grip": (17.0, 23.0)}
    return {name: random.uniform(*ends) for name, ends in edges.items()}


class Ride:
    """The true channels of one ride at RATE_HZ, from -LEAD_S on."""

    def __init__(self, random, kind, length_s, levels):
        self.kind, self.length_s = kind, length_s
        level = {name: value * random.uniform(0.9, 1.1) for name, value in levels.items()}
        self.t = numpy.arange(int((LEAD_S + length_s) * RATE_HZ)) / RATE_HZ - LEAD_S
        count = self.t.size
        self.a_y = level["a_y"] * self.lateral(random, kind, count)
        drawn = {name: shaped_noise(random, count, band(*edges)) for name, edges in CHANNEL_BANDS_HZ.items()}
        shared = random.uniform(-0.3, 0.3, 2)
        lateral = self.a_y / self.a_y.std()
        self.a_x = level["a_x"] * (drawn["a_x"] + shared[0] * lateral)
        self.a_z = level["a_z"] * (drawn["a_z"] + shared[1] * lateral)
        self.roll = level["roll"] * drawn["roll"]
        # Stick angle of a tracking task with a bandwidth of 1 to 2 Hz (McRuer and Jex 1967).
        self.theta = level["theta"] * drawn["theta"]
        self.omega = numpy.gradient(self.theta, 1.0 / RATE_HZ)
        warm = shaped_noise(random, count, band(0.006, 0.03, 2))
        self.temp = 22.0 + level["temp"] * warm + random.uniform(-1.5, 1.5) * self.t / 120.0
        # Grip of 10 to 40 N with slow changes (de Vlugt 2003 asks for a constant grip; a free one wanders).
        squeeze = shaped_noise(random, count, band(0.02, 0.25, 2))
        self.grip = level["grip"] * numpy.exp(0.3 * squeeze)

    def lateral(self, random, kind, count):
        if kind == "multisine":
            lines = numpy.unique(numpy.round(numpy.geomspace(0.2, 4.0, 26) * 20) / 20)
            tone = sum(numpy.sin(2 * numpy.pi * (line * self.t + random.random())) for line in lines)
            return tone / tone.std()
        if kind == "road":
            noise = shaped_noise(random, count, road_gain(random.uniform(1.0, 1.6)))
            noise *= numpy.exp(0.35 * shaped_noise(random, count, band(0.02, 0.1, 2)))  # rough and smooth stretches
            return noise / noise.std()
        return shaped_noise(random, count, band(0.7, 2.0 if kind == "slow" else 4.0))


class Body:
    """Masses, springs and a reflex of one person."""

    def __init__(self, random):
        modes = int(random.integers(3, 6))
        self.elements = ELEMENTS[modes]
        # Trunk: moving part of 15 to 30 kg at 1.6 to 2.8 Hz, well damped (Fairley and Griffin 1990, lateral seat).
        # Arm: upper arm 2.8 %, forearm 1.6 %, hand 0.6 % of 75 kg (Winter 2009, table 4.1).
        trunk = [random.uniform(15, 30)] if modes < 5 else [random.uniform(8, 12), random.uniform(9, 18)]
        arm = [random.uniform(3.0, 3.9)] if modes == 3 else [random.uniform(1.8, 2.4), random.uniform(1.0, 1.4)]
        self.mass = numpy.array([*trunk, *arm, random.uniform(0.35, 0.55)])
        seat_hz = random.uniform(1.6, 2.8) * (1.4 if modes == 5 else 1.0)
        spring = {"seat": sum(trunk) * (2 * numpy.pi * seat_hz) ** 2,
                  "waist": trunk[-1] * (2 * numpy.pi * random.uniform(2.5, 4.0)) ** 2,
                  # Arm: 100 to 800 N/m, 8 to 30 N s/m at the hand (Mussa-Ivaldi 1985; de Vlugt 2003).
                  "shoulder": random.uniform(100, 300), "elbow": random.uniform(300, 800),
                  "wrist": random.uniform(1200, 3500)}
        ratio = {"seat": random.uniform(0.25, 0.45), "waist": random.uniform(0.15, 0.35)}
        below = {"seat": sum(trunk), "waist": trunk[-1]}
        damper = {"shoulder": random.uniform(8, 25), "elbow": random.uniform(8, 25), "wrist": random.uniform(10, 30)}
        self.k = {name: spring[name] for name in self.elements}
        self.c = {name: damper.get(name) or 2 * ratio[name] * numpy.sqrt(spring[name] * below[name])
                  for name in self.elements}
        # Flesh of the hand on the stick: 8 to 15 kN/m, 60 to 170 N s/m (de Vlugt 2003).
        self.k_grip, self.c_grip = random.uniform(8e3, 15e3), random.uniform(60, 170)
        # Stretch reflex: 35 to 45 ms, rate and position gain behind the muscle's activation, second order, 2.2 Hz,
        # ratio 0.7 (Schouten 2008).
        self.reflex_n_s_m, self.reflex_n_m = random.uniform(8, 30), random.uniform(20, 100)
        self.delay_steps = int(round(random.uniform(0.035, 0.045) * RATE_HZ))
        self.assemble()
        while self.spectral_radius() > 1.0 - 1.5 / RATE_HZ:  # slower than 0.7 s: not a person who sits still
            self.reflex_n_s_m *= 0.7
            self.reflex_n_m *= 0.7

    def assemble(self):
        n = self.mass.size
        reach = numpy.zeros((len(self.elements), n))  # stretch of each element
        for row in range(len(self.elements)):
            reach[row, row] = 1.0
            if row:
                reach[row, row - 1] = -1.0
        self.reach = reach
        stiff = reach.T @ numpy.diag([self.k[e] for e in self.elements]) @ reach
        damp = reach.T @ numpy.diag([self.c[e] for e in self.elements]) @ reach
        stiff[-1, -1] += self.k_grip
        damp[-1, -1] += self.c_grip
        self.grip_row = numpy.zeros(2 * n + 2)
        self.grip_row[n - 1], self.grip_row[2 * n - 1] = self.k_grip, self.c_grip
        shoulder = self.elements.index("shoulder")
        w = 2 * numpy.pi * 2.2
        size = 2 * n + 2  # q, q', muscle force and its rate
        a = numpy.zeros((size, size))
        a[:n, n:2 * n] = numpy.eye(n)
        a[n:2 * n, :n] = -stiff / self.mass[:, None]
        a[n:2 * n, n:2 * n] = -damp / self.mass[:, None]
        a[n:2 * n, -2] = -reach[shoulder] / self.mass  # the muscle pulls against the stretch
        a[-2, -1] = 1.0
        a[-1, -2:] = -w * w, -1.4 * w
        # Inputs: a_y; a force in each element and in the grip, against its stretch; the delayed spindle.
        b = numpy.zeros((size, 1 + len(self.elements) + 1 + 1))
        b[n:2 * n, 0] = -1.0
        b[n:2 * n, 1:1 + len(self.elements)] = -reach.T / self.mass[:, None]
        b[2 * n - 1, -2] = -1.0 / self.mass[-1]
        b[-1, -1] = w * w
        whole = numpy.zeros((size + 2 * b.shape[1],) * 2)  # first-order hold: x, u, u'
        whole[:size, :size], whole[:size, size:size + b.shape[1]] = a, b
        whole[size:size + b.shape[1], size + b.shape[1]:] = numpy.eye(b.shape[1])
        step = scipy.linalg.expm(whole / RATE_HZ)
        self.keep = step[:size, :size]
        hold, slope = step[:size, size:size + b.shape[1]], step[:size, size + b.shape[1]:] * RATE_HZ
        # x[k+1] = keep x + now a[k] + later a[k+1] + push (forces, spindle)
        self.now, self.later, self.push = hold[:, 0] - slope[:, 0], slope[:, 0], hold[:, 1:]

    def spindle(self):
        """Row of the state that the reflex senses."""
        row = numpy.zeros(self.keep.shape[0])
        n, stretch = self.mass.size, self.reach[self.elements.index("shoulder")]
        row[:n], row[n:2 * n] = self.reflex_n_m * stretch, self.reflex_n_s_m * stretch
        return row

    def spectral_radius(self):
        size, delay = self.keep.shape[0], self.delay_steps
        whole = numpy.zeros((size + delay,) * 2)
        whole[:size, :size], whole[:size, -1] = self.keep, self.push[:, -1]
        whole[size, :size] = self.spindle()
        whole[size + 1:, size:-1] = numpy.eye(delay - 1)
        return numpy.abs(numpy.linalg.eigvals(whole)).max()

    def force(self, felt, inside=(), reflex=None, watched=None):
        """f [columns x samples] for the acceleration that each column feels.

        inside: (element, law) with law(x, v, k) -> force against the stretch, vectors over the columns;
        reflex: law(r, k) -> what the spindle's signal becomes; watched: list that takes q, q' and spindle of column 0.
        """
        columns, count = felt.shape
        x = numpy.zeros((self.keep.shape[0], columns))
        step = numpy.column_stack([self.keep, self.now, self.later, self.push])
        both = numpy.zeros((step.shape[1], columns))
        late = numpy.zeros((self.delay_steps, columns))
        spindle, n = self.spindle(), self.mass.size
        places = [(self.elements.index(e) if e != "grip" else len(self.elements), law) for e, law in inside]
        stretch = [self.reach[at] if at < len(self.elements) else numpy.eye(n)[-1] for at, _ in places]
        out = numpy.empty((count, columns))
        size = x.shape[0]
        across = numpy.ascontiguousarray(felt.T)
        for k in range(count):
            slot = k % self.delay_steps
            old = late[slot].copy()
            late[slot] = spindle @ x
            both[:size] = x
            both[size] = across[k]
            both[size + 1] = across[min(k + 1, count - 1)]
            both[size + 2:-1] = 0.0
            both[-1] = old if reflex is None else reflex(old, k)
            drive = 0.0
            for (at, law), row in zip(places, stretch):
                push = law(row @ x[:n], row @ x[n:2 * n], k)
                both[size + 2 + at] += push
                if at == len(self.elements):
                    drive = drive + push  # the load cell feels what acts in the grip
            out[k] = self.grip_row @ x + drive
            if watched is not None:
                watched.append((*x[:2 * n, 0], late[slot][0]))
            x = step @ both
        return out.T


def involuntary(random, ride):
    """Force of a hand that means to be still, RMS 1: posture below 0.5 Hz, its restlessness, tremor at 8 to 12 Hz.

    Source: McAuley and Marsden (2000) for the tremor; Stiles (1976) for a spectrum that falls above 1 Hz.
    """
    share = random.dirichlet([1.5, 1.5, 0.3])
    slow = shaped_noise(random, ride.t.size, lambda line: 1.0 / (1.0 + (line / random.uniform(0.1, 0.4)) ** 2))
    free = shaped_noise(random, ride.t.size, lambda line: 1.0 / (1.0 + (line / random.uniform(1.0, 3.0)) ** 2))
    tremor = shaped_noise(random, ride.t.size, lambda line: numpy.exp(-0.5 * ((line - random.uniform(8, 12)) / 0.8) ** 2))
    return numpy.sqrt(share) @ numpy.array([slow, free, tremor])
