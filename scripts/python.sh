#!/usr/bin/env bash
# python.sh VERSION: prints the path of a complete Python of that version from PATH or pyenv, or fails.
set -euo pipefail
for candidate in "python$1" "${PYENV_ROOT:-$HOME/.pyenv}/versions/$1".*/bin/python; do
  # Run it, because pyenv puts commands on the PATH that only list its versions, and builds Pythons without the modules
  # whose libraries it did not find.
  needed="bz2, sqlite3, ssl, sys, venv"
  if "$candidate" -c "import $needed; '%d.%d' % sys.version_info[:2] == '$1' or sys.exit(1); print(sys.executable)" 2>/dev/null; then
    exit 0
  fi
done
echo "No complete Python $1 was found on the PATH or among pyenv's versions." >&2
exit 1
