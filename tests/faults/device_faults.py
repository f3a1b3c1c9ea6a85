#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every fault of a device, of its cable and of the host while the emulated drive pushes: how long a torque stays.

Usage: STILLHAND_BUILD=build /usr/bin/python3 tests/faults/device_faults.py --out DIR [--only NAMES]
       STILLHAND_BUILD=build /usr/bin/python3 tests/faults/device_faults.py --alone [--out DIR] [--only NAMES]

With --out: a session in condition C for each fault; writes DIR/device_faults.md and .json. Each session takes 20 s.
--alone: the rig of devices without a session (pushing_rig), a second or two for each fault; --only quick are those of
the default test run. --watchdog-ms and --max-age-ms set the two limits (100 and 80: a busy machine stands still for
longer than the settings' defaults of 20 and 10). Exit status 1 if a torque stayed beyond its limit, a command broke a
rule, or nobody said what happened.
"""
import argparse
import contextlib
import datetime
import functools
import json
import os
import pathlib
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "integration"), str(TESTS / "support")]


def options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, help="folder of the table")
    parser.add_argument("--alone", action="store_true", help="without a session")
    parser.add_argument("--only", default="", help="names, with commas between them; quick: those of the default tests")
    parser.add_argument("--watchdog-ms", type=int, default=100)
    parser.add_argument("--max-age-ms", type=int, default=80)
    words = parser.parse_args()
    if not (words.out or words.alone):
        parser.error("want --out DIR or --alone")
    return words


WORDS = options() if __name__ == "__main__" else None
if WORDS:  # emulated_laboratory reads them when it is imported
    os.environ |= {"STILLHAND_WATCHDOG_MS": str(WORDS.watchdog_ms), "STILLHAND_MAX_AGE_MS": str(WORDS.max_age_ms)}

import iio_context  # noqa: E402
import lab_process  # noqa: E402
from emulated_laboratory import MAX_AGE_MS, PROGRAM, WATCHDOG_MS, EmulatedLaboratory  # noqa: E402
from lab_process import BUILD, CTEST_SKIPPED, INSPECT, STILLHAND, TRIAL_LIMIT_S, LabProcess, next_domain, quick_session  # noqa: E402
from waiting import wait_for  # noqa: E402

PUSHING_RIG = BUILD / "tests" / "pushing_rig"
PUSH_N_M = 0.1  # 1 N at the hand
# From a fault to the end of the torque. A host that lives notices by the age of the newest reply or by the drive's
# counter (20 ms more), and stops the drive, or its force ramps down in 40 ticks. A host that does not live leaves it to
# the watchdog. 5 ms: the emulator looks each millisecond, and a command may be under way.
DRIVE_LIMIT_MS = WATCHDOG_MS + 5
HOST_LIMIT_MS = max(MAX_AGE_MS + 20 + 40 + 5, DRIVE_LIMIT_MS)
LIMIT_S = 15
SILENT = "the drive is silent"


class Fault:
    """One fault. `said`: what names it, as a regular expression; None: nothing, since the work goes on.

    `drive_alone`: no host is left that could help. `more_ms`: beyond the host's limit. `alone`: also without a session.
    `session`: also with one, unless others show the same there.
    """

    def __init__(self, title, *orders, said, hurt=None, drive_alone=False, more_ms=0, alone=True, quick=False, iio=False,
                 session=True, **keywords):
        self.title, self.orders, self.said, self.hurt = title, orders, said, hurt
        self.drive_alone, self.more_ms, self.alone, self.quick = drive_alone, more_ms, alone, quick
        self.iio, self.session, self.keywords = iio, session, keywords

    def strike(self, bench):
        if self.orders:
            bench.laboratory.order(*self.orders)
        else:
            act = self.hurt(bench)  # what takes time comes before the mark
            bench.laboratory.order("mark")
            act()


def to_all(pids, number):
    for pid in pids:
        os.kill(pid, number)


def kill(service):
    return lambda bench: functools.partial(to_all, bench.pids(service), signal.SIGKILL)


def freeze(service):
    return lambda bench: functools.partial(to_all, bench.pids(service), signal.SIGSTOP)


def open_again(bench):
    """A second process wants the drive's port."""
    done = subprocess.run([str(PUSHING_RIG), "--config", str(bench.laboratory.config)], stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, timeout=LIMIT_S, check=False)
    bench.second = "the second one: " + re.sub(r"^.*?: got", "got", done.stderr.strip())
    if done.returncode != 2 or not re.search("a port that another process has|Device or resource busy", done.stderr):
        bench.findings.append(f"a second process is not refused: {done}")


# One number for ever is noticed after 200 ticks in which the seat moves (DR-14); an input at its end after 20 (DR-12).
FAULTS = {
    "rig_killed": Fault("the rig's process is killed", hurt=kill("device_rig"), drive_alone=True, quick=True,
                        said="rig.* ended: signal 9"),
    "all_killed": Fault("every process is killed", hurt=kill(""), drive_alone=True, alone=False, said=None),
    "rig_stopped": Fault("the rig's process is stopped", hurt=freeze("device_rig"), drive_alone=True, quick=True,
                         said="life sign|the drive is silent"),
    "host_frozen": Fault("every process is stopped (SIGSTOP)", hurt=freeze(""), drive_alone=True, alone=False, said="life sign|silent|stands still"),
    "cancellation_killed": Fault("the process that cancels is killed", hurt=kill("cancellation"), alone=False,
                                 said="cancellation"),
    "sensing_killed": Fault("the process that senses is killed", hurt=kill("sensing"), alone=False, said="sensing"),
    "two_processes": Fault("a second process opens the drive's port", quick=True, said=None,
                           hurt=lambda bench: functools.partial(open_again, bench)),
    "cable_out": Fault("cable out (terminal closed)", "cable", 0, quick=True, said=SILENT + "|the drive was away"),
    "silent": Fault("silent, port open", "silent", 1, quick=True, said=SILENT),
    "deaf": Fault("deaf", "deaf", 1, said=SILENT),
    "late_5_ms": Fault("answers 5 ms late", "late", 5, said=None),
    "late_50_ms": Fault("answers 50 ms late", "late", 50, quick=True, said=SILENT),
    "late_500_ms": Fault("answers 500 ms late", "late", 500, said=SILENT),
    "repeated": Fault("the same answer again and again", "repeated", 1, quick=True, said=SILENT),
    "garbage": Fault("garbage", "garbage", 1, quick=True, said=SILENT),
    "wrong_checksum": Fault("wrong checksum", "damaged", 1, said=SILENT, uart=True),
    "digit_changed": Fault("one digit of an answer changed, without checksums", "damaged", 1,
                           said="mode that Stillhand does not command"),
    "truncated": Fault("answers cut", "truncated", 1, said=SILENT),
    "other_firmware": Fault("another firmware's register", "firmware", 3, said=SILENT),
    "reboot": Fault("the drive starts again", "reboot", quick=True, said="the drive was away or started again"),
    "drive_fault": Fault("fault 38 of the drive", "fault", 38, said="the drive reports fault 38"),
    "encoder_jump": Fault("the encoder jumps by a quarter turn", "slip", 0.25, quick=True, said="the angle of the drive jumped"),
    "no_position": Fault("a position without a value (NaN)", "nan", 1, said=SILENT),
    "no_acceleration": Fault("the platform's acceleration is NaN", "seat_unknown", 1, alone=False, acceleration="platform",
                             said=None),
    "saturated": Fault("the accelerometer stands at its end", "saturate", 1, more_ms=20, quick=True,
                       said="an analogue input of the drive stands at its end"),
    "repeated_number": Fault("the accelerometer repeats one number", "hold", 1, more_ms=1000,
                             said="the accelerometer repeats one number while the seat moves"),
    "platform_loses_a_fifth": Fault("UDP: a fifth of the datagrams is lost, each way", "platform_loses", 0.2, said=None),
    "platform_dropped": Fault("UDP: every datagram is lost", "platform_loses", 1, quick=True, said="the platform is silent"),
    "platform_silent": Fault("UDP: answers are lost", "platform_silent", 1, said="the platform is silent"),
    "platform_fault": Fault("the platform reports a fault", "platform_fault", 2, said="the platform reports fault 0x2"),
    "iio_starved": Fault("IIO: FIFO starved, iiod alive", "iio_starved", 1, iio=True, more_ms=20, quick=True,
                         said="the (load cell|accelerometer) is silent, or at its end"),
    "iio_saturated": Fault("IIO: the accelerometer's converter at its end", "iio_saturated", 1, iio=True, more_ms=20,
                           said="the accelerometer is silent, or at its end"),
    "iiod_died": Fault("IIO: iiod dies", hurt=lambda bench: bench.iio.end, iio=True, more_ms=20,
                       said="the (load cell|accelerometer) is silent, or at its end"),
    "iiod_stands": Fault("IIO: iiod stands still (SIGSTOP)", hurt=lambda bench: bench.iio.stand_still, iio=True, more_ms=20,
                         said="the (load cell|accelerometer) is silent, or at its end"),
}


class Bench:
    """An emulated laboratory whose drive pushes; the subclasses say who commands it."""

    def __init__(self, folder, fault, domain=None):
        self.folder, self.findings, self.second = folder, [], ""
        self.iio = iio_context.IioContext(folder / "iio") if fault.iio else None
        self.laboratory = EmulatedLaboratory(folder / "config", domain=domain, iio=self.iio, **fault.keywords)

    def wait_for_push(self, ended):
        wait_for("a torque of the drive", lambda: abs(self.laboratory.report()["torque_n_m"]) > PUSH_N_M, LIMIT_S, 0.002,
                 ended=ended)

    def close(self):
        self.laboratory.close()
        if self.iio:
            self.iio.close()


class Alone(Bench):
    def __init__(self, folder, fault):
        super().__init__(folder, fault)
        self.process = subprocess.Popen([str(PUSHING_RIG), "--config", str(self.laboratory.config)], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, bufsize=1)
        self.wait_for_push(lambda: self.process.poll() is not None and f"pushing_rig: {self.process.stderr.read()}")

    def pids(self, _service):
        return [self.process.pid]

    def says(self):
        """What the rig's process said, if it lives: only then it can."""
        self.process.send_signal(signal.SIGCONT)
        said = b""
        while select.select([self.process.stdout], [], [], 0.2)[0] and (more := os.read(self.process.stdout.fileno(), 4096)):
            said += more
        lines = said.decode().splitlines()
        return "; ".join(line.removeprefix("unsound ") for line in lines if line.startswith("unsound "))

    def goes_on(self):
        return self.process.poll() is None

    def recorded(self):
        return "-"

    def close(self):
        self.process.kill()
        self.process.communicate()
        super().close()


class Session(Bench):
    def __init__(self, folder, fault):
        domain = next_domain()
        arguments = quick_session(folder / "config")
        super().__init__(folder, fault, domain)
        self.lab = LabProcess(folder / "run", "--rig", "devices", *arguments, domain=domain)
        self.lab.wait_for_tick(1, 1, TRIAL_LIMIT_S)
        self.wait_for_push(lambda: self.lab.process.poll() is not None and f"the lab ended: {self.lab.errors()}")

    def pids(self, service):
        """Of all processes the rig comes first: from then on nobody commands the drive."""
        if service:
            return [self.lab.pid_of(service)]
        everybody = lab_process.running(self.lab.domain)
        return sorted(everybody, key=lambda pid: everybody[pid] != "stillhand-device_rig")

    def says(self):
        """The reason of the trial's mark, once the session is over; of a session that was killed its last line."""
        for pid in lab_process.running(self.lab.domain):
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGCONT)
        if self.lab.process.poll() is None:
            self.lab.end_status(60)
        with contextlib.suppress(FileNotFoundError):
            return self.lab.summary()["trials"][-1]["aborted"] or ""
        return (self.lab.errors() or [""])[-1]

    def goes_on(self):
        if self.lab.process.poll() is not None:
            return False
        self.lab.interrupt()
        self.lab.end_status(60)
        return True

    def recorded(self):
        seen = self.lab.recording(1)
        words = ["the tick of zero force"] if seen.get("force_zero_ticks") else []
        marked = pathlib.Path(self.lab.out / "summary.json").is_file() and self.lab.summary()["trials"][-1]["aborted"]
        words = (["the trial is marked"] if marked else []) + words
        damage = seen["damage"] or []
        return "; ".join(words + [f"damage: {damage}"] * bool(damage)) or "whole"

    def close(self):
        self.lab.close()
        super().close()


