#!/usr/bin/env bash
# units_on.sh oldest|newest VERSIONS [OPTION...]: runs the unit tests in the environment of venv_on.sh. Skips them if no
# such Python is installed. Options are options of pytest.
set -euo pipefail
scripts/venv_on.sh "$1" "$2"
python=.venv-$1/bin/python
if ! [ -x "$python" ]; then
  echo "Skipped: the unit tests on Python $2." >&2
  exit 0
fi
"$python" -m pytest --numprocesses 4 --dist loadfile --no-loadscope-reorder tests/unit "${@:3}"
