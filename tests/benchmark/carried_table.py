# SPDX-License-Identifier: Apache-2.0
"""Table and summary of the rows of carried_chain.py."""
import numpy

WORST = 1.05
LEAST_GAIN = 0.02  # of the linear error: below, a share of what could go is a quotient of two accidents
# Effects of the time of a record alone: no rule can know them in another record.
TIME_ALONE = ("fatigue", "friction_in_first_half")


def share(row):
    """(linear - carried) / (linear - least possible) on the unseen record, or None."""
    if any(effect["kind"] in TIME_ALONE for effect in row["truth"] or []):
        return None
    linear, carried, least = (row.get(name) for name in ("unseen_linear", "unseen_carried", "least_possible"))
    if None in (linear, carried, least) or linear - least < LEAST_GAIN * linear:
        return None
    return (linear - carried) / (linear - least)


def ratio(row, after="unseen_carried", before="unseen_linear"):
    return row[after] / row[before] if row.get(after) and row.get(before) else None


def shown(value):
    return "-" if value is None else f"{value:.3g}" if isinstance(value, float) else str(value)


def effect_name(effect):
    carried = effect.get("carried")
    return effect["kind"] + (f":{effect['channel']}" if effect.get("channel") else "") + (
        "" if carried in (None, True) else " (not carried)" if carried is False else f" (x{carried:.2f})")


def exported(row):
    """How many of the effects the motor cancels, and by how much the exported model differs at most from the diagnosed one."""
    treatments = row.get("export") or []
    off = [max(each["difference_percent"].values()) for each in treatments if each.get("difference_percent")]
    if "export" in row.get("errors", {}):
        return "refused"
    return "-" if not treatments else (f"{sum(bool(each['cancelled']) for each in treatments)} of {len(treatments)}" +
                                       (f", {max(off):.2g} %" if off else ""))


def print_table(rows):
    print("| record | truth | named | | verdict: linear -> found, carried | unseen: linear -> carried (least) | carried | "
          "exported | motor: linear -> carried | kept | cpu [s] |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for row in rows:
        named = ", ".join(map(effect_name, row.get("effects") or [])) or row.get("errors", {}).get("diagnose", "nothing")
        truth = "?" if row["truth"] is None else ", ".join(each["kind"] for each in row["truth"]) or "no effect"
        kept = row.get("kept")
        print(f"| {row['record']} | {truth} | {named} | {row['named'] or ''} | {shown(row.get('verdict_linear'))} -> "
              f"{shown(row.get('verdict_after'))}, {shown(row.get('verdict_carried'))} | {shown(row.get('unseen_linear'))} -> "
              f"{shown(row.get('unseen_carried'))} ({shown(row.get('least_possible'))}) | "
              f"{shown(share(row))} | {exported(row)} | "
              f"{shown(row.get('motor_linear'))} -> {shown(row.get('motor_carried'))} | "
              f"{'-' if kept is None else 'yes' if kept is True else 'no' if kept is False else kept} | "
              f"{shown(row.get('diagnose_cpu_s'))} |")
    print()
    print_summary(rows)


def median(values):
    values = [value for value in values if value is not None]
    return f"{numpy.median(values):.2f} (of {len(values)})" if values else "-"


def worst(rows, *names):
    found = [(ratio(row, *names), row["record"]) for row in rows if ratio(row, *names)]
    if not found:
        return "-"
    above = sum(value > WORST for value, _ in found)
    return f"{max(found)[0]:.3f} ({max(found)[1]}), {above} of {len(found)} above {WORST}"


def print_summary(rows):
    counts = {name: sum(row["named"] == name for row in rows) for name in
              ("all", "part", "wrong", "missed", "quiet", "false alarm")}
    print(f"records: {len(rows)}; " + ", ".join(f"{count} {name}" for name, count in counts.items() if count))
    print(f"carried share, median: named all {median(share(row) for row in rows if row['named'] == 'all')}; all or part "
          f"{median(share(row) for row in rows if row['named'] in ('all', 'part'))}; every record {median(map(share, rows))}")
    print(f"harm, unseen error over the linear one's, worst: {worst(rows)}")
    print(f"linear model's unseen error over that of a long response, worst: {worst(rows, 'unseen_linear', 'best_linear')}")
    motor = ("motor_carried", "motor_linear")
    print(f"motor, what is left with the carried model over the linear one's, worst: {worst(rows, *motor)}")
    kept_worse = [row["record"] for row in rows if row.get("kept") is True and (ratio(row, *motor) or 0.0) > 1.0]
    print(f"kept although the motor leaves more: {', '.join(kept_worse) or 'none'}")
    seconds = [row["diagnose_cpu_s"] for row in rows if row.get("diagnose_cpu_s")]
    if seconds:
        print(f"diagnose, user time: {numpy.median(seconds):.1f} s in the median, {max(seconds):.1f} s at most")


def compare(old, new):
    """Summary of two programs on the records that both have."""
    common = {row["record"] for row in old} & {row["record"] for row in new}
    for name, rows in (("old", old), ("new", new)):
        print(f"{name}:")
        print_summary([row for row in rows if row["record"] in common])
