#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The loop over sealed seeds, a row each: is the verdict right, what does following do, and what the effect's model?

Half a minute of processor time a seed:  tests/benchmark/close_the_loop.py build/bin/stillhand [--out DIR]
A seed whose summary is in DIR already is not run again. Seeds without an effect are among them; a verdict that names
one there is a false alarm. Further rows have effects that no kind of the diagnosis describes, with their RMS force, what
of it no linear model explains, and the RMS force from which on a verdict can name an effect.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

CANCELLING = ("C", "C'", "C+")
RESTORATION = {"C": "restoration", "C'": "restoration_c_prime", "C+": "restoration_c_plus"}
HEAD = ("seed", "truth", "verdict", "right", "A, B [mm]", "C restores [%]", "C' restores [%]", "C+ restores [%]",
        "force left C, C', C+ [N]", "C' to C+ [N]", "hand C, C', C+ [m/s²]", "prediction, noise [N]")


def seeds(text):
    first, _, last = text.partition("-")
    return range(int(first), int(last or first) + 1)


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("stillhand", type=pathlib.Path)
    parser.add_argument("--seeds", type=seeds, default=seeds("201-240"), help="first-last of the undeclared effects")
    parser.add_argument("--off-catalogue", type=seeds, default=seeds("1-24"), help="the same, outside of the kinds")
    parser.add_argument("--seed-offset", type=int, default=1000, help="session's seed: this and the effect's")
    parser.add_argument("--out", type=pathlib.Path, help="keeps every run's folder there")
    parser.add_argument("arguments", nargs="*", help="further ones of the verb, behind --")
    return parser.parse_args()


def run(options, seed, folder, outside):
    out = folder / (f"outside-{seed}" if outside else str(seed))
    if not (out / "summary.json").exists():
        subprocess.run([str(options.stillhand), "close-the-loop", "--undeclared-effect", str(seed), "--seed",
                        str(options.seed_offset + seed), "--out", str(out), *(["--off-catalogue"] if outside else []),
                        *options.arguments], check=True, stdout=subprocess.DEVNULL)
    return json.loads((out / "summary.json").read_text())


def mean(summary, condition, measure):
    return summary["conditions"][condition][measure]["mean"]


def restored(summary, condition):
    return 100 * summary[RESTORATION[condition]]["rms_error"]


def with_interval(value, interval, decimals, factor=1.0):
    def shown(number):
        return f"{factor * number:.{decimals}f}"
    return shown(value) if interval is None else f"{shown(value)} [{shown(interval[0])}, {shown(interval[1])}]"


def named(*words):
    return ", ".join(word for word in words if word) or "-"


def effect_step(summary):
    """C' to C+ of the force that is left: (mean, interval or None)."""
    change = summary["paired"]["C'-C+"]["force_left_n"]
    return change["mean_difference"], change["interval95"]


def row(seed, summary):
    truth, verdict = summary["truth"], summary["verdict"]
    found = verdict["conclusion"]
    if verdict["findings"]:
        found = named(verdict["kind"], verdict["channel"], verdict["where"])
    prediction = summary["force_prediction"]

    def of_each(measure, decimals):
        return ", ".join(f"{mean(summary, c, measure):.{decimals}f}" for c in CANCELLING)
    size = (f"{truth['force_rms_n']:.2f} N, {truth['force_beyond_linear_n']:.2f} not linear, of {truth['detectable_n']:.2f}"
            if "force_rms_n" in truth else "")
    cells = [seed, named(truth["kind"], truth["channel"], truth["place"], size), found,
             "yes" if truth["verdict_right"] else "**no**",
             f"{mean(summary, 'A', 'rms_error_mm'):.1f}, {mean(summary, 'B', 'rms_error_mm'):.1f}"]
    for condition in CANCELLING:
        interval = summary["restoration_interval95"][condition]["rms_error"]
        cells.append(with_interval(restored(summary, condition) / 100, interval, 1, 100.0))
    cells += [of_each("force_left_n", 2), with_interval(*effect_step(summary), 2), of_each("hand_acceleration_m_s2", 2),
              f"{prediction['before_rmse_n']:.3f} to {prediction['after_rmse_n']:.4f}, "
              f"{prediction['noise_floor_rmse_n']:.4f}"]
    return "| " + " | ".join(map(str, cells)) + " |"