def ended_by(seen, fault):
    if fault.said is None and fault.alone and seen["follows"]:
        return "goes on"
    if seen["timeouts"] > 0:
        return "the drive's watchdog"
    if seen["torque_after_fault_ms"] == 0.0:
        return "the drive itself"
    if seen["follows"]:
        return "the host's ramp"
    return "a stop of the host" if seen["mode"] == 0 else f"mode {seen['mode']}"


def rules(seen):
    """Rules of DR-3 and DR-5 that a command broke."""
    broken = [rule for rule in ("other_modes", "without_watchdog", "with_gains", "without_bound") if seen[rule] != 0]
    broken += ["more than 2.5 N m"] * (seen["most_torque_n_m"] > 2.5)
    return broken + ["a torque in the command that arms"] * (seen["first_torque_n_m"] != 0.0)


def run(name, form, folder):
    fault = FAULTS[name]
    bench = form(folder, fault)
    try:
        fault.strike(bench)
        hold_ms = 350 if form is Alone else 700
        wait_for("time after the fault", lambda: bench.laboratory.report()["since_fault_ms"] > hold_ms + fault.more_ms, LIMIT_S)
        seen = bench.laboratory.report()
        findings = bench.findings + rules(seen)
        slack_ms = seen["worst_step_ms"]
        result = {"fault": name, "title": fault.title, "torque_at_fault_n_m": round(seen["fault_torque_n_m"], 3),
                  "until_ms": round(seen["torque_after_fault_ms"], 1), "ended_by": ended_by(seen, fault),
                  "after_command_ms": round(seen["torque_after_command_ms"], 1), "emulator_ms": round(slack_ms, 1)}
        if seen["torque_after_command_ms"] > DRIVE_LIMIT_MS + slack_ms:
            findings.append(f"a torque {seen['torque_after_command_ms']:.0f} ms after its command")
        ends = not (fault.said is None and fault.alone and not fault.drive_alone)
        limit_ms = DRIVE_LIMIT_MS if fault.drive_alone else HOST_LIMIT_MS + fault.more_ms
        if ends and (seen["torque_n_m"] != 0.0 or seen["torque_after_fault_ms"] > limit_ms + slack_ms):
            findings.append(f"torque {seen['torque_n_m']} N m, {seen['torque_after_fault_ms']:.0f} ms after the fault")
        if fault.drive_alone and seen["timeouts"] != 1:
            findings.append(f"the watchdog tripped {seen['timeouts']} times")
        if fault.said is None and not fault.drive_alone:
            pushes = seen["follows"] and (form is Session or seen["torque_n_m"] != 0.0)
            if not bench.goes_on() or (fault.alone and not pushes):
                findings.append("the work does not go on")
        said = "" if fault.said is None and not fault.drive_alone else bench.says()
        if fault.said is not None and not (form is Alone and fault.drive_alone) and not re.search(fault.said, said):
            findings.append(f"said {said!r}, want {fault.said!r}")
        result |= {"said": bench.second or said or "nothing", "recorded": bench.recorded(), "findings": findings}
        if form is Session and "platform" in name or name == "platform_dropped":
            result["platform_until_ms"] = round(seen["platform_after_fault_ms"], 1)
        return result
    finally:
        bench.close()


