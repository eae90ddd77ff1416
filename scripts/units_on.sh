#!/usr/bin/env bash
# units_on.sh oldest|newest VERSIONS [OPTION...]: runs the unit tests on the first installed of these Python versions,
# with the oldest or the newest versions of the packages, in the environment .venv-oldest or .venv-newest. Skips them if
# no such Python is installed. Options are options of pytest.
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
"$venv/bin/python" -m pytest --numprocesses 4 --dist loadfile --no-loadscope-reorder tests/unit "$@"
