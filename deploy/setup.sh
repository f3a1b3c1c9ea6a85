#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the missing Debian packages of deploy/packages.txt, as root or as a user with sudo. It is safe to run again.
# Usage: deploy/setup.sh
set -euo pipefail
cd "$(dirname "$0")/.."

# Installed packages, with the names that they provide: Node.js from its own makers contains npm and conflicts with
# Debian's package npm.
installed=$(dpkg-query -W -f='${db:Status-Status}, ${Package}, ${Provides}\n' | sed -n 's/^installed, //p' |
            tr ',' '\n' | sed -e 's/(.*//' -e 's/[[:space:]]//g')
missing=()
while read -r package; do
  grep -qxE "${package// | /|}" <<<"$installed" || missing+=("$package")
done < <(sed -e 's/#.*//' -e '/^[[:space:]]*$/d' deploy/packages.txt)

if [ ${#missing[@]} -eq 0 ]; then
  echo "set-up: every package is installed"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "set-up: got no right to install (missing: ${missing[*]}), want root or sudo" >&2
    exit 2
  fi
  as_root=(sudo)
fi
echo "set-up: installing ${missing[*]}"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
step() { deploy/with_progress.sh set-up "$log" "${as_root[@]}" "$@"; }
if ! { step apt-get update &&
       step env DEBIAN_FRONTEND=noninteractive apt-get satisfy -y --no-install-recommends "${missing[@]}"; }; then
  tail -n 20 "$log" >&2
  echo "set-up: apt-get failed; its last lines are above" >&2
  exit 1
fi
echo "set-up: done"
