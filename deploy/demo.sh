#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From a fresh clone to a finished session: set-up, build, then the laboratory with every process over DDS.
# Usage: deploy/demo.sh [output folder] [further options of `stillhand lab`]
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-demo}
[ $# -gt 0 ] && shift

deploy/setup.sh
deploy/build.sh
exec build/bin/stillhand lab --conditions A,B,C --trial-seconds 20 --seed 1 --headless --out "$out" "$@"
