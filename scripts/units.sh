#!/usr/bin/env bash
# units.sh VERSION floor|newest [OPTION...]: runs the unit tests on that Python, with the oldest or the newest versions of
# what the package needs, in an environment of their own, .venv-floor or .venv-newest. Skips them where there is no such
# Python. Options are pytest's.
set -euo pipefail
version=$1 versions=$2
shift 2
venv=.venv-$versions

python=
for candidate in "python$version" "${PYENV_ROOT:-$HOME/.pyenv}/versions/$version".*/bin/python; do
  # Run, not only looked for: pyenv puts commands on the PATH that only say which versions it has, and builds Pythons
  # without the modules whose libraries it did not find.
  needed="bz2, sqlite3, ssl, sys, venv"
  if "$candidate" -c "import $needed; sys.exit('%d.%d' % sys.version_info[:2] != '$version')" 2>/dev/null; then
    python=$candidate
  fi
done
if [ -z "$python" ]; then
  echo "Skipped: the unit tests on Python $version with the $versions versions." \
    "No complete Python $version was found on the PATH or among pyenv's versions." >&2
  exit 0
fi

if ! [ "$venv/.installed" -nt pyproject.toml ]; then
  rm -rf "$venv"
  # By the pip of .venv, and not compiled: tests import a small part of it. That halves the time.
  "$python" -m venv --without-pip "$venv"
  [ "$versions" = newest ] || "$python" scripts/floor.py >"$venv/constraints.txt"
  touch "$venv/constraints.txt"
  SKIP_JUPYTER_BUILDER=1 .venv/bin/python -m pip --python "$venv/bin/python" install --quiet --no-compile \
    --constraint "$venv/constraints.txt" --group unit --editable '.[lab]'
  touch "$venv/.installed"
fi
"$venv/bin/python" -m pytest --numprocesses 3 --dist loadfile tests/unit "$@"
