# SPDX-License-Identifier: Apache-2.0
"""Waiting for a condition with a limit, and keeping a state for a time: the one place where a Python test polls."""
import time

POLL_S = 0.05


def wait_for(what, condition, limit_s, poll_s=POLL_S, failure=AssertionError, ended=lambda: None):
    """Returns the condition's first true value.

    After the limit, or if `ended` returns a sentence, it raises what `failure` makes of that line. Without a `failure`
    it returns None.
    """
    limit = time.monotonic() + limit_s
    while not (value := condition()):
        left_s = limit - time.monotonic()
        why = ended() or (f"no {what} within {limit_s:g} s" if left_s <= 0 else None)
        if why:
            if failure is None:
                return None
            raise failure(why)
        time.sleep(min(poll_s, left_s))
    return value


def hold(seconds, until=lambda: None, poll_s=POLL_S):
    """Keeps what the test has done (a cable out, a process stopped) for a time that is itself the test's stimulus.

    Ends before it if `until` returns a value, which it returns.
    """
    return wait_for("end of the hold", until, seconds, poll_s, failure=None)
