"""The server in the process of a notebook: an assistant sees, and may drive, the robot that the user watches."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING

from ..feeds import Feed
from .hand import LEASE_S, MAX_ANGULAR, MAX_LINEAR, DriveLimits
from .library import Library

if TYPE_CHECKING:
    from .http import HttpServer
    from .server import AssistantServer

MISSING = 'the Python SDK of the Model Context Protocol is not installed here; type: pip install "robowidgets[mcp]"'


class Assistant:
    """A server for assistants, on 127.0.0.1. Printed, it shows what a client needs. As a context manager it closes.

    Attributes:
        url: its address.
        token: its token. It allows all that this server offers.
    """

    def __init__(self, server: AssistantServer, http: HttpServer) -> None:
        self._server, self._http = server, http
        self.url, self.token = http.url, http.token
        http.start()

    @property
    def may_drive(self) -> bool:
        """True if the assistant may drive."""
        return self._server.hand is not None

    def close(self) -> None:
        """End the server, and stop the robot if the assistant drives it. The feed stays open."""
        self._server.close()
        self._http.close()

    def __enter__(self) -> Assistant:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        hand = self._server.hand
        drives = "it may not drive"
        if hand is not None:
            limits = hand.limits
            speeds = f"{limits.max_linear:g} m/s and {limits.max_angular:g} rad/s"
            drives = f"it may drive within {speeds}, {limits.lease:g} s a command"
        return f"assistant: {drives}\nurl: {self.url}\nheader: Authorization: Bearer {self.token}"


def assistant(
    feed: Feed | None = None,
    *,
    recordings: str | os.PathLike[str] | Iterable[str | os.PathLike[str]] = (),
    drive: bool = False,
    max_linear: float = MAX_LINEAR,
    max_angular: float = MAX_ANGULAR,
    lease: float = LEASE_S,
    port: int = 0,
) -> Assistant:
    """Serve a robot or recordings to an assistant, by the Model Context Protocol over HTTP on this computer.

    Stop, the pads and the programs of this notebook come first: each ends the command of the assistant at once.

    Args:
        feed: the feed, which stays yours, or None.
        recordings: files and folders that the assistant may read.
        drive: True to let it drive.
        max_linear: its limit in m/s, in addition to `Feed.driving`.
        max_angular: its limit in rad/s.
        lease: seconds after which a command of it ends, at most 30.
        port: the port, or 0 for any free one.

    Raises:
        ImportError: the SDK is not installed (extra ``mcp``).
        TypeError: feed is not a feed, or drive is neither True nor False.
        ValueError: a limit is not above 0, the port does not exist, or there is nothing to serve.
        OSError: a place does not exist, or the port is taken.

    Examples:
        >>> helper = robowidgets.assistant(feed, drive=True, max_linear=0.1)  # doctest: +SKIP
    """
    if feed is not None and not isinstance(feed, Feed):
        raise TypeError(f"feed: expected a feed, such as robowidgets.feeds.simulator(), got {feed!r}")
    if not isinstance(drive, bool):
        raise TypeError(f"drive: expected True or False, got {drive!r}")
    if drive and feed is None:
        raise ValueError("drive: expected a feed to drive, got none")
    limits = DriveLimits(max_linear, max_angular, lease)
    library = Library([recordings] if isinstance(recordings, (str, os.PathLike)) else recordings)
    if feed is None and not library:
        raise ValueError("assistant(): expected a feed or recordings, got neither")
    try:
        from .http import HttpServer
        from .server import AssistantServer
    except ModuleNotFoundError as error:
        raise ImportError(MISSING) from error
    if feed is not None:
        feed.connection.check_open()
    server = AssistantServer(library, feed, limits if drive else None, code=False)
    try:
        return Assistant(server, HttpServer(server, port))
    except BaseException:
        server.close()
        raise
