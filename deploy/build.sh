#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Configures and builds into build/. Usage: deploy/build.sh [preset]; the default preset is release.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-release}

log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! cmake --preset "$preset" >"$log" 2>&1; then
  cat "$log" >&2
  echo "build: cmake --preset $preset failed" >&2
  exit 1
fi
: >"$log"
if ! deploy/with_progress.sh build "$log" cmake --build --preset "$preset"; then
  tail -n 60 "$log" >&2
  echo "build: the build failed; its last lines are above" >&2
  exit 1
fi
echo "build: done ($preset)"
