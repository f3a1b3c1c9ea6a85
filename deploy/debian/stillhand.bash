# SPDX-License-Identifier: Apache-2.0
# Completes verbs, options and the values that `--help` and `--help-all` list, and file names elsewhere.
_stillhand() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}
  local next help words choices= earlier= each
  [[ $word == = ]] && word=  # --option=value comes as three words
  [[ $before == = || ${COMP_WORDS[COMP_CWORD]} == = ]] && before=${COMP_WORDS[COMP_CWORD-1]}
  [[ $before == = ]] && before=${COMP_WORDS[COMP_CWORD-2]}
  local -a path=()
  for next in "${COMP_WORDS[@]:1:COMP_CWORD-1}" ""; do
    help=$("${COMP_WORDS[0]}" "${path[@]}" --help 2>/dev/null) || return
    words=$(sed -n '/^Subcommands:/,$ s/^  \([a-z0-9-]\{1,\}\) .*/\1/p' <<<"$help")
    [[ -n $next && " ${words//$'\n'/ } " == *" $next "* ]] || break
    path+=("$next")
  done
  help=$("${COMP_WORDS[0]}" "${path[@]}" --help-all 2>/dev/null)
  if [[ $before == --* ]]; then
    choices=$(sed -n "s/^  $before {\([^}]*\)}.*/\1/p" <<<"$help")
    if [[ -z $choices ]]; then  # "comma-separated: A (stationary), B (moving)": the last one of the list
      choices=$(sed -n "/^  $before /,/^\(  -.*\|\)$/p" <<<"$help" | tr -s ' \n' ' ' |
                sed -n "s/.*comma-separated: //; T; s/ ([^)]*)//g; s/ -.*//; s/, /,/gp")
      [[ -n $choices && $word == *,* ]] && earlier=${word%,*},
    fi
  elif [[ $word != -* ]]; then
    choices=$(sed -n '/^Positionals:/,/^$/ s/^  [a-z]* {\([^}]*\)}.*/\1/p' <<<"$help")
  fi
  if [[ -n $choices ]]; then
    words=${choices//,/ }
  elif [[ $word == -* ]]; then
    words=$(sed -n 's/^  \(-[a-zA-Z],\)\{0,1\}\(--[a-z0-9-]\{1,\}\).*/\2/p' <<<"$help")
  fi
  COMPREPLY=()
  for each in $words; do
    [[ $earlier$each == "$word"* && ,$earlier != *",$each,"* ]] && COMPREPLY+=("$earlier${each//\'/\\\'}")
  done
}
complete -o default -F _stillhand stillhand