def line(result):
    until = "-" if result["ended_by"] == "goes on" else result["until_ms"]
    return f"{'BROKEN' if result['findings'] else 'ok':6s} {result['fault']:24s} torque until {until} ms, by {result['ended_by']}; " \
           f"longest after its command {result['after_command_ms']} ms; emulator {result['emulator_ms']} ms; " \
           f"said: {result['said']} {'; '.join(result['findings'])}"


def table(results):
    command = " ".join(["STILLHAND_BUILD=build /usr/bin/python3 tests/faults/device_faults.py", *sys.argv[1:]])
    lines = [f"`{command}`, {datetime.date.today()}, watchdog {WATCHDOG_MS} ms, oldest reply {MAX_AGE_MS} ms. Times by the "
             "emulator's clock.", "",
             "| fault | last torque [ms] | ended by | longest torque after its command [ms] | the session says | recorded |",
             "| --- | --- | --- | --- | --- | --- |"]
    for each in results:
        until = "-" if each["ended_by"] == "goes on" else f"{each['until_ms']:.0f}"
        if "platform_until_ms" in each and each["ended_by"] != "goes on":
            until += f"; the platform follows until {each['platform_until_ms']:.0f}"
        lines.append(f"| {each['title']} | {until} | {each['ended_by']} | {each['after_command_ms']:.0f} | {each['said']} | "
                     f"{each['recorded']} |")
    return "\n".join(lines) + "\n"


