"""A Zenoh router, as every robot with rmw_zenoh runs one; with addresses of others, it connects to them."""

import json
import sys
import time

import zenoh


def main(port: int, *others: str) -> None:
    config = zenoh.Config()
    config.insert_json5("mode", '"router"')
    config.insert_json5("listen/endpoints", f'["tcp/127.0.0.1:{port}"]')
    config.insert_json5("connect/endpoints", json.dumps(others))
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("timestamping/enabled", "true")
    with zenoh.open(config):
        sys.stdout.write("ready\n")
        sys.stdout.flush()
        while True:
            time.sleep(60)


if __name__ == "__main__":
    main(int(sys.argv[1]), *sys.argv[2:])
