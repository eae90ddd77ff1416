#!/usr/bin/env bash
# floor.sh [OPTION...]: runs the unit tests on Python 3.10 with the oldest versions of what the package needs, in an
# environment of their own, .venv-floor. Skips them where there is no such Python. Options are pytest's.
set -euo pipefail
venv=.venv-floor
if ! python=$(scripts/python.sh 3.10); then
  echo "Skipped: the unit tests with the oldest versions." >&2
  exit 0
fi

if ! [ "$venv/.installed" -nt pyproject.toml ]; then
  rm -rf "$venv"
  # By the pip of .venv, and not compiled: tests import a small part of it. That halves the time.
  "$python" -m venv --without-pip "$venv"
  "$python" scripts/floor.py >"$venv/constraints.txt"
  SKIP_JUPYTER_BUILDER=1 .venv/bin/python -m pip --python "$venv/bin/python" install --quiet --no-compile \
    --constraint "$venv/constraints.txt" --group unit --editable '.[lab]'
  touch "$venv/.installed"
fi
"$venv/bin/python" -m pytest --numprocesses 3 --dist loadfile tests/unit "$@"
