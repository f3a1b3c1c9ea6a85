#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A person takes part in an experiment: the tracking screen in an X server shows instructions, countdown, break,
questions and the end, and takes answers from real keys and clicks. STILLHAND_SCREENSHOTS=FOLDER keeps pictures.

The test knows from the journal and the recording what the screen has to show, and waits until its pixels change.
"""
import json
import os
import pathlib
import re
import signal
import struct
import subprocess
import tempfile

import browser
import lab_process
from dashboard_test import Dashboard
from experiment_test import END_LIMIT_S, ExperimentTestCase, experiment, journal, of_kind
from lab_process import STILLHAND, campaign, hold, next_domain, running, wait_for
from verb_case import rows
from virtual_display import VirtualDisplay, missing_tools

TITLE = "Stillhand"
WINDOW = (1024, 768)  # services/processes/display/screen_loop.cpp
WINDOW_LIMIT_S = 60.0
STEP_LIMIT_S = 60.0
WHITE = bytes(level > 200 for level in range(256))
READS_S = 0.7  # a person reads before acting
QUESTIONS = """questions:
  - name: "effort"
    after: "trial"
    text: "How hard was it to keep the cross in the box?"
    lowest: "not at all"
    highest: "as hard as can be"
    steps: 7
  - name: "sick"
    after: "end"
    text: "How do you feel now? Müde, à l'aise, zmęczony?"
    lowest: "well"
    highest: "sick"
    steps: 9
"""


class Participant:
    """The window of an experiment, its keys and its mouse."""

    def __init__(self, display):
        self.display = display

    def wait_for_window(self, ended):
        def sized():
            window = self.display.window(TITLE)
            return window if window and self.display.geometry(window)[2:] == WINDOW else None
        window = wait_for("the tracking window", sized, WINDOW_LIMIT_S, ended=ended)
        self.display.xdotool("mousemove", WINDOW[0] // 2, 20)
        self.display.xdotool("windowfocus", "--sync", window)

    def light(self):
        """Sum of the brightness of the picture."""
        return sum(map(sum, self.display.picture(*WINDOW)))

    def press(self, key):
        self.display.xdotool("key", "--clearmodifiers", key)

    def click(self, column, row):
        self.display.xdotool("mousemove", column, row)
        self.display.xdotool("click", 1)

    def white(self):
        """Row by row, 1 for each white pixel and 0 for each other."""
        return [row.translate(WHITE) for row in self.display.picture(*WINDOW)]

    def button_row(self):
        """A row of a button that works, or None: it is white over its width, for more rows than a line is thick."""
        middle = slice(WINDOW[0] // 2 - 30, WINDOW[0] // 2 + 30)
        wide = [all(row[middle]) for row in self.white()]
        return next((row + 4 for row in range(len(wide) - 8) if all(wide[row:row + 8])), None)

    def boxes(self):
        """Left edges of the boxes of a scale, and a row in them, or None.

        The upper sides of the boxes are white lines of one length in one row, and a white line hangs from the left end
        of each: no text has that.
        """
        white = self.white()
        for row, pixels in enumerate(white[:-40]):
            runs = [(match.start(), len(match[0])) for match in re.finditer(rb"\x01+", pixels)]
            lengths = [length for _, length in runs]
            if (len(runs) >= 2 and 50 <= min(lengths) and max(lengths) <= min(min(lengths) + 4, 90) and
                    all(white[row + down][start + 1] for start, _ in runs for down in range(40))):
                return [start for start, _ in runs], row + 20
        return None


class Gamepad:
    """Linux's evdev events in a named pipe, which stands for a device."""
    SOUTH, HAT0X = (1, 0x130), (3, 0x10)

    def __init__(self, path):
        os.mkfifo(path)
        self.path, self.pipe = path, os.open(path, os.O_RDWR)
        self.put(3, 0, 0)  # the stick in the middle

    def put(self, kind, code, value):
        os.write(self.pipe, struct.pack("llHHi", 0, 0, kind, code, value))

    def press(self, button, value=1):
        self.put(*button, value)
        self.put(*button, 0)

    def close(self):
        os.close(self.pipe)