def chosen(words):
    form = Alone if words.alone else Session
    names = [name for name, fault in FAULTS.items() if (fault.session if form is Session else fault.alone)]
    if words.only == "quick":
        names = [name for name in names if FAULTS[name].quick]
    elif words.only:
        names = words.only.split(",")
        if unknown := [name for name in names if name not in FAULTS]:
            sys.exit(f"device_faults.py: --only: got {', '.join(unknown)}, want some of {', '.join(FAULTS)}")
    if why := iio_context.missing():
        print(f"skipped: {', '.join(name for name in names if FAULTS[name].iio)}: {why}")
        names = [name for name in names if not FAULTS[name].iio]
    return form, names


def main(words):
    missing = [str(path) for path in (STILLHAND, INSPECT, PROGRAM, PUSHING_RIG) if not path.is_file()]
    if missing:
        print("skipped: not built:", ", ".join(missing))
        return CTEST_SKIPPED
    form, names = chosen(words)
    results = []
    for name in names:
        folder = pathlib.Path(tempfile.mkdtemp(prefix="stillhand-fault-"))
        try:
            results.append(run(name, form, folder))
        except (AssertionError, OSError, subprocess.TimeoutExpired) as error:
            results.append({"fault": name, "title": FAULTS[name].title, "until_ms": -1, "ended_by": "not reached",
                            "after_command_ms": -1, "emulator_ms": -1, "said": "", "recorded": "", "findings": [str(error)]})
        finally:
            shutil.rmtree(folder, ignore_errors=True)
        print(line(results[-1]), flush=True)
        if words.out:  # after each one: a campaign that is ended keeps what it has
            words.out.mkdir(parents=True, exist_ok=True)
            (words.out / "device_faults.json").write_text(json.dumps(results, indent=1) + "\n")
            (words.out / "device_faults.md").write_text(table(results))
    broken = [result["fault"] for result in results if result["findings"]]
    print(f"{len(results)} faults, {len(broken) or 'none'} broke a rule{': ' if broken else ''}{', '.join(broken)}")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main(WORDS))
