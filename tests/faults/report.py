# SPDX-License-Identifier: Apache-2.0
"""The results of a campaign as JSON and as tables."""
import datetime
import json
import os
import platform

from cells import KINDS, PHASES, VICTIMS


def broken(results):
    """Runs that count and broke a rule."""
    return [result for result in counted(results) if result["findings"]]


def counted(results):
    return [result for result in results if result["struck"] and not result.get("repeated")]


def line(result):
    mark = "again" if result.get("repeated") else "BROKEN" if result["findings"] else "ok"
    return f"{result['number']:4d} {mark:6s} {result['cell']:40s} {result.get('outcome', '-'):16s} " \
           f"{result['took_s']:5.1f} s  {'; '.join(result['findings'][:2])}"


def totals(results, planned):
    runs = counted(results)
    return f"{len(runs)} of {planned} runs, {len(broken(results))} broke a rule; {len(results) - len(runs)} other " \
           "sessions did not reach their fault, or the machine stood still in them"


def _row(name, cells):
    return "| " + " | ".join([name, *cells]) + " |"


def _table(results):
    """Runs by victim and fault against phase: kept every rule / all."""
    counts = {}
    for result in counted(results):
        victim, kind, phase = result["cell"].split("/")
        row = (victim, kind) if "+" not in kind else ("two processes", "two faults")
        good, number = counts.get((*row, phase), (0, 0))
        counts[*row, phase] = (good + (not result["findings"]), number + 1)
    lines = [_row("victim, fault", PHASES), "|" + " --- |" * (1 + len(PHASES))]
    for victim, kind in [(v, k) for v in VICTIMS for k in KINDS] + [("two processes", "two faults")]:
        cells = [counts.get((victim, kind, phase)) for phase in PHASES]
        if any(cells):
            lines.append(_row(f"{victim}, {kind}", [f"{c[0]}/{c[1]}" if c else "" for c in cells]))
    return lines


def _outcomes(results):
    names = sorted({result.get("outcome", "-") for result in counted(results)})
    lines = [_row("fault", names), "|" + " --- |" * (1 + len(names))]
    for kind in (*KINDS, "two"):
        mine = [result for result in counted(results)
                if ("two" if "+" in result["cell"].split("/")[1] else result["cell"].split("/")[1]) == kind]
        lines.append(_row(kind, [str(sum(result.get("outcome", "-") == name for result in mine)) for name in names]))
    return lines


def _worst(results):
    seen = [result[source] for result in results for source in ("probe", "recording") if source in result]
    names = {"worst_force_n": "largest force [N]", "worst_step_n": "largest change of the force in a tick [N]",
             "zero_ticks": "longest time from the last usable command to zero force [ticks]",
             "worst_position_m": "largest distance of the platform from its middle [m]"}
    return [_row("over all samples of probe and recording", ["worst"]), "| --- | --- |"] + \
           [_row(text, [f"{max((each[name] for each in seen), default=0):.4g}"]) for name, text in names.items()]


def read(folder):
    """The results of a campaign so far."""
    file = folder / "faults.json"
    return json.loads(file.read_text())["results"] if file.is_file() else []


def write(folder, results, options):
    known = {"when": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
             "machine": f"{platform.machine()}, {os.cpu_count()} processors, Linux {platform.release()}",
             "runs": options.runs, "seed": options.seed, "labs": options.labs, "cells": options.cells,
             "results": results}
    (folder / "faults.json").write_text(json.dumps(known, indent=1) + "\n")
    lines = [f"{totals(results, options.runs)} ({known['when']}; {known['machine']}; {options.labs} labs at once).", ""]
    lines += [*_table(results), "", *_outcomes(results), "", *_worst(results), ""]
    for result in broken(results):
        lines.append(f"- run {result['number']} {result['cell']}: {'; '.join(result['findings'])}")
    (folder / "faults.md").write_text("\n".join(lines) + "\n")
