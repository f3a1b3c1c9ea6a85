#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From a fresh clone to a finished session. Installs packages, builds, and runs a session with every process over DDS.
# Then runs the closed loop in one process: the rig holds an undeclared effect, the diagnosis looks for it, and the
# canceller gets the improved model.
# Usage: deploy/demo.sh [output folder] [further options of `stillhand lab`]
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-demo}
[ $# -gt 0 ] && shift

deploy/setup.sh
deploy/build.sh
build/bin/stillhand lab --conditions A,B,C --trial-seconds 20 --seed 1 --headless --out "$out" "$@"
build/bin/stillhand close-the-loop --undeclared-effect 9 --seed 1 --out "$out/closed-loop"
