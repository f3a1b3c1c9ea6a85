# SPDX-License-Identifier: Apache-2.0
"""One run of the campaign: a session, a fault at a moment of its phase, what came of it, and the session after it."""
import json
import os
import shutil
import signal
import time

from cells import FATAL
from inject import Fault
from judge import figures, rig_findings
from lab_process import BUILD, LabProcess, hold, running, wait_for
from probe import Probe

BUSY = BUILD / "tests" / "libbusy_on_signal.so"
TRIAL_S = 5  # the shortest that the lab takes
START_LIMIT_S = 60.0  # until a phase is reached: 20 s on two cores with nothing else to do
END_LIMIT_S = 90.0  # a whole session after a fault that it survives takes 25 s
LEFT_LIMIT_S = 20.0
LATE_LIMIT_MS = 1500.0  # from the fault to the last command that is used; timing itself is process_death_test's matter
# At rest is 0.001 m/s; 8 of the last samples may still be unwritten, at 5 m/s^2 (deploy/config/rig.yaml).
REST_M_S = 0.001 + 8 * 0.005
# The lab's own process does not go on by itself: a person comes after this time, wakes it up or ends it.
PERSON_S = 3.0
PAUSE_S = 1.5
TICKS_PER_S = 1000


def control_model():
    """A control model with something in every part that a trial can reach (services/processes/cancellation, "Model file")."""
    return {"format": "stillhand control model", "version": 1, "rig": 1, "rate_hz": 1000.0,
            "denominator": [1.0, -1.99, 0.9902],
            "inputs": [{"channel": "a_y", "map": None, "numerator": [0.0, 2e-4, 1e-4]},
                       {"channel": "a_x", "map": None, "numerator": [1e-4, 0.0, 0.0]}],
            "loop": None, "output": None, "paths": [{"channel": "omega", "lag_s": 0.05, "map": None, "gain": -0.3}],
            "waves": [{"channel": "theta", "frequency": 12.0, "sine_n": 0.1, "cosine_n": 0.2}],
            "adapts": {"mass_kg": 1.4, "damping_n_s_m": 30.0, "stiffness_n_m": 900.0, "lever_m": 0.1}}


def next_session(cell, folder, domain, config):
    """The session after the last run of a campaign: {"started", "findings"}. Of every other run it is the next run's."""
    run = Run(cell, folder, domain, None, config)
    folder.mkdir(parents=True)
    probe = Probe(domain, folder / "probe.txt")
    lab = run.lab(run.out, "--wait-for-start")
    started = False
    try:
        run.reach(lab, "a session that waits", lambda: probe.control["state"] == "paused")
        started = True
        lab.interrupt()
        lab.process.wait(timeout=LEFT_LIMIT_S)
    except Exception as error:  # whatever it is, it is a finding of the run before it
        run.findings.append(str(error))
    finally:
        lab.close()
        probe.close()
    return {"started": started, "findings": run.findings}


