#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""deploy/python/stillhand.py: its examples run on a live session's recording (fixture lab_run); its numbers are the verbs'."""
import doctest
import os
import pathlib
import sys
import unittest

import numpy

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("STILLHAND_BUILD", SOURCE / "build"))
RECORDING = pathlib.Path(os.environ.get("STILLHAND_RECORDING", BUILD / "tests" / "lab_run" / "session.mcap"))
os.environ["STILLHAND_PROGRAM"] = str(BUILD / "bin" / "stillhand")
sys.path.insert(0, str(SOURCE / "deploy" / "python"))

import stillhand  # noqa: E402


class PythonTest(unittest.TestCase):
    def test_the_examples_give_what_they_show(self):
        found = doctest.testmod(stillhand, extraglobs={"RECORDING": str(RECORDING), "numpy": numpy})
        self.assertGreater(found.attempted, 8)
        self.assertEqual(found.failed, 0)

    def test_a_table_has_every_message_of_its_topic(self):
        read = stillhand.tables(RECORDING, "stillhand/sensed", "stillhand/event")
        counts = {topic["topic"]: topic["messages"] for topic in stillhand.verb("info", RECORDING)["topics"]}
        self.assertEqual({topic: len(table["t"]) for topic, table in read.items()},
                         {topic: counts[topic] for topic in ("stillhand/sensed", "stillhand/event")})
        self.assertEqual(read["stillhand/sensed"]["tick"].dtype, float)
        self.assertIn("", read["stillhand/event"]["peer"])

    def test_a_response_is_the_verb_s(self):
        found = stillhand.verb("identify", RECORDING)
        theirs = found["frequency_response"]
        ours = stillhand.frequency_response(found["model"], [point["frequency_hz"] for point in theirs])
        numpy.testing.assert_allclose(20 * numpy.log10(abs(ours)), [point["magnitude_db"] for point in theirs], atol=1e-9)

    def test_an_option_is_a_word(self):
        self.assertEqual(stillhand.verb("identify", RECORDING, order=2, refine=True)["order"], 2)
        with self.assertRaises(stillhand.StillhandError) as refused:
            stillhand.verb("identify", RECORDING, order=99)
        self.assertEqual(refused.exception.status, 2)
        self.assertIn("99", str(refused.exception))


if __name__ == "__main__":
    unittest.main()
