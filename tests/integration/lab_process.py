# SPDX-License-Identifier: Apache-2.0
"""A `stillhand lab` under test: start it, watch its processes and its recording, see it end.

Every lab gets a DDS domain of its own. Nothing here waits for a time to pass: wait_for() polls a condition and fails
when its limit is over.
"""
import fcntl
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

from verb_case import BUILD, SOURCE, STILLHAND, FolderCase  # noqa: E402
from waiting import POLL_S, hold, wait_for  # noqa: E402,F401  also for its users

INSPECT = BUILD / "tests" / "inspect_recording"
STRANGER = BUILD / "tests" / "stranger"
EQUIVALENCE = BUILD / "tests" / "equivalence_live_recording"

# In the order of the table of processes.
SERVICES = tuple(re.findall(r'Process{\.name = "(\w+)", \.launch', (SOURCE / "idl/processes.hpp").read_text()))
CTEST_SKIPPED = 77
TICKS_PER_S = 1000
FORCE_LIMIT_TICKS = 50  # the motor's force ramps to zero within 40 ticks, and a tick is at most 5 ms late, twice

# How long a lab under test may take [s].
MATCH_LIMIT_S = 30.0  # the lab itself gives up after 20 s
TRIAL_LIMIT_S = 60.0  # of a quick session, until its first tracking trial: 12 s on two cores
END_LIMIT_S = 20.0    # the lab gives its processes 5 s, and the recorder another 5 s
DOMAINS = 16
MOST_OWN_DOMAINS = 6
_domains_used = 0
_own_domains = {}  # {domain: its lock}, the oldest first


def next_domain():
    """A DDS domain from 215 to 230 that no other test on this machine uses; another one at each call.

    From 215 on, the UDP ports (7400 + 250 a domain) lie above Linux's ephemeral range, which ends at 60999. A lock on a
    file with the domain's number keeps other tests away. A test program keeps the last few domains that it took.
    """
    global _domains_used
    for _ in range(DOMAINS):
        _domains_used += 1
        domain = 215 + (os.getpid() + _domains_used) % DOMAINS
        if domain in _own_domains:
            continue
        lock = open(pathlib.Path(tempfile.gettempdir()) / f"stillhand-test-domain-{domain}", "w", encoding="utf-8")
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            lock.close()
            continue
        _own_domains[domain] = lock
        if len(_own_domains) > MOST_OWN_DOMAINS:
            _own_domains.pop(next(iter(_own_domains))).close()
        return domain
    raise RuntimeError("other tests have every DDS domain from 215 to 230")


def running(domain):
    """Processes of Stillhand on a domain, {pid: name of the program}."""
    found = {}
    for entry in pathlib.Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            words = (entry / "cmdline").read_bytes().decode().split("\0")
        except OSError:  # it ended meanwhile
            continue
        program = pathlib.PurePath(words[0]).name
        if program.startswith("stillhand") and ("--domain", str(domain)) in zip(words, words[1:]):
            found[int(entry.name)] = program
    return found


def shared_memory():
    """Files in /dev/shm that Fast DDS (fastrtps_*, fast_datasharing_*, sem.fastrtps_*) or Stillhand may have left."""
    return {name for name in os.listdir("/dev/shm") if "fast" in name or "stillhand" in name}


def loose_settings(folder, origin=SOURCE / "deploy" / "config"):
    """A settings folder in which identification accepts the rough model that a pegged trial of 5 s gives."""
    shutil.copytree(origin, folder)
    (folder / "identification.yaml").write_text("max_conversion_error: 1.0\n")
    return folder


def quick_session(folder):
    """Arguments of a session that soon has a motor force: condition C after a pegged trial of 5 s.

    For tests that need a force and not a good model, which takes a pegged trial of 40 s.
    """
    loose_settings(folder)
    return ["--conditions", "C", "--identify-seconds", 5, "--trial-seconds", 60, "--seed", 2, "--config", folder]


