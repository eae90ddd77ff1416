#!/usr/bin/env bash
# Provides Firefox for the tests of exported pages. If it cannot be installed, these tests are skipped.
set -euo pipefail
for name in firefox-esr firefox; do
  command -v "$name" >/dev/null && exit 0
done
scripts/apt.sh "Firefox" firefox-esr || echo "The tests in Firefox are skipped." >&2
