# SPDX-License-Identifier: Apache-2.0
"""Effects for fresh_bodies.py: half of well-known kinds, half with shapes that no list of kinds holds.

An effect acts at one place: `felt` changes the acceleration that the body feels, `law` is a force inside an element of
the body, `reflex` changes the spindle's signal, `added` is a force on the load cell, `mapped` changes the force,
`sensed` changes the recorded a_y. Its strength s is without unit; 0 is exactly no effect.
`right` lists (kind, channel) of verdicts that count as rightly named, None for any channel. A shape outside of the list
of kinds has no name there: what counts is the nearest form at the right channel.
"""
import dataclasses
import typing

import numpy
import scipy.signal

from fresh_rides import G_M_S2, LEAD_S, RATE_HZ, Body, Ride

STRENGTHS = numpy.geomspace(0.03, 6.0, 7)
SHAPE = (("nonlinear_stiffness", None), ("asymmetry", None), ("dead_zone", None), ("output_saturation", None))
MEMORY = (("hysteresis", None), ("coulomb_friction", None), ("dead_zone", None))


@dataclasses.dataclass
class Effect:
    kind: str
    known: bool
    channel: typing.Optional[str]
    right: tuple
    parameters: dict
    element: typing.Optional[str] = None
    felt: typing.Optional[typing.Callable] = None
    law: typing.Optional[typing.Callable] = None  # law(columns' strengths) -> force(x, v, k)
    reflex: typing.Optional[typing.Callable] = None
    added: typing.Optional[typing.Callable] = None
    mapped: typing.Optional[typing.Callable] = None
    sensed: typing.Optional[typing.Callable] = None
    strengths: numpy.ndarray = dataclasses.field(default_factory=lambda: STRENGTHS)
    calibrated: bool = True  # False: the strength is drawn, since a linear model can take the effect in


class Scales:
    """RMS of what the body does without an effect: the natural units of a strength."""

    def __init__(self, body: Body, ride: Ride):
        watched = []
        force = body.force(ride.a_y[None, :], watched=watched)[0]
        seen = numpy.array(watched)[int(LEAD_S * RATE_HZ):]
        n = body.mass.size
        x, v = seen[:, :n] @ body.reach.T, seen[:, n:2 * n] @ body.reach.T
        self.f = force[int(LEAD_S * RATE_HZ):].std()
        self.x = {name: x[:, i].std() for i, name in enumerate(body.elements)}
        self.v = {name: v[:, i].std() for i, name in enumerate(body.elements)}
        self.x["grip"], self.v["grip"] = seen[:, n - 1].std(), seen[:, 2 * n - 1].std()
        self.k = dict(body.k, grip=body.k_grip)
        self.c = dict(body.c, grip=body.c_grip)
        self.spindle = seen[:, -1].std()


def sign(rate, soft):
    return numpy.tanh(rate / soft)


def lag(signal, time_s):
    """First order, from the steady state of its first sample."""
    keep = numpy.exp(-1.0 / (time_s * RATE_HZ))
    return scipy.signal.lfilter([1.0 - keep], [1.0, -keep], signal, zi=[keep * signal[0]])[0]


def mode(signal, hz, ratio):
    """Second order, gain 1 at 0 Hz, bilinear transform (exact to 1e-5 below 10 Hz at 2 kHz)."""
    w = 2 * numpy.pi * hz
    return scipy.signal.lfilter(*scipy.signal.bilinear([w * w], [1.0, 2 * ratio * w, w * w], RATE_HZ), signal)


def play(signal, half_gap):
    """Backlash operator of Krasnosel'skii and Pokrovskii (1989)."""
    out = numpy.empty_like(signal)
    at = signal[0]
    for k, value in enumerate(signal.tolist()):
        at = min(max(at, value - half_gap), value + half_gap)
        out[k] = at
    return out


# Well-known kinds.


def friction_rate(random, scales):
    """Coulomb friction of the stick, F = F_c sign(omega) (0.02 rad/s wide)."""
    return Effect("friction_rate", True, "omega", (("coulomb_friction", "omega"),), {"f_c_n": scales.f},
                  added=lambda ride, s: s * scales.f * sign(ride.omega, 0.02))


def path_ax(random, scales):
    hz, ratio, to = random.uniform(1.5, 4.0), random.uniform(0.2, 0.5), random.choice([-1, 1])
    return Effect("path_ax", True, "a_x", (("coupled_input", "a_x"),),
                  {"gain_n_s2_m": to * scales.f, "mode_hz": hz, "ratio": ratio},
                  added=lambda ride, s: s * to * scales.f * mode(ride.a_x, hz, ratio))


