"""TCP ports, and domains of ROS 2, that no other test process on this machine uses.

Another test process, or an outgoing connection of any program, may take a free port before its test opens it. So each
process reserves a number by a socket, which the system closes with the process. Its ports and the ports of its domains
lie below 32768: from there on, Linux takes ports for outgoing connections.
"""

from __future__ import annotations

import socket
from functools import cache
from itertools import count

_NUMBERS, _FIRST = 50, 20000
"""The number of test processes at once, and the first port of the sockets that reserve."""

_EACH = 60
"""The number of ports of each process."""

_count = count()


@cache
def _reserve() -> tuple[int, socket.socket]:
    for number in range(_NUMBERS):
        reserving = socket.socket()
        try:
            reserving.bind(("127.0.0.1", _FIRST + number))
        except OSError:
            reserving.close()
        else:
            return number, reserving
    raise OSError(f"{_NUMBERS} processes run tests on this machine: end some of them")


def free_port() -> int:
    """Return a port of this process that is free now, and another one with each call, until all were given."""
    first = _FIRST + _NUMBERS + _EACH * _reserve()[0]
    for _ in range(_EACH):
        port = first + next(_count) % _EACH
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:  # still in use, or closed a moment ago
                continue
            return port
    raise OSError(f"the ports {first} to {first + _EACH - 1} are all in use")


def free_domain() -> int:
    """Return the first of two domains of this process, 2 to 101. Robots on the machine often use domain 0."""
    return 2 + 2 * _reserve()[0]
