#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the fuzzers (preset fuzz: clang, address and undefined-behaviour sanitizers) and runs one after the other.
# Usage: tests/fuzz/run.sh [seconds of each, default 60] [reader...]
# Prints a table; exit status 1 if one of them found something. What was found is in build-fuzz/found/.
# A run that takes more than 60 s by the clock or 1 GB of memory is found, too. `edges` are those of the code that the
# inputs reached, `cpu` is the processor time in seconds.
set -euo pipefail
cd "$(dirname "$0")/../.."
seconds=${1:-60}
shift || true
readers=("$@")
[ ${#readers[@]} -gt 0 ] || readers=(csv table mcap bag idl ros2msg cdr model device yaml inventory experiment json http)

cmake --preset fuzz >/dev/null
cmake --build build-fuzz --target fuzz_seeds "${readers[@]/#/fuzz_}"
work=build-fuzz/corpus
found=build-fuzz/found
mkdir -p "$found"
build-fuzz/bin/fuzz_seeds build-fuzz/seeds
mkdir -p build-fuzz/seeds/{yaml,idl,inventory}
cp deploy/config/*.yaml deploy/experiments/*.yaml build-fuzz/seeds/yaml/
cp idl/*.idl build-fuzz/seeds/idl/
cp deploy/inventory.example.yaml build-fuzz/seeds/inventory/

bad=0
TIMEFORMAT='%U %S'
printf '%-10s %12s %8s %8s %8s %8s\n' reader runs edges seconds cpu found
for reader in "${readers[@]}"; do
  mkdir -p "$work/$reader"
  log=$found/$reader.log
  status=0
  # What a reader prints itself goes nowhere (close_fd_mask); reports of the sanitizers stay.
  { time build-fuzz/bin/fuzz_"$reader" -max_total_time="$seconds" -timeout=60 -rss_limit_mb=1024 -malloc_limit_mb=1024 \
    -max_len=65536 -print_final_stats=1 -close_fd_mask=3 -artifact_prefix="$found/$reader-" \
    "$work/$reader" build-fuzz/seeds/"$reader" >"$log" 2>&1 || status=1; } 2>"$found/cpu"
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  edges=$(sed -n 's/^#[0-9]*.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -n 1)
  spent=$(sed -n 's/^Done [0-9]* runs in \([0-9]*\) second.*/\1/p' "$log")
  cpu=$(awk '{ printf "%.0f", $1 + $2 }' "$found/cpu")
  printf '%-10s %12s %8s %8s %8s %8s\n' "$reader" "${runs:--}" "${edges:--}" "${spent:--}" "$cpu" "$status"
  if [ "$status" != 0 ]; then
    bad=1
    grep -m1 -E 'ERROR|SUMMARY|runtime error' "$log" >&2 || true
  fi
done
exit $bad