def path_roll(random, scales):
    """The body feels the part of gravity along the tilted platform; the accelerometer is free of it."""
    return Effect("path_roll", True, "roll", (("coupled_input", "roll"),), {"share_of_g": 1.0},
                  felt=lambda a, ride, s: a - s * G_M_S2 * numpy.sin(ride.roll))


def bouc_wen(random, scales):
    """z' = v - (beta |v| z + gamma v |z|)/x_y with beta = gamma = 1/2 (Bouc 1967, Wen 1976); F = k_z z in one element."""
    element = random.choice(["seat", "shoulder", "wrist"])
    yields = random.uniform(0.2, 0.8) * scales.x[element]

    def law(s):
        z = numpy.zeros_like(s)

        def force(x, v, k):
            nonlocal z
            z = numpy.clip(z + (v - 0.5 * (numpy.abs(v) * z + v * numpy.abs(z)) / yields) / RATE_HZ, -yields, yields)
            return s * scales.k[element] * z
        return force
    return Effect("bouc_wen", True, None, MEMORY, {"k_z_n_m": scales.k[element], "x_y_m": yields}, element=element, law=law)


def lost_motion(random, scales):
    """Play between the hand and the load cell."""
    return Effect("lost_motion", True, None, (("hysteresis", None), ("dead_zone", None)), {"half_gap_n": 0.3 * scales.f},
                  mapped=lambda f, ride, s: play(f, 0.3 * s * scales.f))


def output_saturation(random, scales):
    return Effect("output_saturation", True, None, (("output_saturation", None),), {"limit_n_at_strength_1": 2 * scales.f},
                  mapped=lambda f, ride, s: numpy.clip(f, -2 * scales.f / s, 2 * scales.f / s) if s else f)


def input_saturation(random, scales):
    """a_y is what was commanded; the platform follows it to a limit."""
    return Effect("input_saturation", True, None, (("input_saturation", None),), {"limit_of_rms_at_strength_1": 2.0},
                  felt=lambda a, ride, s: numpy.clip(a, -2 * a.std() / s, 2 * a.std() / s) if s else a)


def gap_in_grip(random, scales):
    """The flesh carries nothing within a gap."""
    def law(s):
        gap = s * scales.x["grip"]
        return lambda x, v, k: -scales.k["grip"] * numpy.clip(x, -gap, gap)
    return Effect("gap_in_grip", True, None, (("dead_zone", None), ("nonlinear_stiffness", None)),
                  {"half_gap_m": scales.x["grip"]}, element="grip", law=law)


def hardening(random, scales):
    element = random.choice(["seat", "shoulder", "wrist"])

    def law(s):
        cubic = s * scales.k[element] / scales.x[element] ** 2
        return lambda x, v, k: cubic * x ** 3
    return Effect("hardening", True, None, (("nonlinear_stiffness", None),),
                  {"k_3_n_m3": scales.k[element] / scales.x[element] ** 2}, element=element, law=law,
                  strengths=numpy.geomspace(0.01, 1.5, 7))


def thermal_lag(random, scales):
    time_s, to = random.uniform(5, 25), random.choice([-1, 1])
    return Effect("thermal_lag", True, "temp", (("coupled_input", "temp"),), {"gain_n_k": to * scales.f, "time_s": time_s},
                  added=lambda ride, s: s * to * scales.f * (lag(ride.temp, time_s) - 22.0))


def late_cell(random, scales):
    """The load cell is late. A long linear model takes it in: nothing is to gain over the oracle's linear model."""
    late_s = random.uniform(0.03, 0.12)

    def mapped(f, ride, s):
        steps = int(round(s * late_s * RATE_HZ))
        return numpy.concatenate([numpy.full(steps, f[0]), f[:f.size - steps]]) if steps else f
    return Effect("late_cell", True, None, (("delay", None),), {"delay_s": late_s}, mapped=mapped, calibrated=False)


def gain_of_grip(random, scales):
    """Stiffer with the grip: admittance falls by some 1 % for 1 N (Abbink 2011)."""
    return Effect("gain_of_grip", True, "grip", (("bilinear", "grip"),), {"gain_per_20_n": 1.0},
                  mapped=lambda f, ride, s: f * (1.0 + s * (ride.grip - 20.0) / 20.0))


def ripple(random, scales):
    pitch, phase = random.uniform(0.04, 0.16), random.uniform(0, 2 * numpy.pi)
    return Effect("ripple", True, "theta", (("position_ripple", "theta"),),
                  {"amplitude_n": scales.f, "pitch_rad": pitch, "phase_rad": phase},
                  added=lambda ride, s: s * scales.f * numpy.sin(2 * numpy.pi * ride.theta / pitch + phase))


