#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs a command. On a terminal its output passes through. In a pipe or a log its output goes to the file LOG, and one
# line shows every half a minute (STILLHAND_PROGRESS_S) how long it has run, and the newest line of the file.
# Usage: deploy/with_progress.sh NAME LOG COMMAND [ARGUMENTS]
set -euo pipefail
name=$1 log=$2
shift 2
if [ -t 1 ]; then exec "$@"; fi

"$@" >"$log" 2>&1 &
command=$!
# The sleep has no output of ours: it outlives the command and would hold a reader's pipe open.
while sleep "${STILLHAND_PROGRESS_S:-30}" >/dev/null 2>&1; do
  echo "$name: ${SECONDS} s, $(tail -n 1 "$log" | LC_ALL=C tr -d '[:cntrl:]' | cut -c 1-100)"
done &
beat=$!
trap 'kill "$command" "$beat" 2>/dev/null; exit 130' INT TERM
status=0
wait "$command" || status=$?
kill "$beat" 2>/dev/null || true
exit "$status"
