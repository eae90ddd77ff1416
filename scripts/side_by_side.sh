#!/usr/bin/env bash
# side_by_side.sh COMMAND...: runs shell commands in parallel. The output of all but the first appears when the first has
# ended. Fails if one of them failed.
set -uo pipefail
kept=$(mktemp -d)
trap 'rm -rf "$kept"' EXIT
# A shell ignores SIGINT in background commands.
trap 'trap - EXIT TERM; rm -rf "$kept"; kill 0' INT TERM

others=()
for command in "${@:2}"; do
  bash -c "$command" </dev/null &>"$kept/${#others[@]}" &
  others+=($!)
done
status=0
bash -c "$1" </dev/null || status=$?
for i in "${!others[@]}"; do
  wait "${others[i]}" || status=$?
  cat "$kept/$i"
done
exit "$status"
