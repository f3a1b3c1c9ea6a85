# SPDX-License-Identifier: Apache-2.0
"""What must hold for the rig's own samples, whatever happened: force, slew, force to zero, platform.

The samples come as columns: tick, stamp_ns, motor_force_n, motor_tick, motor_permitted, command_tick, position_m,
velocity_m_s, acceleration_m_s2.
"""
# deploy/config/rig.yaml
MAX_FORCE_N = 25.0
MAX_SLEW_N_TICK = 2.0  # 2000 N/s
MAX_AGE_TICKS = 10
WORKSPACE_M = 0.15
MAX_SPEED_M_S = 1.5
MAX_ACCELERATION_M_S2 = 15.0
STOP_DECELERATION_M_S2 = 5.0
# ARCHITECTURE.md, "Safety chain": exactly zero within 40 ticks; the promise of the project is 50 ms.
ZERO_TICKS = 50
# The highest speed at 5 m/s^2 takes 300 ticks; the last bit fades with 1/(2 z w) = 8 ms, and 100 ticks are e^-12 of it.
BRAKE_TICKS = 300 + 100
REST_M_S = 0.001
ROUNDING = 1e-9
COLUMNS = ("tick", "stamp_ns", "motor_force_n", "motor_tick", "motor_permitted", "command_tick", "position_m",
           "velocity_m_s", "acceleration_m_s2")


def parts(rig):
    """Ranges of samples in which the ticks rise: a rig that was started again begins a part of its own."""
    ticks = rig["tick"]
    begin = 0
    for i in range(1, len(ticks) + 1):
        if i == len(ticks) or ticks[i] <= ticks[i - 1]:
            yield range(begin, i)
            begin = i


def motor_usable(rig, i):
    age = rig["tick"][i] - rig["motor_tick"][i]
    return bool(rig["motor_permitted"][i]) and rig["motor_tick"][i] >= 0 and age <= MAX_AGE_TICKS


def worst(values):
    return max((abs(value) for value in values), default=0.0)


def force_findings(rig, part):
    force, tick = rig["motor_force_n"], rig["tick"]
    found = []
    since = None  # tick from which on no command is usable
    for i in part:
        if not abs(force[i]) <= MAX_FORCE_N + ROUNDING:
            found.append(f"force {force[i]:g} N at tick {tick[i]}")
        step = abs(force[i] - force[i - 1]) if i > part.start else 0.0
        if not step <= MAX_SLEW_N_TICK * (tick[i] - tick[i - 1] if i > part.start else 1) + ROUNDING:
            found.append(f"force changes by {step:g} N at tick {tick[i]}")
        if motor_usable(rig, i):
            since = None
        elif since is None:
            since = tick[i]
        if since is not None and tick[i] - since >= ZERO_TICKS and force[i] != 0.0:
            late = tick[i] - since
            found.append(f"force {force[i]:g} N at tick {tick[i]}, {late} ticks after the last usable command")
    return found


def platform_findings(rig, part):
    found = []
    since = None  # tick from which on no command comes
    for i in part:
        tick = rig["tick"][i]
        for name, most in (("position_m", WORKSPACE_M), ("velocity_m_s", MAX_SPEED_M_S),
                           ("acceleration_m_s2", MAX_ACCELERATION_M_S2)):
            if not abs(rig[name][i]) <= most + ROUNDING:
                found.append(f"platform {name} {rig[name][i]:g} at tick {tick}")
        if rig["command_tick"][i] >= 0:
            since = None
        elif since is None:
            since = tick
        if since is not None and tick - since >= BRAKE_TICKS and abs(rig["velocity_m_s"][i]) > REST_M_S:
            found.append(f"platform at {rig['velocity_m_s'][i]:g} m/s {tick - since} ticks after its last command")
    return found


def rig_findings(rig):
    """One line for each rule that is broken, its first case each."""
    found = []
    for part in parts(rig):
        found += force_findings(rig, part)[:3] + platform_findings(rig, part)[:3]
    return found


def zero_ticks(rig):
    """The longest time from the last usable command to exactly zero force, of those that had a force [ticks]."""
    longest = 0
    for part in parts(rig):
        since = None
        for i in part:
            if motor_usable(rig, i) or rig["motor_force_n"][i] == 0.0:
                since = None
            else:
                since = rig["tick"][i] if since is None else since
                longest = max(longest, rig["tick"][i] - since + 1)
    return longest


def noticed_ms(rig, struck_ns):
    """From a fault to the first sample after which no command is used any more; None: commands are used to the end."""
    index = len(rig["tick"])
    while index > 0 and not motor_usable(rig, index - 1):
        index -= 1
    return None if index == len(rig["tick"]) else (rig["stamp_ns"][index] - struck_ns) / 1e6


def figures(rig, struck_ns):
    force = rig["motor_force_n"]
    steps = [force[i] - force[i - 1] for part in parts(rig) for i in part[1:]]
    noticed = noticed_ms(rig, struck_ns)
    return {"samples": len(force), "worst_force_n": worst(force), "worst_step_n": worst(steps),
            "worst_position_m": worst(rig["position_m"]), "zero_ticks": zero_ticks(rig),
            "last_force_n": force[-1] if force else None,
            "last_speed_m_s": abs(rig["velocity_m_s"][-1]) if force else None,
            "noticed_ms": None if noticed is None or noticed < 0 else round(noticed, 1)}