class Run:
    def __init__(self, cell, folder, domain, rng, config):
        self.cell, self.folder, self.domain, self.rng, self.config = cell, folder, domain, rng, config
        self.out = folder / "run"
        self.findings = []
        self.result = {"cell": cell.name}

    def words(self):
        condition = self.cell.phase if self.cell.phase in "AB" else "A" if self.cell.phase == "pegged" else "C"
        words = ["--conditions", condition, "--identify-seconds", 5, "--trial-seconds", TRIAL_S, "--seed", 2,
                 "--config", self.config]
        if self.cell.phase in ("C+", "fading"):
            model = self.folder / "control_model.json"
            model.write_text(json.dumps(control_model()))
            words += ["--model", model]
        # With real-time priority a thread that spins would take its processor from every other session.
        return words + (["--no-real-time"] if "busy" in self.cell.kinds else [])

    def lab(self, out, *more):
        return LabProcess(out, *self.words(), *more, domain=self.domain,
                          environment=dict(os.environ, LD_PRELOAD=str(BUSY)))

    def reach(self, lab, what, condition):
        lab.wait_for(what, condition, START_LIMIT_S, poll_s=0.01)

    # -- until the moment of the fault --------------------------------------------------------------------------------

    def await_phase(self, lab, probe):
        """Returns at a random moment of the phase."""
        phase = self.cell.phase

        def trial(number):
            return probe.control["trial"] == number and probe.control["state"] == "running"

        def reach(what, condition):
            self.reach(lab, what, condition)

        if phase == "pause":
            reach("the pegged trial", lambda: trial(0))
            probe.ask("pause")
            reach("the pause", lambda: probe.control["state"] == "paused")
            hold(self.rng.uniform(0.0, 0.5))
            return
        number = 0 if phase == "pegged" else 1
        reach(f"trial {number}", lambda: trial(number))
        start, ramp = probe.control["start"], probe.control["ramp"]
        if phase == "fading":  # the models settle and fade in while the trial prepares and its ramp begins
            tick = start - ramp - TICKS_PER_S + self.rng.randrange(1500)
        elif phase == "ramp":
            tick = start - self.rng.randrange(ramp)
        else:
            tick = start + 300 + self.rng.randrange((TRIAL_S - 1) * TICKS_PER_S)
        reach(f"tick {tick}", lambda: probe.tick >= tick)

    # -- after it -----------------------------------------------------------------------------------------------------

    def aftermath(self, lab, probe):
        """Sees the session end; a person does what the lab cannot do for itself. Returns its exit status."""
        hit_lab = self.cell.hits("experiment", "stop", "busy")
        if self.cell.phase == "pause":
            hold(PAUSE_S, lambda: lab.process.poll() is not None)
            if lab.process.poll() is None and not hit_lab:
                probe.ask("start")
        if hit_lab:
            hold(PERSON_S)
            if self.cell.hits("experiment", "stop"):
                os.kill(lab.process.pid, signal.SIGCONT)
                if self.cell.phase == "pause":
                    hold(0.5)
                    probe.ask("start")
            else:
                lab.process.kill()
        ended = wait_for("end of the lab", lambda: lab.process.poll() is not None, END_LIMIT_S, failure=None)
        if not ended:
            self.findings.append(f"the lab did not end within {END_LIMIT_S:g} s")
            return None
        return lab.process.returncode

    def judge_end(self, lab, status, again):
        """Exit status, the trial's mark, processes left."""
        left = wait_for("end of the processes", lambda: not set(running(self.domain)) - again, LEFT_LIMIT_S,
                        failure=None)
        lab_killed = self.cell.hits("experiment", "kill", "restart", "busy")
        # A process that is stopped, or spins, cannot follow the end of its parent.
        stuck = any(kind in ("stop", "busy") for victim, kind in zip(self.cell.victims, self.cell.kinds)
                    if victim != "experiment")
        if not left and not (lab_killed and stuck):
            names = sorted(name for pid, name in running(self.domain).items() if pid not in again)
            self.findings.append(f"processes left: {', '.join(names)}")
        if lab_killed:
            self.result["outcome"] = "lab killed"
            return
        summary = self.out / "summary.json"
        trials = json.loads(summary.read_text())["trials"] if summary.is_file() else []
        why = trials[-1].get("aborted") or "" if trials else " ".join(lab.errors()[-1:])
        self.result["why"] = why
        if status == 0:
            self.result["outcome"] = "survived"
        elif any(victim in why for victim in self.cell.victims):
            self.result["outcome"] = "ended, named"
        else:
            self.result["outcome"] = "ended, not named"
            self.findings.append(f"exit status {status}, and no victim is named: {why!r}, {lab.errors()[-1:]}")
        # In a pause the experiment has nothing to do: after a person woke it up the session goes on.
        woken = self.cell.phase == "pause" and self.cell.victims == ("experiment",) and self.cell.kinds == ("stop",)
        if self.cell.fatal and status == 0 and not woken:
            self.findings.append("the session went on to its end without its process")
        if not trials:
            self.findings.append("no summary")

    def judge_recording(self, lab, struck_ns):
        recording = lab.recording(10**9)
        rig = recording["rig"]
        if not rig["tick"]:
            self.findings.append(f"the recording cannot be read: {recording['damage']}")
            return
        self.findings += [f"recording: {line}" for line in rig_findings(rig)]
        self.result["recording"] = figures(rig, struck_ns)
        if recording["damage"] and not self.cell.hits("recorder", *FATAL):
            self.findings.append(f"recording: {recording['damage'][0]}")

    def judge_probe(self, rig, struck_ns):
        self.findings += [f"probe: {line}" for line in rig_findings(rig)]
        self.result["probe"] = seen = figures(rig, struck_ns)
        self.judge_rest(seen)
        late_ms = seen["noticed_ms"]
        if self.cell.fatal and late_ms and late_ms > LATE_LIMIT_MS and self.cell.phase in ("C", "C+") \
                and not self.cell.hits("experiment", "busy"):
            self.findings.append(f"commands were used for {late_ms:g} ms after the fault")

    def judge_rest(self, seen):
        """A rig that was asked to end ends without force and at rest. Either source may lack the last few samples."""
        if self.cell.hits("rig", *FATAL) or not seen["samples"]:
            return
        sources = [seen, self.result.get("recording", seen)]
        force, speed = (min(abs(source[name]) for source in sources) for name in ("last_force_n", "last_speed_m_s"))
        if force > 0.0:
            self.findings.append(f"the rig ended with {force:g} N")
        if speed > REST_M_S:
            self.findings.append(f"the rig ended with {speed:g} m/s")

    def __call__(self):
        shutil.rmtree(self.folder, ignore_errors=True)  # of a run that a campaign was ended in
        self.folder.mkdir(parents=True)
        probe = Probe(self.domain, self.folder / "probe.txt")
        lab = self.lab(self.out)
        faults = []
        struck_ns = None
        started = False
        try:
            self.reach(lab, "the pegged trial", lambda: probe.control["trial"] == 0)
            started = True
            self.await_phase(lab, probe)
            for victim, kind in zip(self.cell.victims, self.cell.kinds):
                pid = lab.process.pid if victim == "experiment" else lab.pid_of(victim)
                faults.append(Fault(kind, pid, victim, self.folder))
            struck_ns = time.monotonic_ns()
            for i, fault in enumerate(faults):
                if i > 0:
                    hold(self.rng.uniform(0.0, 0.3))
                fault.strike()
            status = self.aftermath(lab, probe)
            self.judge_end(lab, status, {fault.again.pid for fault in faults if fault.again})
            self.judge_recording(lab, struck_ns)
        except Exception as error:
            when = "before" if struck_ns is None else "after"
            self.findings.append(f"{when} the fault: {type(error).__name__}: {error}")
        finally:
            for fault in faults:
                fault.end()
            (self.folder / "errors.txt").write_text("\n".join(lab.errors()))
            lab.close()
            probe.close()
        if struck_ns is not None:
            self.judge_probe(probe.samples(), struck_ns)
        self.result |= {"findings": self.findings, "struck": struck_ns is not None, "started": started}
        if not self.findings:
            shutil.rmtree(self.folder)
        return self.result
