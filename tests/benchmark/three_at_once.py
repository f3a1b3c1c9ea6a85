#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Three effects planted at once: how many `stillhand diagnose` names, on the right channel, strongest first, and what is left.

    STILLHAND_BUILD=build python3 tests/benchmark/three_at_once.py            # twelve recordings, seed 5; ten minutes
    STILLHAND_BUILD=build python3 tests/benchmark/three_at_once.py --together 2 --count 20 --seed 1

Named: the kind is the planted one. If the effect depends on another channel than the input, the channel is the planted one
or one that carries nearly the same (`also_right` of tests/planted).
In order: the named effects come in the order of their size among the others (`marginal_strength`). This size includes the
part that the linear body explains; a second column therefore gives the order of what a body of fourth order leaves of each
effect alone (`left_by_order_4`).
Over noise: held-out error of the final model over the RMS of the noise.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", "build"))


def run(program, *words):
    folder = "tests" if program == "planted_recordings" else "bin"
    done = subprocess.run([str(BUILD / folder / program), *map(str, words)], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"three_at_once: {program}: {done.stderr.strip()}")


def is_named(planted, found):
    right = {*planted["channels"], *planted["also_right"]}
    return planted["kind"] == found["kind"] and (right <= {"a_y"} or found["channel"] in right)


def places(planted, found):
    """Where each planted effect stands among those found; None: it isn't there.  Every finding stands for one."""
    taken, result = set(), []
    for effect in planted:
        at = next((i for i, each in enumerate(found) if i not in taken and is_named(effect, each)), None)
        taken.add(at)
        result.append(at)
    return result


def in_order(sizes, at):
    """Those that were named, by falling size, are where they would be; None: fewer than two were."""
    there = [place for _, place in sorted(zip(sizes, at), key=lambda each: -each[0]) if place is not None]
    return there == sorted(there) if len(there) > 1 else None


def listed(effects, detail):
    return ", ".join(f"{each['kind']} ({detail(each)})" if detail(each) else each["kind"] for each in effects) or "nothing"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--together", type=int, default=3)
    parser.add_argument("--count", type=int, default=12)
    parser.add_argument("--seed", type=int, default=5)
    words = parser.parse_args()
    named = wanted = first = whole = ordered = ordered_left = others = 0
    over_noise = []
    print("| recording | planted, strongest first | found, in order | named | in order of size | of what order 4 leaves "
          "| error over noise |\n| --- | --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as holder:
        run("planted_recordings", "--out", holder, "--together", words.together, "--count", words.count, "--seed", words.seed)
        for recording in sorted(pathlib.Path(holder).glob("*.csv")):
            out = pathlib.Path(holder) / "out.json"
            run("stillhand", "diagnose", recording, "--json", out)
            verdict, truth = json.loads(out.read_text()), json.loads(recording.with_suffix(".truth.json").read_text())
            planted = sorted(truth["effects"], key=lambda effect: -effect["marginal_strength"])
            at = places(planted, verdict["effects"])
            found = sum(place is not None for place in at)
            by_size, by_left = (in_order([effect[size] for effect in planted], at)
                                for size in ("marginal_strength", "left_by_order_4"))
            ratio = verdict["final"]["heldout_rmse"] / truth["noise_rms_n"]
            over_noise.append(ratio)
            named, wanted = named + found, wanted + len(planted)
            first += at[0] == 0
            whole += found == len(planted)
            ordered += found == len(planted) and by_size
            ordered_left += found == len(planted) and by_left
            others += len(verdict["effects"]) - found
            say = {True: "yes", False: "no", None: "-"}
            size = lambda effect: f"{100 * effect['marginal_strength']:.0f} %"
            print(f"| {recording.stem}, {truth['snr_db']:.0f} dB | {listed(planted, size)} "
                  f"| {listed(verdict['effects'], lambda effect: effect['channel'])} | {found} of {len(planted)} "
                  f"| {say[by_size]} | {say[by_left]} | {ratio:.2f} |", flush=True)
    print(f"\n{named} of {wanted} planted effects named with kind and channel, all of a recording in {whole} of {words.count}, "
          f"in order of size too in {ordered}, of what order 4 leaves in {ordered_left}; the strongest first in {first}; "
          f"{others} others named; held-out error over noise: median {statistics.median(over_noise):.3f}, "
          f"largest {max(over_noise):.2f}")


if __name__ == "__main__":
    main()
