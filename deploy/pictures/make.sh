#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes the pictures of the documents: runs one session over DDS (two minutes), takes its figure, a frame of its screen, and
# the dashboard's page of its recording.  Needs a build in build/, chromium with its driver, and ffmpeg.
# Usage: deploy/pictures/make.sh
set -euo pipefail
cd "$(dirname "$0")/../.."
pictures=deploy/pictures
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

build/bin/stillhand lab --conditions A,B,C --trial-seconds 20 --seed 1 --headless --video --out "$work/session"
cp "$work/session/session.png" "$pictures/force_and_hand.png"
ffmpeg -loglevel error -y -ss 75 -i "$work/session/screen.avi" -frames:v 1 "$pictures/tracking_screen.png"

build/bin/stillhand dashboard --recording "$work/session/session.mcap" --port 8341 >"$work/dashboard.log" 2>&1 &
dashboard=$!
trap 'kill $dashboard 2>/dev/null; rm -rf "$work"' EXIT
PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 deploy/pictures/photograph.py http://127.0.0.1:8341/ 62 "$pictures/dashboard.png"
echo "pictures: done"
