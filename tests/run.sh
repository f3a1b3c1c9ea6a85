#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Set-up, build, every test. Usage: tests/run.sh [arguments of ctest, for example -L unit]
set -euo pipefail
cd "$(dirname "$0")/.."

deploy/setup.sh
deploy/build.sh
.ci/layering
exec ctest --test-dir build --output-on-failure --timeout 900 "$@"
