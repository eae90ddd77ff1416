#!/usr/bin/env bash
# Provides Chromium and a font for the browser tests: installs the system's packages if they are missing. On Debian also
# Chromium without windows, in which the tests take a fifth less time.
set -euo pipefail
is_there() {
  for name in "$@"; do
    if command -v "$name" >/dev/null; then
      return 0
    fi
  done
  return 1
}

if ! is_there chromium chromium-browser google-chrome google-chrome-stable; then
  scripts/apt.sh "Chromium" chromium fonts-dejavu-core
fi
if [ "$(id -u)" = 0 ] && grep -qs '^ID=debian' /etc/os-release && ! is_there chromium-headless-shell; then
  scripts/apt.sh "Chromium without windows" chromium-headless-shell || echo "The tests run in Chromium with windows."
fi