class LabProcess:
    """One `stillhand lab`, ended with everything it started by close()."""

    def __init__(self, out, *arguments, domain=None, program=None, headless=True, environment=None,
                 before_start=None, start=(), inventory=None, typed=subprocess.DEVNULL):
        """start: words before the lab's own; inventory: of its machines, on the domain given; typed: its input."""
        self.out = pathlib.Path(out)  # "": none given
        self.domain = next_domain() if domain is None else domain
        self._shared_memory_before = shared_memory()
        self._output = tempfile.TemporaryFile("w+")
        self._errors = tempfile.TemporaryFile("w+")
        words = [*start, str(program or STILLHAND), "lab"]
        words += ["--inventory", str(inventory)] if inventory else ["--domain", str(self.domain)]
        words += ["--headless"] if headless else []
        words += ["--out", str(out)] if out else []
        # A session of its own: interrupt() reaches the process group, as a terminal's Ctrl-C does.
        self.process = subprocess.Popen(words + [str(word) for word in arguments], stdin=typed,
                                        stdout=self._output, stderr=self._errors, start_new_session=True,
                                        env=environment, preexec_fn=before_start)

    def pid_of(self, service):
        """Process number of a service, None before it runs."""
        for pid, program in running(self.domain).items():
            if program == f"stillhand-{service}":
                return pid
        return None

    def interrupt(self):
        os.killpg(self.process.pid, signal.SIGINT)

    def errors(self):
        """Lines on standard error so far."""
        self._errors.seek(0)
        return self._errors.read().splitlines()

    def output(self):
        self._output.seek(0)
        return self._output.read()

    def wait_for(self, what, condition, limit_s, poll_s=POLL_S):
        """Returns the condition's first true value; fails after the limit, or if the lab ends before."""
        def ended():
            status = self.process.poll()
            return status is not None and f"lab ended with status {status} before {what}"
        return wait_for(what, condition, limit_s, poll_s, ended=ended,
                        failure=lambda why: AssertionError(f"{why}: {self.errors()}"))

    def wait_for_start(self):
        self.wait_for("all services", lambda: len(running(self.domain)) > len(SERVICES), MATCH_LIMIT_S)

    def wait_for_tick(self, trial, after_s, limit_s):
        """Waits until the recording holds a trial's measured part up to `after_s`."""
        def reached():
            seen = self.recording(1)
            starts = [entry["start_tick"] for entry in seen["trials"] if entry["number"] == trial]
            newest = seen["rig"]["tick"]
            return starts and newest and newest[-1] >= starts[-1] + after_s * TICKS_PER_S
        self.wait_for(f"{after_s} s of trial {trial}", reached, limit_s, poll_s=0.3)

    def end_status(self, limit_s=END_LIMIT_S):
        """Exit status, once the lab has ended."""
        return self.process.wait(timeout=limit_s)

    def wait_until_alone(self, limit_s=END_LIMIT_S):
        """Waits until no process of this lab is left; returns those that are left after the limit."""
        wait_for("end of the lab's processes", lambda: not running(self.domain), limit_s, failure=None)
        return running(self.domain)

    def shared_memory_left(self):
        return shared_memory() - self._shared_memory_before

    def recording(self, last_ticks, *more):
        """The recording as inspect_recording sees it, with the newest `last_ticks` ticks of the rig."""
        inspected = subprocess.run([str(INSPECT), str(self.out / "session.mcap"), str(last_ticks), *more],
                                   capture_output=True, text=True, check=False)
        if inspected.returncode != 0:  # not there yet, or without a complete record
            return {"messages": {}, "trials": [], "rig": {"tick": []}, "damage": [inspected.stderr]}
        return json.loads(inspected.stdout)

    def measured_signals(self, trial):
        """Rows of the measured part of a trial, by signal (inspect_recording.cpp); the tick comes first in each."""
        recording = self.recording(10**9, "signals")
        entry = next(entry for entry in recording["trials"] if entry["number"] == trial)
        ticks = range(entry["start_tick"], entry["start_tick"] + entry["duration_ticks"])
        return {name: [row for row in rows if row[0] in ticks] for name, rows in recording["signals"].items()}

    def summary(self):
        return json.loads((self.out / "summary.json").read_text())

    def close(self):
        """Ends every process that is left, by its number."""
        self.process.kill()
        self.process.wait()
        for pid in running(self.domain):
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:  # it ended meanwhile
                pass
        self._output.close()
        self._errors.close()


