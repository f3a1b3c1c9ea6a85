# SPDX-License-Identifier: Apache-2.0
"""Waiting for a condition with a limit, and keeping a state for a time: the one place where a test in Python sleeps."""
import time

POLL_S = 0.05


def wait_for(what, condition, limit_s, poll_s=POLL_S, failure=AssertionError, ended=lambda: None):
    """Returns the condition's first true value.

    After the limit, or if `ended` returns a sentence, it raises what `failure` makes of that line. Without a `failure`
    it returns None.
    """
    limit = time.monotonic() + limit_s
    while not (value := condition()):
        why = ended() or (f"no {what} within {limit_s:g} s" if time.monotonic() > limit else None)
        if why:
            if failure is None:
                return None
            raise failure(why)
        time.sleep(poll_s)
    return value


def hold(seconds):
    """Keeps what the test has done (a cable out, a process stopped) for a time that is itself the test's stimulus."""
    time.sleep(seconds)


def repeat(step, seconds, every_s):
    """Calls `step` again and again for a time."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        step()
        time.sleep(every_s)
