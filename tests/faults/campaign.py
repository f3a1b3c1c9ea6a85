#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A campaign of faults: each process of a session is killed, stopped, made busy or started again in each phase.

Usage: STILLHAND_BUILD=build /usr/bin/python3 tests/faults/campaign.py --out DIR [--runs N] [--seed S] [--labs J]
           [--cells PATTERN] [--minutes M] [--go-on]

README.md has the faults, the phases and what must hold. Writes DIR/faults.json, DIR/faults.md and a folder for each run
that broke a rule. Exit status 1 if one did.
"""
import argparse
import os
import pathlib
import queue
import random
import shutil
import sys
import threading
import time

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "integration"), str(TESTS / "support")]

import report  # noqa: E402
from again_after_standstill import STANDSTILL_S, Clock  # noqa: E402
from cells import DEFAULT_RUNS, plan  # noqa: E402
from lab_process import CTEST_SKIPPED, INSPECT, STILLHAND, loose_settings, next_domain, shared_memory  # noqa: E402
from one_run import BUSY, Run, next_session  # noqa: E402
from probe import RIG_PROBE  # noqa: E402

TRIES = 3
MOST_LABS = 6  # domains that a test program keeps (lab_process.MOST_OWN_DOMAINS)


class Standstills:
    """The longest standstill of the machine since a moment, as clocks on every core measure it."""

    def __init__(self, cores):
        self._clocks = [Clock(core) for core in cores]
        for clock in self._clocks:
            clock.start()
        self._lock = threading.Lock()
        self._noted = []  # (time, length) of each

    def since(self, began_s):
        with self._lock:
            for clock in self._clocks:
                if clock.longest_s > 0.0:
                    self._noted.append((time.monotonic(), clock.longest_s))
                    clock.longest_s = 0.0
            return max((length for at, length in self._noted if at >= began_s), default=0.0)

    def end(self):
        for clock in self._clocks:
            clock.ended.set()


class Campaign:
    def __init__(self, options, cores):
        self.options = options
        self.standstills = Standstills(cores)
        self.todo = queue.Queue()
        self.results = report.read(options.out)
        over = {result["number"] for result in report.counted(self.results)}
        for number, cell in enumerate(plan(options.runs, options.seed, options.cells)):
            if number not in over:
                self.todo.put((number, cell))
        self.until_s = time.monotonic() + 60 * options.minutes
        self.lock = threading.Lock()
        self.config = options.out / "config"
        if not self.config.exists():
            loose_settings(self.config)

    def once(self, number, cell, domain, attempt):
        began_s = time.monotonic()
        folder = self.options.out / "runs" / f"{number:04d}_{cell.name.replace('/', '_')}{'_again' * attempt}"
        rng = random.Random(f"{self.options.seed} {number}")
        result = Run(cell, folder, domain, rng, self.config)()
        result |= {"number": number, "took_s": round(time.monotonic() - began_s, 1),
                   "standstill_s": round(self.standstills.since(began_s), 3)}
        if result["findings"]:
            result["folder"] = str(folder)
        return result

    def work(self, domain):
        # A busy machine must not delay the fault and its witness for longer than the session. What is started from here
        # has the ordinary priority again.
        try:
            os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(1))
        except PermissionError:
            pass
        before = None
        while time.monotonic() < self.until_s:
            try:
                number, cell = self.todo.get_nowait()
            except queue.Empty:
                break
            # A session that a busy machine ended before its fault shows nothing, and a machine that stood still ends
            # sessions as a fault does: such a run is made again, and is listed.
            for attempt in range(TRIES):
                result = self.once(number, cell, domain, attempt)
                if before:
                    self.note(before, next_session=result)
                stood = result["findings"] and result["standstill_s"] >= STANDSTILL_S and attempt < TRIES - 1
                before = result | {"repeated": bool(stood or not result["struck"])}
                if not stood and result["struck"]:
                    break
        if before:
            last = next_session(cell, self.options.out / "runs" / f"after_{before['number']:04d}", domain, self.config)
            self.note(before, next_session=last)

    def note(self, result, next_session):
        """Notes a run when the session after it, on the same domain, has started or not."""
        if not next_session["started"]:
            result["findings"].append(f"next session: {next_session['findings'][-1:]}")
        with self.lock:
            self.results.append(result)
            report.write(self.options.out, self.results, self.options)
            print(report.line(result), flush=True)

    def run(self):
        workers = [threading.Thread(target=self.work, args=(next_domain(),)) for _ in range(self.options.labs)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        self.standstills.end()


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder of the results")
    parser.add_argument("--runs", type=int, default=DEFAULT_RUNS, help=f"sessions with a fault [{DEFAULT_RUNS}]")
    parser.add_argument("--seed", type=int, default=1, help="of the moments and the pairs [1]")
    parser.add_argument("--labs", type=int, default=2, choices=range(1, MOST_LABS + 1), metavar=f"1..{MOST_LABS}",
                        help="sessions at once [2]")
    parser.add_argument("--minutes", type=float, default=600.0, help="no run begins after this time [600]")
    parser.add_argument("--replace", action="store_true", help="remove an earlier campaign from --out first")
    parser.add_argument("--go-on", action="store_true", help="continue the campaign in --out, with the same options")
    parser.add_argument("--cells", default="*", help="pattern of victim/fault/phase, for example 'rig/*/C' [*]")
    return parser.parse_args()


def main():
    options = arguments()
    missing = [str(path) for path in (STILLHAND, INSPECT, RIG_PROBE, BUSY) if not path.is_file()]
    if missing:
        print("skipped: not built:", ", ".join(missing))
        return CTEST_SKIPPED
    if not plan(1, options.seed, options.cells):
        print(f"--cells {options.cells}: no cell has such a name; one is 'rig/kill/C'", file=sys.stderr)
        return 2
    if options.replace and (options.out / "faults.json").is_file():
        shutil.rmtree(options.out)
    if options.out.exists() and not options.go_on:
        print(f"--out {options.out}: it is there already; want a new folder, --go-on or --replace", file=sys.stderr)
        return 2
    options.out.mkdir(parents=True, exist_ok=True)
    before = shared_memory()
    campaign = Campaign(options, sorted(os.sched_getaffinity(0)))
    campaign.run()
    left = shared_memory() - before
    if left:
        print(f"files left in /dev/shm: {sorted(left)}")
    broken = report.broken(campaign.results)
    print(report.totals(campaign.results, options.runs))
    return 1 if broken or left else 0


if __name__ == "__main__":
    sys.exit(main())
