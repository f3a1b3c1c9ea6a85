#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From a fresh clone to a finished session: set-up, build, the laboratory with every process over DDS, and then, in one
# process, what the paper's model lacks when the rig holds something that nobody declared, put back into the canceller.
# Usage: deploy/demo.sh [output folder] [further options of `stillhand lab`]
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-demo}
[ $# -gt 0 ] && shift

deploy/setup.sh
deploy/build.sh
build/bin/stillhand lab --conditions A,B,C --trial-seconds 20 --seed 1 --headless --out "$out" "$@"
build/bin/stillhand close-the-loop --undeclared-effect 9 --seed 1 --out "$out/closed-loop"
