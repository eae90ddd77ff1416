"""The command ``robowidgets mcp``: recordings and a running robot for assistants."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ._error import CommandError

if TYPE_CHECKING:
    from ..feeds import Feed

_FEEDS = {
    "simulator": "", "foxglove": "address", "rosbridge": "address", "ros1": "", "ros2": "domain_id", "dds": "domain",
    "zenoh": "locator",
}  # fmt: skip
"""The feeds by name, with the argument that the word after the name gives, or empty."""

TOKEN = "ROBOWIDGETS_MCP_TOKEN"
"""The environment variable with the token for HTTP; a new one is made and printed without it."""


def add_mcp(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "files", nargs="*", metavar="FILE", help="recordings, and folders of recordings, that the assistant may read"
    )
    robot = parser.add_argument_group("a running robot")
    robot.add_argument(
        "--feed",
        nargs="+",
        metavar=("KIND", "ADDRESS"),
        help=f"{', '.join(_FEEDS)}; with the address of a bridge or of a Zenoh router, as in --feed foxglove "
        "ws://robot:8765, or with the number of the domain of ros2 and dds",
    )
    robot.add_argument("--drive", action="store_true", help="let the assistant drive, within the limits below")
    robot.add_argument("--max-linear", type=float, metavar="M/S", help="its limit (default: 0.2)")
    robot.add_argument("--max-angular", type=float, metavar="RAD/S", help="its limit (default: 0.5)")
    robot.add_argument(
        "--lease", type=float, metavar="SECONDS", help="a command ends after these, at most 30 (default: 5)"
    )
    robot.add_argument("--topic", metavar="TOPIC", help="the topic on which speeds are sent (default: /cmd_vel)")
    how = parser.add_argument_group("how it is served")
    how.add_argument(
        "--code",
        action="store_true",
        help="run Python that the assistant sends, with your rights, in another process (tools lines and simulate)",
    )
    how.add_argument(
        "--http",
        nargs="?",
        type=int,
        const=0,
        metavar="PORT",
        help=f"serve on this port of 127.0.0.1, 0 for any free one, with the token in {TOKEN} or a new one "
        "(default: stdin and stdout)",
    )


def serve(arguments: argparse.Namespace, warn: Callable[[str], None]) -> None:
    """Serve until the client is gone, or until an interrupt.

    Raises:
        CommandError: the arguments do not fit, or a package is missing. OSError: a file is missing, or a port is taken.
    """
    # Imported here: the other commands need no feeds.
    from .. import feeds
    from ..assistants import MISSING, DriveLimits
    from ..assistants.library import Library

    given = {"max_linear": arguments.max_linear, "max_angular": arguments.max_angular, "lease": arguments.lease}
    limits = {name: value for name, value in given.items() if value is not None}
    if (limits or arguments.topic) and not arguments.drive:
        raise CommandError("mcp: limits need --drive, which is missing: without it the assistant only looks")
    if arguments.drive and not arguments.feed:
        raise CommandError("mcp: --drive needs --feed, the robot to drive")
    if not (arguments.files or arguments.feed or arguments.code):
        raise CommandError("mcp: expected recordings or folders of them, or --feed, or --code")
    try:
        drive = DriveLimits(**limits) if arguments.drive else None
        library = Library(arguments.files)
    except (TypeError, ValueError) as error:
        raise CommandError(f"mcp: {error}") from None
    try:
        from ..assistants.http import HttpServer
        from ..assistants.server import AssistantServer
    except ModuleNotFoundError as error:
        raise CommandError(f"mcp: {MISSING}") from error
    feed = _opened(arguments.feed) if arguments.feed else None
    server = None
    try:
        if feed is not None and arguments.topic:
            feed.driving = feeds.Driving(topic=arguments.topic)
        server = AssistantServer(library, feed, drive, code=arguments.code)
        if arguments.http is None:
            server.run("stdio")
            return
        try:
            served = HttpServer(server, arguments.http, os.environ.get(TOKEN, ""))
        except ValueError as error:
            raise CommandError(f"mcp: --http: {error}") from None
        warn(f"{served.url}\nAuthorization: Bearer {served.token}")
        served.run()
    finally:
        if server is not None:
            server.close()
        if feed is not None:
            feed.close()


def _opened(words: list[str]) -> Feed:
    from .. import feeds

    name, *rest = words
    if name not in _FEEDS:
        raise CommandError(f"mcp: --feed: expected one of {', '.join(_FEEDS)}, got {name!r}")
    argument = _FEEDS[name]
    if len(rest) > 1 or (rest and not argument):
        said = f"expected {'one word' if argument else 'nothing'} after it, got {' '.join(rest)}"
        raise CommandError(f"mcp: --feed {name}: {said}; recordings come before --feed")
    value: dict[str, Any] = {}
    if rest:
        try:
            value = {argument: int(rest[0]) if argument.startswith("domain") else rest[0]}
        except ValueError:
            raise CommandError(f"mcp: --feed {name}: expected the number of a domain, got {rest[0]!r}") from None
    try:
        opened: Feed = getattr(feeds, name)(**value)
    except (TypeError, ValueError, feeds.FeedError) as error:
        raise CommandError(f"mcp: --feed {name}: {error}") from None
    return opened
