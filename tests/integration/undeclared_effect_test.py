# SPDX-License-Identifier: Apache-2.0
"""An effect that only the rig knows: which programs hold it, what a recording shows of it, how the truth is opened.

No other service holds its code, and only the rig and the programs that step the rig in one process include it. No process
of a session is given the seed where others can read it. A session's recording has the same shape with the effect as
without (the recording of ctest's fixture lab_run).
"""
import hashlib
import json
import pathlib
import re
import subprocess

import lab_process
from lab_process import BUILD, SERVICES, SOURCE, LabTestCase, loose_settings, running

# Long enough not to come up by chance in a file; its effect acts on the pegged stick already.
SEED = 90417733560021
KINDS = ("nonlinear_stiffness", "asymmetry", "dead_zone", "time_varying_gain", "resonance", "position_ripple",
         "coulomb_friction", "coupled_input", "tone", "delay", "output_saturation")
SECRET = re.compile(r"stillhand::rig::(UndeclaredEffect|SealedEffect|EffectOnChain|draw_effect|draw_outside|EffectPlan)")
SEALED_HEADERS = re.compile(r'#include "services/(core/rig/(undeclared/\w+|parts/chain_effect)|files/rig/sealed_file)'
                            r'\.hpp"')
# The programs that step the rig in one process, and those that write the sealed file.
MAY_INCLUDE = ("services/core/rig/", "services/files/rig/", "services/processes/rig/", "apps/libraries/session/",
               "apps/lab/", "apps/study/", "apps/close_the_loop/session/session.",
               "apps/close_the_loop/closed_loop_command.", "apps/close_the_loop/output.", "tests/")
RECORDED_WITHOUT = BUILD / "tests" / "lab_run" / "session.mcap"  # ctest's fixture lab_run
SESSION_LIMIT_S = 120


def shape(value):
    """Names and types of a JSON value, not its contents."""
    if isinstance(value, dict):
        return {key: shape(each) for key, each in value.items()}
    if isinstance(value, list):
        return [shape(each) for each in value[:1]]
    return type(value).__name__


class UndeclaredEffectTest(LabTestCase):
    def symbols(self, program):
        listed = subprocess.run(["nm", "-C", str(BUILD / "bin" / program)], capture_output=True, text=True, check=True)
        return SECRET.search(listed.stdout)

    def test_of_all_services_the_rig_alone_holds_the_code(self):
        self.assertTrue(self.symbols("stillhand-rig"), "the search finds nothing where there is something")
        for service in SERVICES:
            if service != "rig":
                self.assertIsNone(self.symbols(f"stillhand-{service}"), service)

    def test_no_other_source_includes_it(self):
        found = []
        for folder in ("services", "apps", "tests"):
            for path in (SOURCE / folder).rglob("*.[ch]pp"):
                if SEALED_HEADERS.search(path.read_text()):
                    found.append(str(path.relative_to(SOURCE)))
        self.assertIn("services/core/rig/rig.hpp", found)
        self.assertEqual([path for path in found if not path.startswith(MAY_INCLUDE)], [])

    def sealed_session(self):
        """A session with the effect; and where its seed could be read meanwhile, {program: file in /proc}."""
        lab = self.lab("--conditions", "B", "--identify-seconds", 5, "--trial-seconds", 5, "--seed", 3, "--config",
                       loose_settings(self.folder / "config"), "--undeclared-effect", SEED, out=self.folder / "sealed")
        told = {}

        def over():
            # The name first: a process that has just been forked still has the lab's own command line.
            for pid, name in running(lab.domain).items():
                for listing in ("cmdline", "environ"):
                    try:
                        if str(SEED).encode() in pathlib.Path(f"/proc/{pid}/{listing}").read_bytes():
                            told[name] = listing
                    except OSError:  # it ended meanwhile
                        pass
            if (lab.out / "undeclared_effect.json").exists():
                self.assertTrue((lab.out / "summary.json").exists(), "the truth came before the results")
            return lab.process.poll() is not None
        lab.wait_for("the end", over, SESSION_LIMIT_S, poll_s=0.2)
        self.assertEqual(lab.process.returncode, 0, lab.errors())
        return lab, told

    def test_a_recording_does_not_reveal_it_and_the_truth_is_the_committed_one(self):
        sealed, told = self.sealed_session()

        # The lab's own command line is the person's.
        self.assertLessEqual(set(told), {"stillhand"})

        # Same topics, schemas and metadata.
        info = self.info(sealed.out / "session.mcap")
        self.assertEqual(shape(self.info(RECORDED_WITHOUT)), shape(info))
        csv = self.folder / "csv"
        self.run_verb("export", sealed.out / "session.mcap", "--csv", csv)
        texts = [path.read_text() for path in csv.rglob("*.csv")] + [json.dumps(info)]
        texts += [path.read_text() for path in (sealed.out / "logs").iterdir()]
        texts += [(sealed.out / name).read_text() for name in ("summary.json", "model.json")]
        for text in texts:
            self.assertNotIn(str(SEED), text)
            for kind in KINDS:
                self.assertNotIn(kind, text)

        # Opened at the end, and what was sealed at the start.
        truth = json.loads((sealed.out / "undeclared_effect.json").read_text())
        self.assertEqual(truth["seed"], SEED)
        self.assertIn(truth["kind"], KINDS + ("none",))
        self.assert_sealed(sealed.out)
        self.assertEqual(len((sealed.out / "undeclared_effect.sha256").read_text().splitlines()), 2)
        # Another truth would not pass.
        other = (sealed.out / "undeclared_effect.json").read_bytes().replace(b'"kind": "', b'"kind": "x')
        self.assertNotIn(hashlib.sha256(other).hexdigest(), (sealed.out / "undeclared_effect.sha256").read_text())
        self.assertFalse((RECORDED_WITHOUT.parent / "undeclared_effect.sha256").exists())
        self.assert_nothing_left(sealed)


if __name__ == "__main__":
    lab_process.main(RECORDED_WITHOUT)
