#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Changes one place of the sources at random, and sees whether a unit test notices.

Usage: STILLHAND_BUILD=build /usr/bin/python3 tests/faults/mutations.py --out FILE.csv [--runs 200] [--seed 1]

Each change is one token of one line of the cores or of a library of the verbs: a comparison, a sign, a number, an "and",
a truth, or a whole assignment. The unit tests of the file's own folder are built and run; if they pass, those of all
other folders that link it. Prints a line a change, ends with the share that was noticed and its 95 % interval (Wilson),
and puts every place back. A change that does not compile is drawn again. Some changes mean the same program: read those
that nobody noticed. The build tree is that of the sources; no other program may build in it meanwhile.
"""
import argparse
import csv
import math
import os
import pathlib
import random
import re
import subprocess
import sys
import typing

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", SOURCE / "build")).resolve()
FOLDERS = ("services/core/", "apps/libraries/")
LIMIT_S = 900  # of one test program: a change may make a loop endless
# Binary operators have a blank on both sides, which the format check sees to; brackets of templates have none.
KINDS = {
    "comparison": (r" (<|<=|>|>=|==|!=) ",
                   {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="}),
    "sign": (r" ([+\-*/]) ", {"+": "-", "-": "+", "*": "/", "/": "*"}),
    "logic": (r" (&&|\|\|) ", {"&&": "||", "||": "&&"}),
    "truth": (r"\b(true|false)\b", {"true": "false", "false": "true"}),
    "number": (r"(?<![\w.\"'])(\d+(?:\.\d+)?)(?![\w.'])", None),
    "assignment": (r"^( +[\w.\[\]]+ [+\-*/]?= .*;)$", None),
}


class Change(typing.NamedTuple):
    file: str
    line: int  # from 1
    kind: str
    before: str
    after: str


def changed(kind, match):
    """The line with the token changed."""
    line, token = match.string, match[1]
    table = KINDS[kind][1]
    if table:
        new = table[token]
    elif kind == "assignment":
        new = ";"
    else:
        new = "1" if float(token) == 0.0 else "0" if float(token) == 1.0 else f"{2.0 * float(token):g}"
        new += ".0" if "." in token and "." not in new and "e" not in new else ""
    return line[:match.start(1)] + new + line[match.end(1):]


def places():
    """Every change that can be drawn."""
    listed = subprocess.run(["git", "ls-files", *FOLDERS], cwd=SOURCE, capture_output=True, text=True, check=True)
    for file in listed.stdout.splitlines():
        if not file.endswith((".cpp", ".hpp")):
            continue
        for number, line in enumerate((SOURCE / file).read_text(encoding="utf-8").splitlines(), 1):
            code = line.split("//")[0].rstrip()
            if not code or '"' in code or code.lstrip().startswith(("#", "*", "static_assert", "template", "using")):
                continue
            for kind, (pattern, _) in KINDS.items():
                for match in re.finditer(pattern, code):
                    yield Change(file, number, kind, code.strip(), changed(kind, match).strip())


def programs():
    return sorted(path.name for path in (BUILD / "tests").glob("unit_*") if os.access(path, os.X_OK) and path.is_file())


def build(targets):
    return subprocess.run(["cmake", "--build", str(BUILD), "-j", "2", "--target", *targets], capture_output=True,
                          check=False).returncode == 0


def passes(program):
    """The exit status 77 is a skip."""
    try:
        return subprocess.run([str(BUILD / "tests" / program), "--gtest_brief=1"], cwd=BUILD, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, check=False, timeout=LIMIT_S).returncode in (0, 77)
    except subprocess.TimeoutExpired:
        return False


def linked(programs_before):
    """Programs that the last build made again."""
    return [name for name, at in programs_before.items() if (BUILD / "tests" / name).stat().st_mtime != at]


def noticed_by(change):
    """The first program that fails with the change, "" for none; None where it does not compile."""
    file = SOURCE / change.file
    text = file.read_text(encoding="utf-8")
    lines = text.splitlines(keepends=True)
    at = change.line - 1
    indent = lines[at][:len(lines[at]) - len(lines[at].lstrip())]
    lines[at] = indent + change.after + "\n"
    names = programs()
    own = f"unit_{change.file.split('/')[2]}"
    try:
        file.write_text("".join(lines), encoding="utf-8")
        for targets in ([own] if own in names else [], [name for name in names if name != own]):
            before = {name: (BUILD / "tests" / name).stat().st_mtime for name in targets}
            if targets and not build(targets):
                return None
            for name in linked(before):
                if not passes(name):
                    return name
        return ""
    finally:
        file.write_text(text, encoding="utf-8")


def interval(part, whole):
    """Wilson's 95 % interval of a share."""
    z = 1.96
    share, spread = part / whole, z / whole * math.sqrt(part * (whole - part) / whole + z * z / 4.0)
    return [(share + z * z / (2.0 * whole) + sign * spread) / (1.0 + z * z / whole) for sign in (-1.0, 1.0)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", required=True, type=pathlib.Path)
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    if not build(["all"]):
        raise SystemExit("mutations: the sources do not build")
    drawn = list(places())
    random.Random(options.seed).shuffle(drawn)
    results = []
    with open(options.out, "w", newline="", encoding="utf-8") as stream:
        rows = csv.writer(stream)
        rows.writerow((*Change._fields, "noticed_by"))
        for change in drawn:
            if len(results) == options.runs:
                break
            by = noticed_by(change)
            if by is None:
                continue
            results.append(by)
            rows.writerow((*change, by))
            stream.flush()
            print(f"{len(results):3d} {by or 'NOT NOTICED':24s} {change.file}:{change.line}: {change.before}  ->  "
                  f"{change.after}", flush=True)
    build(["all"])
    noticed = sum(by != "" for by in results)
    low, high = interval(noticed, len(results))
    print(f"noticed {noticed} of {len(results)}: {noticed / len(results):.0%} ({low:.0%} to {high:.0%}), of "
          f"{len(drawn)} places")
    return 0


if __name__ == "__main__":
    sys.exit(main())
