#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Manual pages of what the programs say about themselves with --help: stillhand(1), one a verb, one a service.
# Usage: deploy/debian/man_pages.sh FOLDER PREFIX VERSION OUT PROGRAM...
#   FOLDER  holds the programs, which name their own prefix
#   PREFIX  what the pages name instead
set -euo pipefail
programs=$(cd "$1" && pwd) prefix=$2 version=$3 out=$4
shift 4
built=$(dirname "$programs")
files=$(dirname "$0")/man_page_files

page() {  # page PROGRAM [VERB...]
  local program=$1 name help title
  shift
  name=$(IFS=-; echo "$program${*:+-$*}")
  help=$("$programs/$program" "$@" --help)
  # Its first sentence, or what stands before the colon.
  title=$(sed -e '/^Usage:/,$ d' -e "s/^$program: //" <<<"$help" | tr '\n' ' ' | sed 's/[.:?;] .*//')
  # In a page "-" is "\-". help2man knows of no verbs: it takes the program's name for the page's.
  help2man --no-info --section=1 --version-string="$version" --name="$title" --include="$files" \
           --help-option="$* --help" "$programs/$program" |
    sed -e "s|@prefix@|$prefix|" -e "s|${built//-/\\\\-}/|${prefix//-/\\\\-}/|g" -e "1,/^\.SH SYNOPSIS/ {
      s/^\.TH [^ ]*/.TH ${name^^}/
      s/^$program /${name//-/\\\\-} /
    }" | gzip -9n >"$out/$name.1.gz"
  for verb in $(sed -n '/^Subcommands:/,$ s/^  \([a-z-]\{1,\}\) .*/\1/p' <<<"$help"); do
    page "$program" "$@" "$verb"
  done
}

umask 022
mkdir -p "$out"
for program in "$@"; do page "$program"; done