def table(options, numbers, folder, outside):
    print("| " + " | ".join(HEAD) + " |\n" + "| --- " * len(HEAD) + "|")
    summaries = []
    for seed in numbers:
        summaries.append(run(options, seed, folder, outside))
        print(row(seed, summaries[-1]), flush=True)
    return summaries


def conclude(title, summaries):
    if not summaries:
        return
    right = sum(s["truth"]["verdict_right"] for s in summaries)
    kind = sum(s["truth"]["kind"] == s["verdict"]["kind"] for s in summaries)
    print(f"\n{title}: {len(summaries)} seeds; kind, channel and place right in {right}, the kind alone in {kind}")
    for name, of in (("restored RMS error [%]", restored),
                     ("force left [N]", lambda s, c: mean(s, c, "force_left_n")),
                     ("hand's acceleration [m/s²]", lambda s, c: mean(s, c, "hand_acceleration_m_s2"))):
        medians = [statistics.median(of(s, c) for s in summaries) for c in CANCELLING]
        print(f"  median {name}: " + ", ".join(f"{c} {value:.2f}" for c, value in zip(CANCELLING, medians)))
    steps = [effect_step(s)[1] for s in summaries]
    less = sum(i is not None and i[1] < 0 for i in steps)
    more = sum(i is not None and i[0] > 0 for i in steps)
    print(f"  from C' to C+ the force that is left falls in {less} and rises in {more} (interval without 0), "
          f"median change {statistics.median(effect_step(s)[0] for s in summaries):.2f} N")
    print(f"  prediction error after at most "
          f"{max(s['force_prediction']['after_over_noise'] for s in summaries):.2f} times the noise floor")


def by_truth(summaries):
    """A row for each truth: how often it is named, and the medians of C, C' and C+."""
    print("\n| truth | seeds | right | restored C, C', C+ [%] | force left C, C', C+ [N] | hand C, C', C+ [m/s²] |\n"
          + "| --- " * 6 + "|")
    groups = {}
    for s in summaries:
        groups.setdefault(named(s["truth"]["kind"], s["truth"]["place"]), []).append(s)
    for truth, group in sorted(groups.items()):
        def medians(of, decimals):
            return ", ".join(f"{statistics.median(of(s, c) for s in group):.{decimals}f}" for c in CANCELLING)
        right = sum(s["truth"]["verdict_right"] for s in group)
        print(f"| {truth} | {len(group)} | {right} | {medians(restored, 1)} | "
              f"{medians(lambda s, c: mean(s, c, 'force_left_n'), 2)} | "
              f"{medians(lambda s, c: mean(s, c, 'hand_acceleration_m_s2'), 2)} |")


def main():
    options = parse()
    with tempfile.TemporaryDirectory(prefix="stillhand-") as temporary:
        folder = options.out or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        summaries = table(options, options.seeds, folder, False)
        outside = table(options, options.off_catalogue, folder, True)
    by_truth(summaries + outside)
    none = [s for s in summaries if s["truth"]["kind"] == "none"]
    conclude("effects of the kinds", [s for s in summaries if s["truth"]["kind"] != "none"])
    conclude("no effect", none)
    print(f"\nfalse alarms: {sum(bool(s['verdict']['findings']) for s in none)} of {len(none)} seeds without an effect")
    conclude("effects outside of the kinds", outside)
    predictions = [s["force_prediction"] for s in outside]
    linear = sum(p["before_rmse_n"] < 1.05 * p["noise_floor_rmse_n"] for p in predictions)
    print(f"  the linear model alone predicts to 1.05 times the noise in {linear}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
