#!/usr/bin/env bash
# venv_on.sh oldest|newest VERSIONS: makes the environment .venv-oldest or .venv-newest of the first installed of these
# Python versions, with the oldest or the newest versions of the packages. Prints a note if no such Python is installed.
set -euo pipefail
packages=$1
venv=.venv-$packages
python=
for version in $2; do
  if python=$(scripts/python.sh "$version"); then
    break
  fi
done
if [ -z "$python" ]; then
  echo "No environment $venv, because no Python $2 is installed." >&2
  exit 0
fi

if ! [ "$venv/.installed" -nt pyproject.toml ]; then
  rm -rf "$venv"
  # With the pip of .venv, and without compiling, because tests import only a small part. This halves the time.
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
