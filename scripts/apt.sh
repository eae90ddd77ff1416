#!/usr/bin/env bash
# apt.sh WHAT PACKAGE...: installs Debian packages if it runs as root, or prints what to install.
set -euo pipefail
what=$1
shift
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
  echo "$what is missing; installing $*"
  # apt-get fails while another one runs.
  exec {lock}<"$0"
  flock "$lock"
  apt-get update -qq
  DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" </dev/null
else
  echo "$what is missing. On Debian or Ubuntu: sudo apt-get install --no-install-recommends $*" >&2
  echo "Elsewhere: install your system's packages of these names. Then run make again." >&2
  exit 1
fi
