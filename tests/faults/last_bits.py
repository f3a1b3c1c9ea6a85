#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs unit tests as on other processors, and names the cases whose outcome depends on the processor.

Usage: STILLHAND_BUILD=build /usr/bin/python3 tests/faults/last_bits.py [--seeds N] [PROGRAM...]

The mathematical library of a system takes other versions of exp, sin and others on another processor. Their results
differ in the last bit, and a search that takes the better of two nearly equal causes may take the other one. Each seed
changes the last bits of other results (support/last_bits.cpp). Programs are those of the build's tests folder, by
default the ones that search. Prints a line a failed case; status 1 if there was one.
"""
import argparse
import os
import pathlib
import re
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TESTS = pathlib.Path(os.environ.get("STILLHAND_BUILD", SOURCE / "build")).resolve() / "tests"
PROGRAMS = ("unit_diagnosis", "unit_diagnose", "unit_next_run", "unit_close_the_loop")


def failed_cases(program, seed):
    """Names of its cases that fail with these last bits; seed 0: with this processor's own."""
    environment = os.environ | {"LD_PRELOAD": str(TESTS / "liblast_bits.so"), "STILLHAND_LAST_BITS": str(seed)}
    done = subprocess.run([TESTS / program, "--gtest_brief=1"], env=environment, capture_output=True, text=True)
    cases = re.findall(r"^\[  FAILED  \] (\S+) \(\d+ ms\)", done.stdout, re.MULTILINE)
    if done.returncode not in (0, 77) and not cases:
        said = done.stderr.strip()[-200:]
        sys.exit(f"last_bits: {program}, seed {seed}: ended with status {done.returncode}: {said}")
    return cases


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("programs", nargs="*", default=PROGRAMS, metavar="PROGRAM")
    arguments = parser.parse_args()
    found = {}
    for program in arguments.programs:
        for seed in range(arguments.seeds + 1):
            for case in failed_cases(program, seed):
                found.setdefault(f"{program} {case}", []).append(seed)
            print(f"{program}, seed {seed}: {len(found)} cases so far", flush=True)
    for case, seeds in found.items():
        print(f"{case}: fails with the last bits of {', '.join(map(str, seeds))}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
