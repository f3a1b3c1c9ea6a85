# SPDX-License-Identifier: Apache-2.0
"""`stillhand lab --security`: a session of processes with keys, next to a stranger that has none (stranger.cpp).

The stranger receives nothing and nobody hears it. Keys with a fault are refused before anything starts. With
`--campaign` the results are compared with those of a session without keys, on one machine and over three (network.py).
"""
import math
import os
import subprocess

import lab_process
import network
from lab_process import BUILD, END_LIMIT_S, SOURCE, STRANGER, LabTestCase, campaign, next_domain

MAKE = SOURCE / "deploy" / "security" / "make.sh"
SESSION_LIMIT_S = 150
WORDS = ["--conditions", "C", "--identify-seconds", 10, "--trial-seconds", 15, "--seed", 2]
# A secured session takes nearly all of two cores. One that falls behind ends by the interlock, as it should, and is
# tried again. Alone on two cores seven of seven sessions were completed (deploy/security/README.md), so that a single
# session fails in less than 35 % of the cases (at 95 % confidence): the second try hides a failure rate up to that.
TRIES = 2
LATE = ("a process is missing|no commands of motion|motion and cancellation are silent|"
        "ticks of the pegged trial were lost")
# A machine whose processors have no rest during the last try is too slow for the session: skipped. One that is late with
# processors at rest fails. Late sessions had 89 to 95 % busy, a completed one 93 % (2026-11-26).
NO_REST = 0.85
# Lost ticks cost cancellation, with keys or without. Nine completed sessions on two cores, idle and next to busy
# processes: a share of 0.69 to 0.71 with 180 to 500 ticks lost, 0.60 with 960, 0.57 with 2,280. So a slow machine passes,
# a motor that does nothing (a share of 0) fails; lab_session_test.py asks for the share itself.
LEAST_CANCELLED_SHARE = 0.5
MOST_LOST_TICKS = 400  # of 175,000, in a session that is compared with another one


def make_keys(folder, *options):
    subprocess.run([str(MAKE), str(folder), *options], check=True, capture_output=True,
                   env={**os.environ, "STILLHAND_BUILD": str(BUILD)})
    return folder


class SecuredSessionTest(LabTestCase):
    def setUp(self):
        super().setUp()
        self.keys = make_keys(self.folder / "keys")

    def why_late(self, lab, most_lost_ticks):
        """Why an ended session is tried again, or "" for one that was completed in time; fails for any other end."""
        if lab.end_status() == 0:
            lost = sum(lab.summary()["lost_ticks"].values())
            return f"{lost} ticks lost, at most {most_lost_ticks} are allowed" if lost > most_lost_ticks else ""
        # The sample clock starts when every endpoint has matched. With ticks in the recording, the session was late;
        # without, its processes did not authenticate each other.
        self.assertNotEqual(lab.recording(1)["rig"]["tick"], [], lab.errors())
        self.assertRegex(" ".join(lab.errors()), LATE)
        return " ".join(lab.errors())

    def completed(self, name, one_session, most_lost_ticks=MOST_LOST_TICKS):
        """Results of the first session that is completed in time, and what else one_session(name of it) returns."""
        for attempt in range(1, TRIES + 1):
            processors = lab_process.ProcessorTime()
            lab, more = one_session(f"{name}{attempt}")
            busy = processors.busy_share()
            late = self.why_late(lab, most_lost_ticks)
            print(f"{name}, try {attempt} of {TRIES}: processors busy {100 * busy:.0f} %; {late or 'in time'}", flush=True)
            if not late:
                break
        if late and busy > NO_REST:
            self.skipTest(f"{name}: this machine is too slow for it: {late}; processors busy {100 * busy:.0f} %")
        self.assertEqual(late, "", f"{name}: none of {TRIES} sessions was in time")
        self.assertEqual(lab.recording(1)["damage"], [])
        result = lab.summary()["conditions"]["C"]
        found = result["rms_error_mm"]["mean"], result["cancelled_share"]
        print(f"{name}: {more}, RMS error {found[0]:.3f} mm, cancelled {found[1]:.4f}, ticks lost",
              lab.summary()["lost_ticks"], flush=True)
        return found, more

    def next_to_a_stranger(self, name, stranger_does, *words, **limit):
        """A whole session's results; how much a stranger next to it received, and how many readers it had.

        With keys, a stranger next to a session that is late receives nothing and has no reader either.
        """
        def one_session(each):
            domain = next_domain()
            stranger = self.stranger(domain, stranger_does)
            lab = self.lab(*WORDS, *words, domain=domain, out=self.folder / each)
            lab.end_status(SESSION_LIMIT_S)
            received, heard_by = self.heard(stranger)
            if "--security" in words:
                self.assertEqual((received, heard_by), (0, 0), each)
            return lab, received
        return self.completed(name, one_session, **limit)

    def over_three_machines(self, lab_network, out):
        domain = next_domain()
        lab = self.lab(*WORDS, domain=domain, out=self.folder / out, start=lab_network[network.HERE].words(),
                       inventory=lab_network.inventory(domain, keys=self.keys))
        lab.end_status(SESSION_LIMIT_S)
        return lab

    def assert_same(self, found, plain):
        # From session to session the simulated subject receives a tick a little sooner or later.
        self.assertAlmostEqual(found[0], plain[0], delta=0.1 * plain[0])
        self.assertAlmostEqual(found[1], plain[1], delta=0.08)

    def test_a_stranger_hears_and_moves_nothing(self):
        (_, share), _ = self.next_to_a_stranger("secured", "writes", "--security", self.keys, most_lost_ticks=math.inf)
        self.assertGreater(share, LEAST_CANCELLED_SHARE)

    @campaign
    def test_the_results_are_those_without_keys(self):
        # Without keys the same program receives: the keys are the reason that it receives nothing with them.
        plain, received = self.next_to_a_stranger("plain", "reads")
        self.assertGreater(received, 20_000)
        secured, _ = self.next_to_a_stranger("secured", "writes", "--security", self.keys)
        self.assert_same(secured, plain)
        with self.subTest("over three machines, each with the keys of its own services"):
            if reason := network.why_not():
                self.skipTest(reason)
            self.assert_same(self.with_keys_over_three_machines(), plain)

    def with_keys_over_three_machines(self):
        lab_network = network.Network(os.getpid())
        self.addCleanup(lab_network.close)
        first, second = (machine for machine in lab_network.machines.values() if machine.name != network.HERE)
        first.give_keys(self.keys)
        self.assert_refusal(self.over_three_machines(lab_network, "refused"), second.name, network.KEYS_THERE)
        second.give_keys(self.keys)
        found, _ = self.completed("secured over three machines",
                                  lambda each: (self.over_three_machines(lab_network, each), ""))
        return found

    def assert_refused(self, *words, **keywords):
        self.assert_refusal(self.lab(*WORDS, "--security", self.keys, **keywords), *words)

    def assert_refusal(self, lab, *words):
        self.assertEqual(lab.end_status(END_LIMIT_S), 2, lab.errors())
        self.assertEqual(len(lab.errors()), 1, lab.errors())
        for word in words:
            self.assertIn(str(word), lab.errors()[0])
        self.assertFalse(lab.out.exists(), "results of a session that did not take place")

    def test_a_missing_key_is_refused(self):
        (self.keys / "display" / "key.pem").unlink()
        self.assert_refused(self.keys / "display" / "key.pem", "make.sh")


if __name__ == "__main__":
    lab_process.main(STRANGER)
