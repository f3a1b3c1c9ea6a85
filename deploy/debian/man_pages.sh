#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes manual pages from the --help of the programs: stillhand(1), one per verb, one per service.
# Usage: deploy/debian/man_pages.sh FOLDER PREFIX VERSION OUT PROGRAM...
#   FOLDER  folder of the programs, whose help texts contain their own prefix
#   PREFIX  replaces that prefix in the pages
# EMULATOR, where it is set, runs the programs: those of another processor.
set -euo pipefail
programs=$(cd "$1" && pwd) prefix=$2 version=$3 out=$4
shift 4
built=$(dirname "$programs")
files=$(dirname "$0")/man_page_files

page() {  # page PROGRAM [VERB...]
  local program=$1 name help title option=--help
  shift
  name=$(IFS=-; echo "$program${*:+-$*}")
  help=$(${EMULATOR:-} "$programs/$program" "$@" --help)
  # Where it shows the options that people use first, it says so.
  if grep -q -e --help-all <<<"$help"; then option=--help-all; fi
  # The first sentence, or the text before the colon.
  title=$(sed -e '/^Usage:/,$ d' -e "s/^$program: //" <<<"$help" | tr '\n' ' ' | sed 's/[.:?;] .*//')
  # A page writes "-" as "\-". help2man does not support verbs: it uses the program's name as the page's name.
  help2man --no-info --section=1 --version-string="$version" --name="$title" --include="$files" \
           --help-option="$* $option" "${EMULATOR:+$EMULATOR }$programs/$program" |
    sed -e "s|@prefix@|$prefix|" -e "s|${built//-/\\\\-}/|${prefix//-/\\\\-}/|g" -e "1,/^\.SH SYNOPSIS/ {
      s/^\.TH [^ ]*/.TH ${name^^}/
      s/^$program /${name//-/\\\\-} /
    }" | gzip -9n >"$out/$name.1.gz"
  for verb in $(sed -n '/^Subcommands:/,$ s/^  \([a-z0-9-]\{1,\}\) .*/\1/p' <<<"$help"); do
    page "$program" "$@" "$verb"
  done
}

umask 022
mkdir -p "$out"
for program in "$@"; do page "$program"; done
