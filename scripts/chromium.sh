#!/usr/bin/env bash
# Sees to a Chromium and a font for the browser tests: the ones of the system, installed if need be.
set -euo pipefail
for name in chromium chromium-browser google-chrome google-chrome-stable; do
  command -v "$name" >/dev/null && exit 0
done
scripts/apt.sh "Chromium" chromium fonts-dejavu-core