def product(random, scales):
    one, other = [("a_x", "roll"), ("a_x", "a_z"), ("a_y", "roll"), ("a_y", "a_z"), ("a_z", "theta")][random.integers(5)]

    def added(ride, s):
        both = getattr(ride, one) * getattr(ride, other)
        return s * scales.f * both / units
    units = {"a_x": 0.9, "a_y": 1.3, "a_z": 0.7, "roll": 0.08, "theta": 0.12}
    units = units[one] * units[other]
    return Effect("product", True, f"{one}*{other}", (("bilinear", one), ("bilinear", other)),
                  {"gain_n": scales.f / units}, added=added)


# Shapes outside of such a list.


def pinched(random, scales):
    """Bouc-Wen whose force vanishes around zero stretch (slip-lock; Baber and Noori 1985)."""
    element = random.choice(["shoulder", "wrist", "seat"])
    yields, width = random.uniform(0.3, 0.8) * scales.x[element], random.uniform(0.3, 0.7) * scales.x[element]

    def law(s):
        z = numpy.zeros_like(s)

        def force(x, v, k):
            nonlocal z
            z = numpy.clip(z + (v - 0.5 * (numpy.abs(v) * z + v * numpy.abs(z)) / yields) / RATE_HZ, -yields, yields)
            return s * 2 * scales.k[element] * z * (1.0 - 0.95 * numpy.exp(-((x / width) ** 2)))
        return force
    return Effect("pinched", False, None, MEMORY + SHAPE, {"k_z_n_m": 2 * scales.k[element], "x_y_m": yields,
                  "pinch_m": width}, element=element, law=law)


def stribeck(random, scales):
    """F = (F_c + (F_s - F_c) exp(-(omega/omega_s)^2)) sign(omega) (Armstrong-Helouvry 1991)."""
    more, slow = random.uniform(0.6, 2.0), random.uniform(0.15, 0.5)

    def added(ride, s):
        return s * scales.f * (1 + more * numpy.exp(-(ride.omega / slow) ** 2)) * sign(ride.omega, 0.03)
    return Effect("stribeck", False, "omega", (("coulomb_friction", "omega"),),
                  {"f_c_n": scales.f, "f_s_n": (1 + more) * scales.f, "omega_s_rad_s": slow}, added=added)


def asymmetric_friction(random, scales):
    back = random.uniform(0.1, 0.5)
    return Effect("asymmetric_friction", False, "omega", (("coulomb_friction", "omega"), ("asymmetry", "omega")),
                  {"forward_n": scales.f, "back_n": back * scales.f},
                  added=lambda ride, s: s * scales.f * numpy.where(ride.omega > 0, 1.0, back) * sign(ride.omega, 0.02))


def friction_in_first_half(random, scales):
    return Effect("friction_in_first_half", False, "omega", (("coulomb_friction", "omega"),), {"f_c_n": scales.f},
                  added=lambda ride, s: s * scales.f * sign(ride.omega, 0.02) * (ride.t < ride.length_s / 2))


def one_sided_stop(random, scales):
    """The trunk meets the side of the seat."""
    gap = random.uniform(0.0, 1.0) * scales.x["seat"]

    def law(s):
        return lambda x, v, k: s * scales.k["seat"] * numpy.maximum(x - gap, 0.0)
    return Effect("one_sided_stop", False, None, SHAPE, {"k_n_m": scales.k["seat"], "gap_m": gap}, element="seat", law=law)


def rate_dependent_stiffness(random, scales):
    """k (1 + s |v|/(|v| + v_0)): muscle is stiffer while it is stretched (Rack and Westbury 1974)."""
    element = random.choice(["shoulder", "wrist"])
    v0 = random.uniform(0.5, 1.5) * scales.v[element]

    def law(s):
        return lambda x, v, k: s * scales.k[element] * x * numpy.abs(v) / (numpy.abs(v) + v0)
    return Effect("rate_dependent_stiffness", False, None, SHAPE + MEMORY + (("bilinear", None),),
                  {"k_n_m": scales.k[element], "v_0_m_s": v0}, element=element, law=law)


def reflex_by_amplitude(random, scales):
    """Reflex gain 6 s / (1 + A/A_0), A the size of the last second's stretch (Cathers 1999; van der Helm 2002)."""
    small = 0.4 * scales.spindle

    def reflex(s):
        size = numpy.zeros_like(s)

        def law(r, k):
            nonlocal size
            size = size + (numpy.abs(r) - size) / RATE_HZ
            return numpy.where(s > 0, r * (1.0 + s * (small / (small + size) - 0.5) * 4.0), r)
        return law
    return Effect("reflex_by_amplitude", False, None, SHAPE + (("time_varying_gain", None), ("bilinear", None)),
                  {"a_0_n": small}, reflex=reflex, strengths=numpy.geomspace(0.05, 1.5, 7))


