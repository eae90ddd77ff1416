#!/usr/bin/env bash
# venv.sh PYTHON: makes .venv with that Python, or prints in one line why it cannot.
set -euo pipefail
python=$1
command -v "$python" >/dev/null || scripts/apt.sh "$python" python3 python3-venv
if ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))'; then
  echo "robowidgets needs Python 3.10 or later, and $python is $("$python" --version 2>&1)." >&2
  echo "Name a newer one: make PYTHON=python3.12" >&2
  exit 1
fi
"$python" -c 'import ensurepip, venv' 2>/dev/null || scripts/apt.sh "The venv module of $python" python3-venv
"$python" -m venv .venv
.venv/bin/python -m pip install --quiet --disable-pip-version-check --upgrade 'pip>=25.1'
