# SPDX-License-Identifier: Apache-2.0
"""How a fault gets into a process that knows nothing of it."""
import ctypes
import os
import pathlib
import signal
import subprocess

from lab_process import hold

_LIBC = ctypes.CDLL(None, use_errno=True)
SPIN = signal.SIGRTMIN + 7  # busy_on_signal.cpp
WATCH_S = 0.1  # a control thread works a thousand times a second
STOPPED_S = {"stop5": 0.005, "stop50": 0.05, "stop500": 0.5}


def processor_ns(pid):
    """{thread: processor time that it has used [ns]}."""
    return {int(task.name): int((task / "schedstat").read_text().split()[0])
            for task in pathlib.Path(f"/proc/{pid}/task").iterdir()}


def control_thread(pid, service):
    """The thread with the process's work: the loop of rig and experiment is their main thread, the others work where
    they receive, which costs more than anything else that they do."""
    if service in ("rig", "experiment"):
        return pid
    before = processor_ns(pid)
    hold(WATCH_S)
    after = processor_ns(pid)
    return max(after, key=lambda thread: after[thread] - before.get(thread, after[thread]))


class Fault:
    """One fault of one process. `end()` takes away what it leaves behind."""

    def __init__(self, kind, pid, service, folder):
        self.kind, self.pid, self.service, self._folder = kind, pid, service, folder
        self.again = None  # the process that was started again
        # Found before the moment of the fault: it takes a tenth of a second.
        self._thread = control_thread(pid, service) if kind == "busy" else None
        self._words = pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().decode().split("\0")[:-1]

    def strike(self):
        if self.kind in ("kill", "restart"):
            os.kill(self.pid, signal.SIGKILL)
        elif self.kind == "busy":
            if _LIBC.tgkill(self.pid, self._thread, SPIN) != 0:
                raise OSError(ctypes.get_errno(), f"no thread {self._thread} of {self.service}")
        else:
            os.kill(self.pid, signal.SIGSTOP)
        if self.kind in STOPPED_S:
            hold(STOPPED_S[self.kind], poll_s=STOPPED_S[self.kind])
            os.kill(self.pid, signal.SIGCONT)
        if self.kind == "restart" and self.service != "experiment":
            with open(self._folder / f"{self.service}_again.log", "w", encoding="utf-8") as log:
                self.again = subprocess.Popen(self._words, stdin=subprocess.DEVNULL, stdout=log, stderr=log)

    def end(self):
        if self.again:
            self.again.kill()
            self.again.wait()
