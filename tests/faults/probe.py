# SPDX-License-Identifier: Apache-2.0
"""The witness next to a session (rig_probe.cpp): what it prints as values, what it wrote as columns."""
import subprocess
import threading

from judge import COLUMNS
from lab_process import BUILD

RIG_PROBE = BUILD / "tests" / "rig_probe"


class Probe:
    def __init__(self, domain, file):
        self._file = file
        self._process = subprocess.Popen([str(RIG_PROBE), str(domain), str(file)], stdin=subprocess.PIPE,
                                         stdout=subprocess.PIPE, text=True, bufsize=1)
        self._reader = threading.Thread(target=self._follow, daemon=True)
        self.forget()
        self._reader.start()

    def forget(self):
        """Another session begins."""
        self.tick = -1
        self.control = {"state": "waiting", "trial": -1, "start": 0, "duration": 0, "ramp": 0}

    def _follow(self):
        for line in self._process.stdout:
            words = line.split()
            if words[0] == "tick":
                self.tick = int(words[1])
            elif words[0] == "state":
                numbers = dict(zip(words[2::2], map(int, words[3::2])))
                self.control = {"state": words[1], **numbers}

    def ask(self, request):
        self._process.stdin.write(request + "\n")
        self._process.stdin.flush()

    def close(self):
        self._process.stdin.close()
        try:
            self._process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._reader.join()

    def samples(self):
        """The rig's samples as columns, one writer after the other."""
        rows = []
        with open(self._file, encoding="utf-8") as lines:
            for line in lines:
                words = line.split()
                if len(words) == 1 + len(COLUMNS):
                    rows.append(words)
        rows.sort(key=lambda words: int(words[0]))  # stable: the order within a writer stays
        kinds = {name: int for name in ("tick", "stamp_ns", "motor_tick", "motor_permitted", "command_tick")}
        return {name: [kinds.get(name, float)(row[1 + i]) for row in rows] for i, name in enumerate(COLUMNS)}