class ParticipantTestCase(ExperimentTestCase):
    pad = None

    def setUp(self):
        super().setUp()
        self.display = VirtualDisplay()
        self.addCleanup(self.display.close)
        self.person = Participant(self.display)
        self.file = self.study / "participants" / "P01" / "journal.jsonl"

    def make(self, questions, *words, **values):
        if self.pad is None:
            words = (*words, "--operator", "mouse")
        else:
            words = (*words, "--operator", "gamepad")
        self.new(*words, "--participants", 1)
        self.edit(**{"rest_s": 0, "order": "latin", **values})
        file = self.study / "experiment.yaml"
        file.write_text(re.sub(r"questions: \[\]\n", questions, file.read_text()))

    def begin(self):
        domain = next_domain()
        process = subprocess.Popen([str(STILLHAND), "experiment", "run", str(self.study), "--domain", str(domain),
                                    "--config", str(self.settings), "--match-seconds", str(WINDOW_LIMIT_S),
                                    *(["--gamepad", str(self.pad.path)] if self.pad else [])],
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env=self.display.environment, start_new_session=True)

        def end():
            if process.poll() is None:
                process.kill()
            process.communicate()
        self.addCleanup(end)
        self.process, self.domain = process, domain
        self.person.wait_for_window(self.ended)

    def ended(self):
        return self.process.poll() is not None and f"the session ended: {self.process.communicate()[1]}"

    def wait(self, what, condition):
        try:
            return wait_for(what, condition, STEP_LIMIT_S, ended=self.ended)
        except AssertionError:
            self.display.keep("failure", *WINDOW)
            raise

    def entries(self, what):
        return of_kind(journal(self.study, "P01"), what) if self.file.exists() else []

    def prompts(self):
        """Kinds of the prompts that the recording of the newest session holds, in their order, with their texts."""
        file = sorted((self.study / "participants" / "P01" / "sessions").glob("*/session.mcap"))[-1]
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([str(STILLHAND), "export", str(file), "--csv", folder], capture_output=True, check=False)
            return [{name.split(" [")[0]: text for name, text in row.items()}
                    for table in pathlib.Path(folder).glob("*prompt*.csv") for row in rows(table)]

    def go_on(self, name):
        """Presses Enter on a page with a button that works."""
        self.wait("a button", self.person.button_row)
        hold(READS_S, lambda: None)
        self.display.keep(name, *WINDOW)
        self.person.press("Return")
        self.wait("the button's end", lambda: self.person.button_row() is None)

    def answer(self, name, act):
        """Waits for a question's boxes, and acts. By the journal, a tracking trial is over, and none runs."""
        def next_is_a_question():
            entries = journal(self.study, "P01")
            return entries[-1]["what"] in ("trial ended", "question answered") and any(
                "step" in entry for entry in of_kind(entries, "trial ended"))
        self.wait(f"the step before {name}", next_is_a_question)
        self.wait(f"the scale of {name}", self.person.boxes)
        hold(READS_S, lambda: None)  # the page of the question before it is gone, too
        edges, row = self.wait(f"the scale of {name}", self.person.boxes)
        self.display.keep(name, *WINDOW)
        act(edges, row)

    def choose(self, key):
        """What a person does to a question: presses a number, sees it chosen, and confirms it."""
        def act(edges, row):
            self.person.press(key)
            self.wait("a button that works", self.person.button_row)
            self.person.press("Return")
        return act


