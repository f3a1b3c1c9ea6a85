#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The loop over sealed seeds: is the verdict right, is the hand stiller? A line a seed, as a table for the README.

Some ten minutes on two cores:  tests/benchmark/close_the_loop.py build/bin/stillhand [--seeds 1-20] [--out DIR]
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("stillhand", type=pathlib.Path)
    parser.add_argument("--seeds", default="1-20", help="first-last of the undeclared effects")
    parser.add_argument("--seed-offset", type=int, default=1000, help="session's seed: this and the effect's")
    parser.add_argument("--out", type=pathlib.Path, help="keeps every run's folder there")
    parser.add_argument("arguments", nargs="*", help="further ones of the verb, behind --")
    return parser.parse_args()


def run(options, seed, folder):
    out = folder / str(seed)
    subprocess.run([str(options.stillhand), "close-the-loop", "--undeclared-effect", str(seed), "--seed",
                    str(options.seed_offset + seed), "--out", str(out), *options.arguments], check=True,
                   stdout=subprocess.DEVNULL)
    return json.loads((out / "summary.json").read_text())


def rms(summary, condition):
    return summary["conditions"][condition]["rms_error_mm"]["mean"]


def main():
    options = parse()
    first, last = map(int, options.seeds.split("-"))
    with tempfile.TemporaryDirectory(prefix="stillhand-") as temporary:
        folder = options.out or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        summaries = []
        print("| seed | truth | verdict | A, B [mm] | C | C+ | C restores | C+ restores | cancelled C, C+ | "
              "prediction, noise [N] |")
        print("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |")
        for seed in range(first, last + 1):
            s = run(options, seed, folder)
            summaries.append(s)
            p = s["force_prediction"]
            truth, kind = s["truth"], s["verdict"]["kind"]
            share = [100 * s["conditions"][c]["cancelled_share"] for c in ("C", "C+")]
            print(f"| {seed} | {truth['kind']}, {truth['place'] or '-'} | {'' if truth['verdict_right'] else '**'}{kind}"
                  f"{'' if truth['verdict_right'] else '**'} | {rms(s, 'A'):.1f}, {rms(s, 'B'):.1f} | {rms(s, 'C'):.2f} | "
                  f"{rms(s, 'C+'):.2f} | {100 * s['restoration']['rms_error']:.1f} % | "
                  f"{100 * s['restoration_c_plus']['rms_error']:.1f} % | {share[0]:.0f}, {share[1]:.0f} % | "
                  f"{p['before_rmse_n']:.3f} to {p['after_rmse_n']:.4f}, {p['noise_floor_rmse_n']:.4f} |", flush=True)
    right = sum(s["truth"]["verdict_right"] for s in summaries)
    better = sum(rms(s, "C+") < rms(s, "C") for s in summaries)
    worse = sum(rms(s, "C+") > rms(s, "C") for s in summaries)
    restored = statistics.median(100 * s["restoration_c_plus"]["rms_error"] for s in summaries)
    noise = max(s["force_prediction"]["after_over_noise"] for s in summaries)
    print(f"\nverdict right in {right} of {len(summaries)}; C+ better than C in {better}, worse in {worse}; median restoration "
          f"of the RMS error at C+ {restored:.1f} %; prediction error after at most {noise:.2f} times the noise floor")
    return 0


if __name__ == "__main__":
    sys.exit(main())
