"""A Zenoh router, as every robot with rmw_zenoh runs one; with addresses of others, it connects to them."""

from __future__ import annotations

import json
import sys
from typing import Any

import zenoh


def open_router(where: str, *others: str) -> Any:
    """Open a router that listens at an address, such as ``tcp/127.0.0.1:7447``, and nowhere else."""
    config = zenoh.Config()
    config.insert_json5("mode", '"router"')
    config.insert_json5("listen/endpoints", json.dumps([where]))
    config.insert_json5("connect/endpoints", json.dumps(others))
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("timestamping/enabled", "true")
    return zenoh.open(config)


def main(port: int, *others: str) -> None:
    with open_router(f"tcp/127.0.0.1:{port}", *others):
        sys.stdout.write('"ready"\n')
        sys.stdout.flush()
        sys.stdin.read()  # until the test ends


if __name__ == "__main__":
    main(int(sys.argv[1]), *sys.argv[2:])
