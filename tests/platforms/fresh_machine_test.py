#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The README's two commands on a fresh machine: a minimal root of each Debian release, made by debootstrap.

The sources of this tree, as committed, are cloned into the root. Everything else comes from Debian, so that a name
missing in deploy/packages.txt shows. A root has its own processes, /dev/shm and /tmp: what a command leaves is seen.

Usage: fresh_machine_test.py [--short] [--release NAME]... [--keep FOLDER]
  --short    configure, build, the unit tests and one session, in place of both commands as the README states them
  --keep     leaves the roots in this folder, to look at what the commands made
Needs root, debootstrap and a Debian mirror; it is skipped (exit status 77) without one of them.
"""
import argparse
import contextlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

SOURCE = pathlib.Path(__file__).resolve().parents[2]
RELEASES = ("trixie", "bookworm")
CERTIFICATES = "/etc/ssl/certs/ca-certificates.crt"
TRUSTED = "/etc/trusted.crt"  # in the root
CLONE = "srv/clone"  # in the root
SESSION = ("build/bin/stillhand lab --conditions A,B,C --trial-seconds 20 --seed 1 --headless --out demo")
SHORT = ("deploy/setup.sh", "deploy/build.sh tests", "ctest --test-dir build -L unit -j 2 --output-on-failure", SESSION)
BOTH = ("deploy/demo.sh", "tests/run.sh", "cpack -G DEB --config build/CPackConfig.cmake")
# $1 root, $2 command, $3 certificates, $4 clone. The command's processes end with it: it is the first of its own
# namespace. The root is the namespace's own, no chroot, so that a program may enter the namespace by its name in /proc.
INSIDE = r"""
set -e
mount --make-rprivate /
mount --bind "$1" "$1"
mount -t proc proc "$1/proc"
mount --rbind /sys "$1/sys"
mount --rbind /dev "$1/dev"
mount -t tmpfs shm "$1/dev/shm"
cp -L /etc/resolv.conf "$1/etc/resolv.conf"
cd "$1"
pivot_root . mnt
trusted=$([ ! -e "$3" ] || echo "NPM_CONFIG_CAFILE=$3")
exec env -i HOME=/root LANG=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin $trusted sh -c '
  umount --lazy /mnt || exit 1
  cd "$1" && sh -c "$0"; status=$?
  left=$(ls -A /dev/shm; for each in /proc/[0-9]*; do
    [ "$each" = "/proc/$$" ] || readlink "$each/exe" | grep -s stillhand; done)
  [ -z "$left" ] || { echo "left behind: $left" >&2; status=1; }
  exit $status' "$2" "/$4"
"""


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(77)


def inside(root, command):
    """One command in the root; its seconds. @throws AssertionError with its last lines"""
    begin = time.monotonic()
    done = subprocess.run(["unshare", "--mount", "--pid", "--fork", "--kill-child", "bash", "-c", INSIDE, "bash", root,
                           command, TRUSTED, CLONE], capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
    if done.returncode != 0:
        raise AssertionError(f"{command}: exit status {done.returncode}\n{(done.stdout + done.stderr)[-4000:]}")
    return time.monotonic() - begin


def make_root(release, root):
    made = subprocess.run(["debootstrap", "--variant=minbase", release, root], capture_output=True, text=True,
                          check=False)
    if made.returncode != 0 and "Release" in made.stdout + made.stderr:
        skip(f"no Debian mirror: {(made.stdout + made.stderr).strip().splitlines()[-1]}")
    if made.returncode != 0:
        raise AssertionError(f"debootstrap {release}\n{(made.stdout + made.stderr)[-2000:]}")
    subprocess.run(["git", "clone", "--quiet", "--no-hardlinks", SOURCE, f"{root}/{CLONE}"], check=True)
    # npm trusts there what this machine trusts: a network may have a certificate of its own.
    if pathlib.Path(CERTIFICATES).exists():
        shutil.copy(CERTIFICATES, f"{root}{TRUSTED}")


def check_results(root, short):
    summary = json.loads((root / CLONE / "demo/summary.json").read_text())
    assert set(summary["conditions"]) >= {"A", "B", "C"}, sorted(summary["conditions"])
    wanted = ["demo/session.mcap", "demo/model.json", "demo/session.png"]
    if not short:
        wanted += ["demo/closed-loop/summary.json"]
        assert len(list((root / CLONE).glob("build/packages/*.deb"))) == 2
    for name in wanted:
        assert (root / CLONE / name).stat().st_size > 0, name


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--release", action="append", choices=RELEASES)
    parser.add_argument("--keep", metavar="FOLDER", type=pathlib.Path)
    options = parser.parse_args()
    if os.geteuid() != 0:
        skip("not root: no root of another release")
    if shutil.which("debootstrap") is None:
        skip("no debootstrap")
    for release in options.release or RELEASES:
        with contextlib.ExitStack() as until_done:
            if options.keep:
                root = options.keep / release
                root.mkdir(parents=True)
            else:
                root = pathlib.Path(until_done.enter_context(
                    tempfile.TemporaryDirectory(prefix=f"stillhand-{release}-")))
            make_root(release, root)
            for command in SHORT if options.short else BOTH:
                print(f"{release}: {command}: {inside(root, command):.0f} s", flush=True)
            check_results(root, options.short)
        print(f"{release}: good", flush=True)


if __name__ == "__main__":
    main()
