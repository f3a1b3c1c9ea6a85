#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Changes places of the sources at random, one at a time, and sees whether a unit test notices.

Usage: STILLHAND_BUILD=build /usr/bin/python3 tests/faults/mutations.py --out FILE.csv [--runs 200] [--seed 1]

Each change is one token of one line of the cores or of a library of the verbs: a comparison, a sign, a number, a
truth, an "and" that is never true, an "or" that always is, or a whole assignment. All changes are built in at once,
each behind a switch that the environment sets; so a change takes the time of the unit tests alone. Those of the
file's own folder run first, then all others that its object files go into. Prints a line a change and ends with the
share that was noticed and its 95 % interval (Wilson). A change that cannot be switched at run time (the size of an
array, the value of a constant expression) is drawn again. Some changes mean the same program: read those that nobody
noticed. The sources are as before at the end, not after a kill; no other program may build in the tree meanwhile.
Build it again afterwards.
"""
import argparse
import concurrent.futures
import csv
import math
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import threading
import typing

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", SOURCE / "build")).resolve()
FOLDERS = ("services/core/", "apps/libraries/")
LIMIT_S = 900  # of one test program: a change may make a loop endless
# Binary operators have a blank on both sides, which the format check sees to; brackets of templates have none. What
# stands in place of the token: {0} the change's number, {1} the token, {2} what does not change it.
KINDS = {
    "comparison": (r"(?<= )(<=|>=|==|!=|<|>)(?= )", "{1} changed::Token<{0}>() {1}"),
    "sign": (r"(?<=[\w)\]] )([+\-*/])(?= )", "{1} changed::Token<{0}>() {1}"),
    "logic": (r"(?<= )(&&|\|\|)(?= )", "{1} changed::truth<{0}>({2}) {1}"),
    "truth": (r"\b(true|false)\b", "changed::truth<{0}>({1})"),
    "number": (r"(?<![\w.\"'])(?<!e-)(\d+(?:\.\d+)?)(?![\w.'])", "changed::number<{0}>({1})"),
    "assignment": (r"^ +([\w.\[\]]+ [+\-*/]?= .*;)$", "if (!changed::is_on<{0}>()) {1}"),
}
# A switched operator is two of its kind with a token between: both have one precedence and go from left to right.
SWITCH = r"""#pragma once
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wextra"
#include <cstdlib>
#include <type_traits>
namespace changed {
// 0 until it is set, which is no change's number.
inline const int chosen = std::getenv("STILLHAND_CHANGE") ? std::atoi(std::getenv("STILLHAND_CHANGE")) : 0;
template <int N> bool is_on() { return chosen == N; }
template <int N> bool truth(bool own) { return own != is_on<N>(); }
template <int N, class T> T number(T own) {
  return !is_on<N>() ? own : own == T(0) ? T(1) : own == T(1) ? T(0) : T(2 * own);
}
template <class T> auto plain(T&& x) {
  if constexpr (requires { x.eval(); }) return x.eval(); else return std::decay_t<T>(x);
}
template <int N> struct Token {};
template <int N, class A> struct Left { A&& a; };
#define CHANGED_OPERATOR(own, other)                                                         \
  template <int N, class A> Left<N, A> operator own(A&& a, Token<N>) { return {static_cast<A&&>(a)}; } \
  template <int N, class A, class B> auto operator own(Left<N, A> l, B&& b) {                \
    using Value = std::common_type_t<decltype(plain(l.a own b)), decltype(plain(l.a other b))>; \
    return is_on<N>() ? static_cast<Value>(l.a other b) : static_cast<Value>(l.a own b);     \
  }
CHANGED_OPERATOR(<, <=) CHANGED_OPERATOR(<=, <) CHANGED_OPERATOR(>, >=) CHANGED_OPERATOR(>=, >)
CHANGED_OPERATOR(==, !=) CHANGED_OPERATOR(!=, ==)
CHANGED_OPERATOR(+, -) CHANGED_OPERATOR(-, +) CHANGED_OPERATOR(*, /) CHANGED_OPERATOR(/, *)
}  // namespace changed
"""


class Change(typing.NamedTuple):
    file: str
    line: int  # from 1
    kind: str
    first: int  # of the token in the line
    token: str
    code: str


def places():
    """Every change that can be drawn."""
    listed = subprocess.run(["git", "ls-files", *FOLDERS], cwd=SOURCE, capture_output=True, text=True, check=True)
    for file in listed.stdout.splitlines():
        if not file.endswith((".cpp", ".hpp")):
            continue
        in_text = False
        for number, line in enumerate((SOURCE / file).read_text(encoding="utf-8").splitlines(), 1):
            in_text = (in_text or 'R"' in line) and ')"' not in line
            code = "" if in_text else line.split("//")[0].rstrip()
            if not code or '"' in code or code.lstrip().startswith(("#", "*", "static_assert", "template", "using")):
                continue
            for kind, (pattern, _) in KINDS.items():
                for match in re.finditer(pattern, code):
                    yield Change(file, number, kind, match.start(1), match[1], code.strip())


def write_switched(changes, originals):
    """The sources with these changes behind their switches. @param changes  by number; one a line at most"""
    by_file = {file: [] for file in originals}
    for number, change in changes.items():
        by_file[change.file].append((number, change))
    for file, own in by_file.items():
        lines = originals[file].split("\n")
        for number, change in own:
            line = lines[change.line - 1]
            idle = "true" if change.token == "&&" else "false"
            switch = KINDS[change.kind][1].replace("{0}", str(number)).replace("{1}", change.token).replace("{2}", idle)
            line = line[:change.first] + switch + line[change.first + len(change.token):]
            lines[change.line - 1] = line.replace("constexpr ", "const ")
        if own:
            lines[0] = f'#include "{BUILD}/changed.hpp"  {lines[0]}'  # the same line: numbers stay
        text = "\n".join(lines)
        if text != (SOURCE / file).read_text(encoding="utf-8"):
            (SOURCE / file).write_text(text, encoding="utf-8")


def drawn(count, seed):
    """As many changes by number, no two of one line."""
    every = list(places())
    random.Random(seed).shuffle(every)
    lines, taken = set(), []
    for change in every:
        if len(taken) < count and (change.file, change.line) not in lines:
            lines.add((change.file, change.line))
            taken.append(change)
    return taken, len(every)


def programs():
    return sorted(path.name for path in (BUILD / "tests").glob("unit_*") if os.access(path, os.X_OK) and path.is_file())


def refused(changes):
    """Numbers of those at which the build ends; none: it is built."""
    ran = subprocess.run(["cmake", "--build", str(BUILD), "-j", "2", "--target", *programs(), "--", "-k", "0"],
                         capture_output=True, text=True, check=False)
    if ran.returncode == 0:
        return set()
    named = set(re.findall(rf"{SOURCE}/([\w./]+):(\d+)", ran.stdout + ran.stderr))
    found = {number for number, change in changes.items() if (change.file, str(change.line)) in named}
    if not found:
        raise SystemExit("mutations: the sources do not build\n" + ran.stdout[-2000:])
    return found


def built(wanted, seed):
    """Changes by number that are built in, at least as many as wanted."""
    candidates, count = drawn(wanted + wanted // 2, seed)
    originals = {change.file: (SOURCE / change.file).read_text(encoding="utf-8") for change in candidates}
    (BUILD / "changed.hpp").write_text(SWITCH, encoding="utf-8")
    changes = dict(enumerate(candidates, 1))
    try:
        while True:
            write_switched(changes, originals)
            bad = refused(changes)
            if not bad:
                if len(changes) < wanted:
                    raise SystemExit(f"mutations: only {len(changes)} of {len(candidates)} can be switched")
                return changes, count
            changes = {number: change for number, change in changes.items() if number not in bad}
            print(f"{len(bad)} cannot be switched, {len(changes)} are left", file=sys.stderr, flush=True)
    finally:
        write_switched({}, originals)


def users():
    """The test programs by each file that is compiled into them."""
    sources, of_file = {}, {}
    listed = subprocess.run(["ninja", "-C", str(BUILD), "-t", "deps"], capture_output=True, text=True, check=True)
    for line in listed.stdout.splitlines():
        if line.startswith(" "):
            sources[current].add(line.strip().removeprefix(f"{SOURCE}/"))
        elif ": #deps" in line:
            current = line.split(": #deps")[0]
            sources[current] = set()
    for program in programs():
        inputs = subprocess.run(["ninja", "-C", str(BUILD), "-t", "inputs", f"tests/{program}"], capture_output=True,
                                text=True, check=True)
        for item in inputs.stdout.split():
            for file in sources.get(item, ()):
                of_file.setdefault(file, set()).add(program)
    return of_file


def passes(program, number):
    """The exit status 77 is a skip. Files of its own: the same program may run twice at once."""
    with tempfile.TemporaryDirectory() as own:
        try:
            return subprocess.run([str(BUILD / "tests" / program), "--gtest_brief=1", "--gtest_fail_fast"], cwd=BUILD,
                                  env={**os.environ, "STILLHAND_CHANGE": str(number), "TEST_TMPDIR": own},
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False,
                                  timeout=LIMIT_S).returncode in (0, 77)
        except subprocess.TimeoutExpired:
            return False


def noticed_by(number, change, of_file):
    """The first program that fails with the change, "" for none."""
    own = f"unit_{change.file.split('/')[2]}"
    for program in sorted(of_file.get(change.file, ()), key=lambda name: (name != own, name)):
        if not passes(program, number):
            return program
    return ""


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
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    changes, count = built(options.runs, options.seed)
    of_file = users()
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for program, passed in zip(programs(), pool.map(lambda name: passes(name, -1), programs())):
            if not passed:
                raise SystemExit(f"mutations: {program} fails without a change")
    results, lock = [], threading.Lock()
    with open(options.out, "w", newline="", encoding="utf-8") as stream:
        rows = csv.writer(stream)
        rows.writerow((*Change._fields, "noticed_by"))

        def run(item):
            number, change = item
            by = noticed_by(number, change, of_file)
            with lock:
                results.append(by)
                rows.writerow((*change, by))
                stream.flush()
                print(f"{len(results):3d} {by or 'NOT NOTICED':24s} {change.file}:{change.line}:{change.first + 1}: "
                      f"{change.kind} {change.token}  in  {change.code}", flush=True)

        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            list(pool.map(run, list(changes.items())[:options.runs]))
    noticed = sum(by != "" for by in results)
    low, high = interval(noticed, len(results))
    print(f"noticed {noticed} of {len(results)}: {noticed / len(results):.0%} ({low:.0%} to {high:.0%}), of "
          f"{count} places")
    return 0


if __name__ == "__main__":
    sys.exit(main())
