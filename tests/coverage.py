#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Lines of the cores that the unit tests reach, counted by gcov.

Usage: /usr/bin/python3 tests/coverage.py [--lines] [FOLDER...]

Builds the programs of tests/unit/FOLDER (all without a FOLDER; preset coverage), runs them, and prints a row for each
folder of pure code: those named core, contract, signal, statistics. With --lines the lines that no test reaches follow.
Exit status 1 if a test fails. Needs gcovr.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[1]
TREE = SOURCE / "build-coverage"
# As PURE of .ci/layering.
PURE = re.compile(r"^(services/(contract|signal|statistics|\w+/core)|apps/\w+/core)/")


def folders(asked):
    """The folders of tests/unit that have a program."""
    known = sorted(path.name for path in (SOURCE / "tests/unit").iterdir() if any(path.glob("*_test.cpp")))
    for name in asked:
        if name not in known:
            print(f"{name}: no such folder of tests/unit; there are {', '.join(known)}", file=sys.stderr)
            sys.exit(2)
    return asked or known


def build_and_run(names):
    """Builds the programs, forgets the counts of runs before, runs the tests. True if all passed."""
    subprocess.run(["cmake", "--preset", "coverage"], cwd=SOURCE, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", TREE, "--target", *(f"unit_{name}" for name in names)], check=True,
                   stdout=subprocess.DEVNULL)
    for counts in TREE.rglob("*.gcda"):
        counts.unlink()
    tests = rf"^unit\.({'|'.join(names)})(\.|$)"
    return subprocess.run(["ctest", "--test-dir", TREE, "-L", "unit", "-R", tests, "--output-on-failure"],
                          check=False, stdout=sys.stderr).returncode == 0


def counted_lines():
    """{file: {line: count}} of the pure code."""
    command = ["gcovr", "--root", SOURCE, "--object-directory", TREE, "--filter", f"{SOURCE}/(services|apps)/",
               "--json", "-", TREE]
    report = json.loads(subprocess.run(command, cwd=SOURCE, check=True, stdout=subprocess.PIPE).stdout)
    # gcovr also lists lines without code.
    return {file["file"]: {line["line_number"]: line["count"] for line in file["lines"] if not line["gcovr/noncode"]}
            for file in report["files"] if PURE.match(file["file"])}


def ranges(numbers):
    """[3, 4, 5, 9] as "3-5, 9"."""
    parts = []
    for number in numbers:
        if parts and number == parts[-1][1] + 1:
            parts[-1][1] = number
        else:
            parts.append([number, number])
    return ", ".join(str(first) if first == last else f"{first}-{last}" for first, last in parts)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lines", action="store_true", help="also the lines that no test reaches")
    parser.add_argument("folder", nargs="*", help="of tests/unit")
    options = parser.parse_args()
    passed = build_and_run(folders(options.folder))
    files = counted_lines()
    by_folder = {}
    for name, lines in files.items():
        by_folder.setdefault(PURE.match(name).group(1), []).extend(lines.values())
    print("| folder | lines | reached | % |\n| --- | --- | --- | --- |")
    for folder, counts in sorted(by_folder.items()):
        reached = sum(count > 0 for count in counts)
        print(f"| {folder} | {len(counts)} | {reached} | {100.0 * reached / len(counts):.1f} |")
    for name, lines in sorted(files.items()) if options.lines else ():
        missed = sorted(number for number, count in lines.items() if count == 0)
        if missed:
            print(f"{name}: {ranges(missed)}")
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main())
