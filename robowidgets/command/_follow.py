"""The command ``robowidgets index --follow``: a line for each new hit in a folder that grows."""

from __future__ import annotations

import argparse
from collections.abc import Callable

from .. import fleet
from ..runtime.text import many
from ._error import CommandError
from ._find import FOUND, NONE, condition, condition_options, heads_of, line_of

_OPTIONS = ("--json", "--every", "--first")


def add_follow(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``robowidgets index`` that belong to ``--follow``, except the conditions."""
    watch = parser.add_argument_group("watching")
    watch.add_argument(
        "--follow",
        action="store_true",
        help="go on, index new recordings as soon as they are whole, and print a line for each span in them in which "
        "the conditions hold; Ctrl-C ends it",
    )
    watch.add_argument("--every", type=float, metavar="SECONDS", help="look so often (default: 5)")
    watch.add_argument("--first", action="store_true", help="end at the first recording with a span")
    watch.add_argument("--json", action="store_true", help="print each line as JSON")


def check_unused(arguments: argparse.Namespace) -> None:
    """Check that no option was given which only ``--follow`` uses; raise CommandError otherwise."""
    given = [option for option in _OPTIONS if getattr(arguments, option[2:])] + condition_options(arguments)
    if given:
        raise CommandError(f"index: {given[0]} needs --follow, which is missing; find searches an index")


def taken_columns(arguments: argparse.Namespace) -> list[str]:
    """Return the fields that were given without a comparison, and remove them from the conditions."""
    columns = [one for one in arguments.field if not set(one) & set("<>=!")]
    arguments.field = [one for one in arguments.field if one not in columns]
    return columns


def follow(arguments: argparse.Namespace, say: Callable[[str], None], warn: Callable[[str], None]) -> int:
    """Watch folders until an interrupt, or the first hit; return 0 if something was found, 1 if nothing was.

    Raises:
        CommandError: an argument is invalid. OSError: the index cannot be written.
    """
    columns = taken_columns(arguments)
    try:
        every = fleet.EVERY if arguments.every is None else arguments.every
        watched = fleet.follow(
            condition(arguments),
            *arguments.files,
            output=arguments.output,
            topics=arguments.topics,
            fields=columns,
            every=every,
        )
    except (CommandError, ImportError, TypeError, ValueError) as error:
        raise CommandError(f"index: {str(error).removeprefix('find: ')}") from None
    heads = heads_of(arguments)
    warn(f"Watching {', '.join(arguments.files)}; Ctrl-C ends it")
    if not arguments.json:
        say("# " + "\t".join(["file", "topic", *heads]))
    count = 0
    try:
        for hits in watched:
            for one in hits.unread:
                warn(f"! {one.file}: {one.problem}")
            for file, lines in hits.problems.items():
                for line in lines:
                    warn(f"! {file}: {line}")
            if text := hits.to_json() if arguments.json else "\n".join(line_of(hit, heads) for hit in hits):
                say(text)
            count += len(hits)
            if count and arguments.first:
                break
    except KeyboardInterrupt:
        warn(f"Ended: {many(count, 'span')} found; {arguments.output} has the recordings so far")
    return FOUND if count else NONE
