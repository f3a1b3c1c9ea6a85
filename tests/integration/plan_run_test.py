# SPDX-License-Identifier: Apache-2.0
"""From a tie to a planned run, over the bus: plan-run, lab --plan, diagnose --plan."""
import json
import math
import random

import lab_process
from lab_process import TICKS_PER_S, LabTestCase

SECONDS = 5
SESSION_LIMIT_S = 90.0
RATE_HZ = 1000  # as a session has it: recordings of one verdict share a rate
TIED = ("coupled_input (of a_x, static)", "coupled_input (of a_z, static)")


def tones(seed):
    """Ten sines of 0.5 to 4 Hz with phases of that seed, as a function of time."""
    draw = random.Random(seed)
    lines = [(0.5 + 3.5 * draw.random(), 2.0 * math.pi * draw.random()) for _ in range(10)]
    return lambda t: sum(math.sin(2.0 * math.pi * hz * t + phase) for hz, phase in lines)


def tied_recording(file):
    """a_z follows a_x, so a force of either is one of the other."""
    motion, sideways, noise = tones(1), tones(2), random.Random(3)
    # The channels of a session's pegged trial. The stick stands still: some sessions leave its angle or its rate out.
    lines = ["t [s],a_x [m/s^2],a_y [m/s^2],a_z [m/s^2],roll [rad],theta [rad],omega [rad/s],f [N],f_motor [N]"]
    force = 0.0
    for n in range(40 * RATE_HZ):
        t = n / RATE_HZ
        a_x, a_y = 0.4 * sideways(t), 0.5 * motion(t)
        force += (2.0 * a_y - force) / (0.05 * RATE_HZ)  # a lag of 0.05 s
        lines.append(f"{t:.3f},{a_x:.6f},{a_y:.6f},{0.3 * a_x:.8f},0,0,0,{force + a_x + noise.gauss(0.0, 0.2):.6f},0")
    file.write_text("\n".join(lines) + "\n")


class PlanRunTest(LabTestCase):
    def test_a_tie_is_planned_and_run_and_another_body_breaks_nothing(self):
        recorded, plan = self.folder / "tied.csv", self.folder / "next" / "plan.json"
        tied_recording(recorded)
        said = self.run_verb("plan-run", recorded, "--seconds", SECONDS, "--out", plan.parent).stdout
        planned = json.loads(plan.read_text())
        # Other laws of one of the two may be tied with them.
        names = [f"{each['kind']} (of {each['channel']}, {each['form']})" for each in planned["candidates"]]
        self.assertLessEqual(set(TIED), set(names))
        # Both move as they do whatever the platform does.
        self.assertLess(planned["probability_settled"], 0.02)
        self.assertIn("a second axis", said)

        lab = self.lab("--plan", plan)
        self.assertEqual(lab.end_status(SESSION_LIMIT_S), 0, lab.errors())
        trial, = lab.recording(1)["trials"]
        self.assertEqual(trial["duration_ticks"], SECONDS * TICKS_PER_S)
        self.assertEqual(len(lab.measured_signals(0)["command"]), SECONDS * TICKS_PER_S)
        asked = lab.summary()["trials"][0]["motion"]
        self.assertEqual(asked["kind"], "ride")
        self.assertAlmostEqual(asked["peak_m_s2"], planned["motion"]["peak_m_s2"], places=6)

        # The rig's body is not that of the tied recording, so neither candidate explains the run: such a run breaks no
        # tie (tests/unit/next_run has those that do).
        self.refused_for("no candidate explains half", "diagnose", recorded, lab.out / "session.mcap", "--plan", plan)
        self.assert_nothing_left(lab)
        self.planned_with_a_participant(plan)

    def planned_with_a_participant(self, plan):
        study = self.folder / "study"
        self.run_verb("experiment", "new", study, "--participants", 1)
        self.run_verb("experiment", "exclude", study, "--participant", "P01", "--reason", "to have a journal")
        journal = study / "participants" / "P01" / "journal.jsonl"
        words = ("experiment", "run", study, "--participant", "P01", "--plan", plan, "--headless", "--domain",
                 lab_process.next_domain())
        self.refused_for("excluded: to have a journal", *words)
        journal.write_text("")
        self.run_verb(*words)
        self.assertEqual([json.loads(line)["what"] for line in journal.read_text().splitlines()], ["note"])
        info = self.info(study / "participants" / "P01" / "planned" / "01" / "session.mcap")
        self.assertIn('"planned 01"', json.dumps(info["metadata"]))
        self.assertIn("not begun", self.run_verb("experiment", "status", study).stdout)


if __name__ == "__main__":
    lab_process.main()
