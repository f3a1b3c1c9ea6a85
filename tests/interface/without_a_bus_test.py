#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Programs that need no bus load no library of Fast DDS. Usage: without_a_bus_test.py PROGRAM...

The programs are the unit tests of the folders that .ci/layering calls BUSLESS: each holds its folder's whole library.
"""
import pathlib
import subprocess
import sys

CTEST_SKIPPED = 77


def loaded(program):
    """Names of the shared libraries that a program loads, those of its libraries included."""
    lines = subprocess.run(["ldd", program], capture_output=True, text=True, check=True).stdout.splitlines()
    return [line.split()[0] for line in lines]


def main():
    missing = [program for program in sys.argv[1:] if not pathlib.Path(program).is_file()]
    if missing or len(sys.argv) < 2:
        print("skipped: not built:", *missing)
        return CTEST_SKIPPED
    found = [(pathlib.Path(program).name, library) for program in sys.argv[1:] for library in loaded(program)
             if library.startswith(("libfastrtps", "libfastdds"))]
    for program, library in found:
        print(f"{program} loads {library}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
