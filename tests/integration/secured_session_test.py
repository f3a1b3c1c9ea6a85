# SPDX-License-Identifier: Apache-2.0
"""`stillhand lab --security`: a session of processes with keys, and a stranger beside it that has none (stranger.cpp).

It receives nothing and nobody hears it, the results are those of a session without keys, on one machine and over three
(network.py); keys with a fault are refused before anything starts.
"""
import os
import re
import shutil
import subprocess

import lab_process
import network
from lab_process import BUILD, END_LIMIT_S, SOURCE, LabTestCase, next_domain

MAKE = SOURCE / "deploy" / "security" / "make.sh"
STRANGER = BUILD / "tests" / "stranger"
SESSION_LIMIT_S = 150
WORDS = ["--conditions", "C", "--identify-seconds", 10, "--trial-seconds", 15, "--seed", 2]
TRIES = 3  # a secured session takes nearly all of two cores, and one that comes to be late ends as it should


def make_keys(folder, *options):
    subprocess.run([str(MAKE), str(folder), *options], check=True, capture_output=True,
                   env={**os.environ, "STILLHAND_BUILD": str(BUILD)})
    return folder


class KeysCase(LabTestCase):
    def setUp(self):
        super().setUp()
        self.keys = make_keys(self.folder / "keys")

    def completed(self, name, one_session):
        """The lab, and what else one_session(name of it) gives, of the first session that comes to its end."""
        for left in range(TRIES - 1, -1, -1):
            lab, told = one_session(f"{name}{left}")
            if lab.end_status() == 0:
                break
            self.assertIn("a process is missing", " ".join(lab.errors()))
            print(name, "once more:", lab.errors()[-1], flush=True)
        self.assertEqual(lab.end_status(), 0, lab.errors())
        print(name, told, f"ticks lost {lab.summary()['lost_ticks']}", flush=True)
        return lab, told

    def assert_same_results(self, plain, secured):
        errors_mm, shares = [], []
        for lab in (plain, secured):
            result = lab.summary()["conditions"]["C"]
            errors_mm.append(result["rms_error_mm"]["mean"])
            shares.append(result["cancelled_share"])
            self.assertEqual(lab.recording(1)["damage"], [])
        print(f"RMS error {errors_mm[0]:.3f} and {errors_mm[1]:.3f} mm, cancelled {shares[0]:.4f} and {shares[1]:.4f}",
              flush=True)
        # The simulated subject hears of a tick a little later or earlier, as from session to session.
        self.assertAlmostEqual(errors_mm[0], errors_mm[1], delta=0.05 * errors_mm[0])
        self.assertAlmostEqual(shares[0], shares[1], delta=0.02)


class SecuredSessionTest(KeysCase):
    def session(self, name, stranger_does, *words):
        """A whole session with a stranger beside it; what it received, and how many readers it had."""
        return self.completed(name, lambda each: self.one_session(each, stranger_does, *words))

    def one_session(self, name, stranger_does, *words):
        domain = next_domain()
        stranger = subprocess.Popen([str(STRANGER), str(domain), stranger_does], stdout=subprocess.PIPE, text=True)
        self.addCleanup(stranger.stdout.close)
        self.addCleanup(stranger.wait)
        self.addCleanup(stranger.kill)
        lab = self.lab(*WORDS, *words, domain=domain, out=self.folder / name)
        lab.end_status(SESSION_LIMIT_S)
        stranger.terminate()
        return lab, [int(number) for number in re.findall(r"\d+", stranger.stdout.read())]

    def test_a_stranger_hears_and_moves_nothing_and_the_results_are_those_without_keys(self):
        # That its silence is the keys' doing: without them the same program hears.
        plain, (received, _) = self.session("plain", "reads")
        self.assertGreater(received, 20_000)
        secured, (received, heard_by) = self.session("secured", "writes", "--security", self.keys)
        self.assertEqual((received, heard_by), (0, 0))
        self.assert_same_results(plain, secured)

    def assert_refused(self, *words, **keywords):
        lab = self.lab(*WORDS, "--security", self.keys, **keywords)
        self.assertEqual(lab.end_status(END_LIMIT_S), 2, lab.errors())
        self.assertEqual(len(lab.errors()), 1, lab.errors())
        for word in words:
            self.assertIn(str(word), lab.errors()[0])
        self.assertFalse(lab.out.exists(), "results of a session that never was")

    def test_a_missing_key_is_refused(self):
        (self.keys / "display" / "key.pem").unlink()
        self.assert_refused(self.keys / "display" / "key.pem", "make.sh")

    def test_a_folder_that_is_not_there_is_refused(self):
        shutil.rmtree(self.keys)
        self.assert_refused(self.keys / "authority.pem", "make.sh")

    def test_an_expired_certificate_is_refused(self):
        request = self.folder / "request.pem"
        rig = self.keys / "rig"
        for words in (["-in", rig / "certificate.pem", "-x509toreq", "-signkey", rig / "key.pem", "-out", request],
                      ["-req", "-in", request, "-days", "-1", "-CA", self.keys / "authority.pem", "-CAkey",
                       self.keys / "authority_key.pem", "-set_serial", "7", "-out", rig / "certificate.pem"]):
            subprocess.run(["openssl", "x509", *map(str, words)], check=True, capture_output=True)
        self.assert_refused(rig / "certificate.pem", "expired on")

    def test_another_authority_s_certificate_is_refused(self):
        other = make_keys(self.folder / "other")
        shutil.copy(other / "motion" / "certificate.pem", self.keys / "motion" / "certificate.pem")
        self.assert_refused(self.keys / "motion" / "certificate.pem", "authority.pem")

    def test_a_key_that_everybody_may_read_is_refused(self):
        (self.keys / "experiment" / "key.pem").chmod(0o644)
        self.assert_refused(self.keys / "experiment" / "key.pem", "chmod o=")

    def test_keys_of_another_domain_are_refused(self):
        self.keys = make_keys(self.folder / "domain-7", "--domain", "7")
        self.assert_refused("domain: got 8, want 7 to 7", domain=8)


class SecuredMachinesTest(KeysCase):
    def setUp(self):
        super().setUp()
        if reason := network.why_not():
            self.skipTest(reason)
        self.network = network.Network(os.getpid())
        self.addCleanup(self.network.close)

    def across(self, name, keys):
        domain = next_domain()
        lab = self.lab(*WORDS, domain=domain, out=self.folder / name, start=self.network[network.HERE].words(),
                       inventory=self.network.inventory(domain, keys=keys))
        lab.end_status(SESSION_LIMIT_S)
        return lab

    def test_a_session_over_three_machines_each_with_its_own_keys_gives_what_it_gives_without(self):
        remote = [machine for machine in self.network.machines.values() if machine.name != network.HERE]
        remote[0].give_keys(self.keys)
        lab = self.across("refused", self.keys)
        self.assertEqual(lab.end_status(), 2, lab.errors())
        self.assertEqual(len(lab.errors()), 1, lab.errors())
        for word in (remote[1].name, network.KEYS_THERE):
            self.assertIn(word, lab.errors()[0])
        remote[1].give_keys(self.keys)
        secured, _ = self.completed("secured", lambda each: (self.across(each, self.keys), "over three machines"))
        plain, _ = self.completed("plain", lambda each: (self.across(each, None), "over three machines"))
        self.assert_same_results(plain, secured)


if __name__ == "__main__":
    lab_process.main()