class AnswersTest(ParticipantTestCase):
    def test_answers_by_keys_clicks_and_gamepad_are_in_the_journal_and_in_the_tables(self):
        self.pad = Gamepad(self.folder / "pad")
        self.addCleanup(self.pad.close)
        self.make(QUESTIONS, "--conditions", "A", "--blocks", 2, break_s=20)
        self.begin()
        self.dashboard = Dashboard("--domain", self.domain)
        self.addCleanup(self.dashboard.close)
        self.judge_page("instructions", "participant")
        self.go_on("instructions")
        self.wait("the pegged trial", lambda: self.entries("trial began"))
        hold(2.0, lambda: None)
        self.display.keep("measurement", *WINDOW)
        self.wait("the first trial", lambda: len(self.entries("trial began")) == 2)
        hold(1.0, lambda: None)
        self.display.keep("countdown", *WINDOW)
        hold(4.0, lambda: None)
        self.display.keep("tracking", *WINDOW)
        self.answer("question", self.by_keys)
        self.wait("the first answer", lambda: len(self.entries("question answered")) == 1)
        protocol = self.judge_page("break", "break")
        self.assertTrue(0 <= protocol["left_s"] <= 20 and protocol["trial"] == 2, protocol)
        self.display.keep("break", *WINDOW)
        self.wait("the second trial's end", lambda: len(self.entries("trial ended")) == 3)
        self.answer("question-2", self.by_clicks)
        self.wait("the second answer", lambda: len(self.entries("question answered")) == 2)
        self.answer("question-end", self.by_gamepad)
        self.wait("the third answer", lambda: len(self.entries("question answered")) == 3)
        self.wait("the end's button", self.person.button_row)
        self.display.keep("end", *WINDOW)
        self.pad.press(Gamepad.SOUTH)
        out, errors = self.process.communicate(timeout=END_LIMIT_S)
        self.assertEqual(self.process.returncode, 0, errors)
        self.assertIn("2 of 2 trials", out)
        self.assertEqual([entry["answer"] for entry in self.entries("question answered")], [5, 2, 9])
        self.judge_prompts()
        self.judge_tables()

    def by_keys(self, edges, row):
        """Another number changes the answer; a letter and a number beyond the scale have no effect."""
        self.judge_page("question", "participant")
        before = self.person.light()
        self.person.press("Return")  # nothing is chosen yet
        for key in ("3", "x", "9", "5"):
            self.person.press(key)
            hold(READS_S, lambda: None)
        self.wait("the choice on the screen", lambda: self.person.light() > before and self.person.button_row())
        self.display.keep("question-chosen", *WINDOW)
        self.assertEqual(self.entries("question answered"), [])
        self.person.press("Return")

    def judge_page(self, kind, waits_for):
        """The experimenter sees participant, place and what is waited for, and no condition."""
        def shown():
            protocol = self.dashboard.snapshot()["session"].get("protocol")
            return protocol if protocol and protocol["kind"] == kind else None
        protocol = self.wait(f"{kind} on the page", shown)
        self.assertEqual((protocol["participant"], protocol["waits_for"], protocol["trials"], protocol["blocks"]),
                         ("P01", waits_for, 2, 2))
        self.assertEqual(set(protocol), {"kind", "participant", "block", "blocks", "trial", "trials", "waits_for",
                                         "left_s"})
        if browser.KEPT and kind == "question":  # it waits for as long as the pictures take
            page = browser.Browser(f"http://127.0.0.1:{self.dashboard.port}/")
            hold(2.0, lambda: None)
            page.keep(f"protocol-{kind}")
            page.close()
        return protocol

    def by_clicks(self, edges, row):
        """The second box from the left, then the button, which stands in the middle below the words."""
        self.assertEqual(len(edges), 7)
        self.person.click(edges[1] + 15, row)
        button = self.wait("a button that works", self.person.button_row)
        self.display.keep("question-clicked", *WINDOW)
        self.person.click(WINDOW[0] // 2, button)

    def by_gamepad(self, edges, row):
        """From nothing, left is the last box of nine; the first button before a choice has no effect."""
        self.pad.press(Gamepad.SOUTH)
        for direction in (-1, -1, 1):
            self.pad.press(Gamepad.HAT0X, direction)
        self.wait("a button that works", self.person.button_row)
        self.display.keep("question-gamepad", *WINDOW)
        self.assertEqual(len(self.entries("question answered")), 2)
        self.pad.press(Gamepad.SOUTH)

    def judge_prompts(self):
        prompts = self.prompts()
        print("prompts:", [(row["kind"], row["trial"], row["steps"]) for row in prompts], flush=True)
        # Instructions, the measurement, both trials with their question, the break, the last question, the end.
        self.assertEqual(len({row["number"] for row in prompts}), 9)
        # A condition is in none of them, and no field is named like one.
        for row in prompts:
            self.assertNotIn("condition", " ".join([*row.keys(), *row.values()]))

    def judge_tables(self):
        experiment("unblind", self.study, "--reason", "the test's end")
        out = self.folder / "tables"
        experiment("export", self.study, "--out", out, "--csv")
        answers = rows(out / "answers.csv")
        print(json.dumps(answers), flush=True)
        self.assertEqual([[value for key, value in row.items() if key.startswith(("question", "answer"))]
                          for row in answers], [["effort", "5"], ["effort", "2"], ["sick", "9"]])


class KilledTest(ParticipantTestCase):
    @campaign
    def test_a_question_that_a_kill_cut_is_asked_again_and_nothing_twice(self):
        self.make(QUESTIONS.replace('after: "end"', 'after: "trial"'), "--conditions", "A,B")
        self.begin()
        self.go_on("again-instructions")
        self.answer("again-question", self.choose("4"))
        self.wait("the first answer", lambda: len(self.entries("question answered")) == 1)
        self.answer("again-question-cut", lambda edges, row: self.person.press("6"))
        self.wait("the choice", self.person.button_row)  # not confirmed
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()
        wait_for("the end of the processes", lambda: not running(self.domain), END_LIMIT_S)
        self.begin()
        self.go_on("again-instructions-2")
        self.answer("again-question-2", self.choose("7"))
        self.wait("the second answer", lambda: len(self.entries("question answered")) == 2)
        answered = self.entries("question answered")
        self.assertEqual([(entry["step"], entry["answer"], entry["session"]) for entry in answered],
                         [(1, 4, 1), (2, 7, 2)])
        done = [entry["step"] for entry in self.entries("trial ended") if entry["completed"] and "step" in entry]
        self.assertEqual(done, [0])


if __name__ == "__main__":
    if missing_tools():
        lab_process.skip("not installed: " + ", ".join(missing_tools()))
    lab_process.main()
