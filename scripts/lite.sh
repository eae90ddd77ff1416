#!/usr/bin/env bash
# Fetches what JupyterLite on the site is made of, once, into .venv-site: an environment of its own, because JupyterLab
# would load the kernel of JupyterLite, too.
set -euo pipefail
wheels=scripts/lite-wheels.txt
if ! [ .venv-site/.fetched -nt "$wheels" ] || ! [ .venv-site/.fetched -nt "$0" ]; then
  rm -rf .venv-site
  .venv/bin/python -m venv --without-pip .venv-site
  .venv/bin/python -m pip --python .venv-site/bin/python install --quiet --no-compile \
    jupyterlite-core==0.7.6 jupyterlite-pyodide-kernel==0.7.2 jupyter-server build hatchling hatch-jupyter-builder \
    "$(grep ^anywidget= $wheels)" "$(grep ^ipywidgets= $wheels)"
  .venv/bin/python -m pip download --quiet --no-deps --dest .venv-site/wheels \
    --only-binary :all: --platform any --python-version 3.13 --implementation py --abi none --requirement "$wheels"
  touch .venv-site/.fetched
fi
