#!/usr/bin/env bash
# try_demo.sh: runs `make demo` like a new user, and ends it once the page at the printed address answers.
set -euo pipefail
said=$(mktemp)
# In a new process group, so that the signal to end it reaches make and JupyterLab as in a terminal.
setsid env -u JUPYTER_TOKEN make demo </dev/null >"$said" 2>&1 &
demo=$!
end() {
  # JupyterLab ends its kernels on SIGTERM.
  kill -TERM -- "-$demo" 2>/dev/null || true
  for _ in $(seq 60); do
    kill -0 -- "-$demo" 2>/dev/null || break
    sleep 0.5
  done
  kill -KILL -- "-$demo" 2>/dev/null || true
  rm -f "$said"
}
trap end EXIT

for _ in $(seq 600); do
  if address=$(grep -oE -m 1 'http://127\.0\.0\.1:[0-9]+/lab/tree/\S+\?token=\w+' "$said") &&
    python3 -c 'import sys, urllib.request; urllib.request.urlopen(sys.argv[1], timeout=60)' "$address" 2>/dev/null; then
    echo "make demo: the tour is open."
    exit 0
  fi
  kill -0 "$demo" 2>/dev/null || break
  sleep 1
done
echo "make demo printed no address that answers. Its output:" >&2
cat "$said" >&2
exit 1
