#!/usr/bin/env bash
# units_on.sh oldest|newest VERSIONS [OPTION...]: runs the unit tests on the first of these Python versions that is there,
# with the oldest or the newest versions of the packages, in an environment of their own, .venv-oldest or .venv-newest.
# Skips them if there is no such Python. Options are pytest's.
set -euo pipefail
packages=$1
versions=$2
shift 2
venv=.venv-$packages
python=
for version in $versions; do
  if python=$(scripts/python.sh "$version"); then
    break
  fi
done
if [ -z "$python" ]; then
  echo "Skipped: the unit tests on Python $versions." >&2
  exit 0
fi

if ! [ "$venv/.installed" -nt pyproject.toml ]; then
  rm -rf "$venv"
  # By the pip of .venv, and not compiled: tests import a small part of it. That halves the time.
  "$python" -m venv --without-pip "$venv"
  constraints=()
  if [ "$packages" = oldest ]; then
    "$python" scripts/oldest.py >"$venv/constraints.txt"
    constraints=(--constraint "$venv/constraints.txt")
  fi
  SKIP_JUPYTER_BUILDER=1 .venv/bin/python -m pip --python "$venv/bin/python" install --quiet --no-compile \
    "${constraints[@]}" --group unit --editable '.[lab]'
  touch "$venv/.installed"
fi
"$venv/bin/python" -m pytest --numprocesses 4 --dist loadfile --no-loadscope-reorder tests/unit "$@"
