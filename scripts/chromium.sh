#!/usr/bin/env bash
# Provides Chromium and a font for the browser tests: installs the system's packages if they are missing.
set -euo pipefail
for name in chromium chromium-browser google-chrome google-chrome-stable; do
  command -v "$name" >/dev/null && exit 0
done
scripts/apt.sh "Chromium" chromium fonts-dejavu-core
