#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Start and stop of each service under valgrind: no invalid access, nothing of ours that is never freed.

Usage: STILLHAND_BUILD=build /usr/bin/python3 tests/faults/start_and_stop.py [--service NAME]... [--logs DIR]

A service is started alone, as systemd starts it. After its first status it gets SIGTERM. Prints a line for each;
valgrind's own lines go to DIR. Exit status 1 if valgrind found an error or a block that is definitely lost, or if the
service did not end with status 0.
"""
import argparse
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile

TESTS = pathlib.Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS / "integration"), str(TESTS / "support")]

from lab_process import BUILD, CTEST_SKIPPED, SERVICES, SOURCE, next_domain  # noqa: E402

FOUND = 99  # exit status
START_LIMIT_S = 180.0  # valgrind runs one thread at a time, some 50 times slower
END_LIMIT_S = 120.0
VALGRIND = ("valgrind", "--quiet", f"--error-exitcode={FOUND}", "--leak-check=full", "--show-leak-kinds=definite",
            "--errors-for-leak-kinds=definite", "--fair-sched=yes")


def run(service, folder, temporary):
    """Exit status of a service that was started and asked to end; None: it did not start, or did not end."""
    told = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    told.bind(str(temporary / f"{service}.notify"))
    told.settimeout(START_LIMIT_S)
    words = [str(BUILD / "bin" / f"stillhand-{service}"), "--domain", str(next_domain()), "--profiles",
             str(SOURCE / "qos" / "profiles.xml"), "--config", str(SOURCE / "deploy" / "config")]
    words += ["--out", str(temporary / "session.mcap")] if service == "recorder" else []
    words += ["--headless"] if service == "display" else []
    process = subprocess.Popen([*VALGRIND, f"--log-file={folder / service}.txt", *words], stdin=subprocess.DEVNULL,
                               env=dict(os.environ, NOTIFY_SOCKET=str(temporary / f"{service}.notify")))
    try:
        told.recv(256)
        process.send_signal(signal.SIGTERM)
        return process.wait(timeout=END_LIMIT_S)
    except (TimeoutError, subprocess.TimeoutExpired):
        return None
    finally:
        process.kill()
        process.wait()
        told.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--service", action="append", choices=SERVICES, help="one of them alone [all]")
    parser.add_argument("--logs", type=pathlib.Path, help="folder for valgrind's lines [one that is removed]")
    options = parser.parse_args()
    if subprocess.run(["which", "valgrind"], stdout=subprocess.DEVNULL, check=False).returncode != 0:
        print("skipped: no valgrind (package valgrind)")
        return CTEST_SKIPPED
    bad = 0
    with tempfile.TemporaryDirectory(prefix="stillhand-") as temporary:
        folder = options.logs or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for service in options.service or SERVICES:
            status = run(service, folder, pathlib.Path(temporary))
            log = (folder / f"{service}.txt").read_text(errors="replace").splitlines()
            first = next((line for line in log if "== " in line), "")
            bad += status != 0
            print(f"{service:16s} {'clean' if status == 0 else f'status {status}: {first}'}", flush=True)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
