#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Set-up, checks of the sources, build, tests.
# Usage: tests/run.sh [--all] [arguments of ctest, for example -L unit]
#   --all  also the campaigns (the long forms of some tests), clang-tidy over all C++, and the unit and interface tests
#          under the sanitizers
# A campaign by itself: tests/run.sh -R campaign.kill_recorder
set -euo pipefail
cd "$(dirname "$0")/.."
all=
if [ "${1:-}" = --all ]; then
  all=yes
  shift
fi

deploy/setup.sh
.ci/format
.ci/layering
.ci/links
deploy/build.sh tests

# Three tests at a time, of which at most one is a session; those that judge timing run alone
# (tests/CMakeLists.txt).
tests() {
  local tree=$1
  shift
  ctest --test-dir "$tree" --output-on-failure --timeout 1200 -j 3 "$@"
}

if [ -z "$all" ]; then
  case " $* " in
    *campaign*) tests build "$@" ;;
    *) tests build -LE campaign "$@" ;;
  esac
  exit
fi

# Each part runs, whatever the parts before it found.
failed=()
tests build "$@" || failed+=("tests")
for preset in asan-ubsan tsan; do
  # The recordings of the MCAP project's reader come from a live session, which no sanitizer lets run in time.
  { deploy/build.sh "$preset" &&
    tests "build-$preset" -L '^(unit|interface)$' -E mcap_official_reader "$@"; } || failed+=("$preset")
done
.ci/tidy || failed+=("clang-tidy")
if [ ${#failed[@]} -gt 0 ]; then
  echo "run: failed: ${failed[*]}" >&2
  exit 1
fi
echo "run: everything passed"