class LabTestCase(FolderCase):
    """A test that no lab survives."""

    def lab(self, *arguments, out=None, **keywords):
        lab = LabProcess(self.folder / "run" if out is None else out, *arguments, **keywords)
        self.addCleanup(lab.close)
        return lab

    def stranger(self, domain, *what):
        """A program of no lab on a domain (stranger.cpp)."""
        process = subprocess.Popen([str(STRANGER), str(domain), *what], stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    @staticmethod
    def heard(stranger):
        """Ends a stranger; how many messages it received, and how many readers it had."""
        stranger.terminate()
        return tuple(int(number) for number in re.findall(r"\d+", stranger.communicate(timeout=10)[0]))

    def assert_force_ends(self, rig, first):
        """From the sample `first` on, the interlock opens, and the force that was there is soon zero and stays it.

        Returns where the interlock is open, and where the force is zero.
        """
        force = rig["motor_force_n"]
        opened = next((i for i in range(first, len(force)) if not rig["motor_permitted"][i]), None)
        self.assertIsNotNone(opened, "the interlock stayed closed")
        self.assertGreater(max(abs(each) for each in force[max(opened - TICKS_PER_S, 0):opened]), 1.0, "there was no force")
        zero = next((i for i in range(opened, len(force)) if force[i] == 0.0), None)
        self.assertIsNotNone(zero, "the recording ends before the force is zero")
        self.assertLessEqual(rig["tick"][zero] - rig["tick"][opened], FORCE_LIMIT_TICKS)
        self.assertEqual([each for each in force[zero:] if each != 0.0], [])
        return opened, zero

    def assert_same_in_one_process(self, lab, config, *answers, **environment):
        """Bit for bit: the same cores in one process answer the session's inputs as its processes did."""
        words = [str(EQUIVALENCE), "--gtest_filter=" + ":".join(f"*.{each}" for each in answers)]
        environment |= {"STILLHAND_RECORDING": str(lab.out / "session.mcap"), "STILLHAND_CONFIG": str(config)}
        replay = subprocess.run(words, env=os.environ | environment, capture_output=True, text=True, check=False)
        print(*(line for line in replay.stdout.splitlines() if " compared, " in line), sep="\n", flush=True)
        self.assertEqual(replay.returncode, 0, replay.stdout[-4000:])
        self.assertIn(f"{len(answers)} tests from 1 test suite ran", replay.stdout)

    def assert_nothing_left(self, lab):
        self.assertEqual(lab.wait_until_alone(), {}, "processes left")
        self.assertEqual(lab.shared_memory_left(), set(), "files left in /dev/shm")


def campaign(case):
    """Marks a test case that runs with `--campaign` alone: it is long, and a shorter one runs by default."""
    case.campaign = True
    return case


class _Loader(unittest.TestLoader):
    """Loads the cases marked @campaign, or all the others."""

    def __init__(self, wanted):
        super().__init__()
        self._wanted = wanted

    def getTestCaseNames(self, test_case):
        return [name for name in super().getTestCaseNames(test_case)
                if getattr(getattr(test_case, name), "campaign", False) == self._wanted]


def run_cases():
    """Runs the calling program's cases, those marked @campaign if its words hold `--campaign`.

    Ends with status 1 if a case failed, and with 77 (ctest: skipped) if none failed and one was skipped.
    """
    words = [word for word in sys.argv if word != "--campaign"]
    result = unittest.main(module="__main__", argv=words, exit=False,
                           testLoader=_Loader("--campaign" in sys.argv)).result
    for case, reason in result.skipped:
        print(f"skipped: {case}: {reason}", flush=True)
    sys.exit(1 if not result.wasSuccessful() else CTEST_SKIPPED if result.skipped else 0)


class ProcessorTime:
    """How busy all processors are from now on: 1 is no rest. Another virtual machine's share counts as busy."""

    def __init__(self):
        self._idle, self._all = self._ticks()

    def busy_share(self):
        idle, total = self._ticks()
        return 1.0 - (idle - self._idle) / max(total - self._all, 1)

    @staticmethod
    def _ticks():
        # proc(5), /proc/stat, first line: user nice system idle iowait irq softirq steal, and guests, who count as users.
        ticks = [int(word) for word in pathlib.Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:9]]
        return ticks[3] + ticks[4], sum(ticks)


def skip(reason):
    """Ends the program: ctest reports it as skipped."""
    print("skipped:", reason)
    sys.exit(CTEST_SKIPPED)


def main(*needed):
    """Runs the calling program's cases; skipped if a program that they need is not built."""
    missing = [str(path) for path in (STILLHAND, INSPECT, *needed) if not path.is_file()]
    if missing:
        skip("not built: " + ", ".join(missing))
    run_cases()
