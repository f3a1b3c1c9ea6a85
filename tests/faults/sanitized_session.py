#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A live session in which one process is built with a sanitizer, process after process.

Usage: STILLHAND_BUILD=build /usr/bin/python3 tests/faults/sanitized_session.py --tree build-asan-ubsan --out DIR
           [--service NAME]... [--conditions LIST]

A sanitizer makes a process several times slower, and nine such processes miss the sample clock. So the others come from
the plain build. The tree needs the executables of the services alone:

    cmake --preset asan-ubsan && cmake --build --preset asan-ubsan --target stillhand-rig stillhand-cancellation ...

Prints a line for each process; the sanitizer's reports go to DIR. Exit status 1 if there is a report.
"""
import argparse
import os
import pathlib
import shutil
import sys

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "integration"), str(TESTS / "support")]

from lab_process import BUILD, SERVICES, SOURCE, LabProcess, loose_settings  # noqa: E402

SESSION_LIMIT_S = 180.0


def programs(folder, tree, service):
    """The plain build's programs, and one of the tree's. `stillhand` is a copy: it looks next to itself for others."""
    (folder / "bin").mkdir(parents=True)
    (folder / "share").mkdir()
    (folder / "share" / "stillhand").symlink_to(SOURCE)
    shutil.copy2(BUILD / "bin" / "stillhand", folder / "bin" / "stillhand")
    for name in SERVICES:
        of = tree if name == service else BUILD
        (folder / "bin" / f"stillhand-{name}").symlink_to(of.resolve() / "bin" / f"stillhand-{name}")
    return folder / "bin" / "stillhand"


def session(options, service):
    """How a session went in which one service is the tree's, and the sanitizer's reports."""
    folder = options.out / service
    reports = folder / "reports"
    program = programs(folder, options.tree.resolve(), service)
    reports.mkdir()
    # Fast DDS deletes objects through a base class of another size (tests/CMakeLists.txt).
    environment = dict(os.environ, ASAN_OPTIONS=f"new_delete_type_mismatch=0:log_path={reports}/asan",
                       UBSAN_OPTIONS=f"print_stacktrace=1:log_path={reports}/ubsan",
                       TSAN_OPTIONS=f"suppressions={TESTS}/support/tsan.supp:log_path={reports}/tsan")
    lab = LabProcess(folder / "run", "--conditions", options.conditions, "--identify-seconds", 5, "--trial-seconds", 5,
                     "--seed", 2, "--config", loose_settings(folder / "config"), "--no-real-time", program=program,
                     environment=environment)
    try:
        status = lab.end_status(SESSION_LIMIT_S)
        said = (lab.errors() or [""])[-1]
    finally:
        lab.close()
    return f"status {status} {said}", sorted(reports.iterdir())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tree", type=pathlib.Path, required=True, help="build tree of the sanitizer")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="new folder")
    parser.add_argument("--service", action="append", choices=SERVICES, help="one of them alone [those that are built]")
    parser.add_argument("--conditions", default="C", help="as those of `stillhand lab`, for example B,signal [C]")
    options = parser.parse_args()
    if options.out.exists():
        print(f"--out {options.out}: it is there already; name a new folder", file=sys.stderr)
        return 2
    built = [name for name in options.service or SERVICES if (options.tree / "bin" / f"stillhand-{name}").is_file()]
    if not built:
        print(f"--tree {options.tree}: no executable of a service in its bin/; --help says how to build them",
              file=sys.stderr)
        return 2
    found = 0
    for service in built:
        how, reports = session(options, service)
        found += len(reports)
        print(f"{service:16s} {len(reports)} reports; the session: {how}", flush=True)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