def quadratic_damping(random, scales):
    element = random.choice(["seat", "shoulder"])

    def law(s):
        size = s * scales.c[element] / scales.v[element]
        return lambda x, v, k: size * v * numpy.abs(v)
    return Effect("quadratic_damping", False, None, SHAPE + MEMORY, {"c_2_n_s2_m2": scales.c[element] / scales.v[element]},
                  element=element, law=law)


def arm_friction(random, scales):
    """Coulomb friction inside the arm, in the rate of its joint."""
    element = random.choice(["shoulder", "wrist"])
    size = 0.5 * (scales.k[element] * scales.x[element] + scales.c[element] * scales.v[element])

    def law(s):
        return lambda x, v, k: s * size * numpy.tanh(v / (0.05 * scales.v[element]))
    return Effect("arm_friction", False, None, MEMORY, {"f_c_n": size}, element=element, law=law,
                  strengths=numpy.geomspace(0.03, 2.0, 7))


def tilting_sensor(random, scales):
    """The accelerometer tilts with roll, more than in proportion: a cos(alpha) + g sin(alpha)."""
    bend = random.uniform(0.1, 0.5)

    def sensed(ride, s):
        alpha = s * (ride.roll + bend * ride.roll ** 3 / 0.08 ** 2)
        return ride.a_y * numpy.cos(alpha) + G_M_S2 * numpy.sin(alpha)
    return Effect("tilting_sensor", False, "roll", (("coupled_input", "roll"), ("bilinear", "roll"),
                  ("nonlinear_stiffness", "roll")), {"tilt_rad_rad": 1.0, "cubic_rad_rad3": bend / 0.08 ** 2}, sensed=sensed)


def fatigue(random, scales):
    """The hand lets go: its coupling falls to 1 - s with a time of 20 to 60 s from the beginning of the record."""
    time_s = random.uniform(20, 60)
    return Effect("fatigue", False, None, (("time_varying_gain", None), ("regime_change", None)), {"time_s": time_s},
                  mapped=lambda f, ride, s: f * (1.0 - s * (1.0 - numpy.exp(-numpy.maximum(ride.t, 0.0) / time_s))),
                  strengths=numpy.linspace(0.1, 0.9, 7))


def cable_hysteresis(random, scales):
    """Three plays of the stick angle in parallel (Prandtl-Ishlinskii): a cable that drags."""
    gaps = random.uniform(0.01, 0.15, 3)

    def added(ride, s):
        if not hasattr(ride, "dragged"):
            ride.dragged = ride.theta - sum(play(ride.theta, gap) for gap in gaps) / 3
        return s * scales.f * ride.dragged / ride.dragged.std()
    return Effect("cable_hysteresis", False, "theta", (("hysteresis", "theta"), ("coulomb_friction", "omega"),
                  ("coulomb_friction", "theta")), {"f_rms_n": scales.f, "half_gap_rad": gaps.tolist()}, added=added)


def breakout(random, scales):
    """A centring spring with a step at the centre (a stick's breakout force)."""
    return Effect("breakout", False, "theta", (("nonlinear_stiffness", "theta"), ("dead_zone", "theta"),
                  ("coulomb_friction", "theta"), ("coupled_input", "theta"), ("output_saturation", "theta")),
                  {"step_n": scales.f}, added=lambda ride, s: s * scales.f * sign(ride.theta, 0.01))


def root_path(random, scales):
    """A path that bends: sign(a_x) sqrt|a_x| behind a mode."""
    hz = random.uniform(2.0, 5.0)
    return Effect("root_path", False, "a_x", (("coupled_input", "a_x"), ("nonlinear_stiffness", "a_x")),
                  {"gain_n": scales.f, "mode_hz": hz},
                  added=lambda ride, s: s * scales.f * mode(numpy.sign(ride.a_x) * numpy.sqrt(numpy.abs(ride.a_x)), hz, 0.4))


def grip_threshold(random, scales):
    """Above a certain grip the hand is another body."""
    edge = random.uniform(17, 23)
    return Effect("grip_threshold", False, "grip", (("bilinear", "grip"), ("regime_change", "grip")), {"edge_n": edge},
                  mapped=lambda f, ride, s: f * (1.0 + s * (0.5 * numpy.tanh((ride.grip - edge) / 1.0))))


KNOWN = (friction_rate, path_ax, path_roll, bouc_wen, lost_motion, output_saturation, input_saturation, gap_in_grip,
         hardening, thermal_lag, late_cell, gain_of_grip, ripple, product)
OUTSIDE = (pinched, stribeck, asymmetric_friction, friction_in_first_half, one_sided_stop, rate_dependent_stiffness,
           reflex_by_amplitude, quadratic_damping, arm_friction, tilting_sensor, fatigue, cable_hysteresis, breakout,
           root_path, grip_threshold)
