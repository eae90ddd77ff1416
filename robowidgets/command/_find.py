"""The command ``robowidgets find``: the spans of a recording in which conditions held."""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Callable, Iterable
from functools import reduce
from math import degrees
from operator import and_, or_
from typing import Any

import robowidgets

from .. import fleet
from ..files.remote import is_url
from ..laser.row import LASER
from ..recordings.search import conditions
from ..recordings.search.base import Condition
from ..recordings.search.comparison import compared
from ..recordings.search.spans import Spans, rounded_text
from ..recordings.topics import UnnamedTopicError
from ..runtime.text import many
from ..samples.checks import DEGREES, OF_DEGREES
from ..samples.sector import ALL_ROUND, SECTORS, SectorLike, to_sector
from ..speed.row import SPEED
from ..touch.row import TOUCH
from ._cut import in_options
from ._error import CommandError

FOUND, NONE, INTERRUPTED = 0, 1, 130

_LOOKS_AT = {"nearest_below": LASER, "speed_above": SPEED, "touched": TOUCH}
"""The kind of topic that a condition reads."""

_USED_BY = {
    "sector": "nearest_below",
    "axis": "speed_above",
    "silent": "gap",
    "level": "event",
    "text": "event",
    **{kind.sample_name: condition for condition, kind in _LOOKS_AT.items()},
}
"""The condition that an option belongs to."""

_GIVES = {
    "--touched": "label",
    "--nearest-below": "distance",
    "--sector": "sector",
    "--speed-above": "limit",
    "--axis": "axis",
    "--gap": "seconds",
    "--level": "level",
    "--field": "field",
}
"""The argument of a condition that an option sets."""

_NAMED_BY: dict[str | None, str] = {
    None: "--silent",
    **{kind.name: f"--{kind.sample_name}" for kind in _LOOKS_AT.values()},
}
"""The option that names a topic of a kind. None stands for the topic with a gap."""


_WITH_OR_WITHOUT: dict[str, Any] = {"nargs": "?", "const": "", "action": "append", "default": []}
"""The settings of an option that may be given several times, with or without a word."""


def add_find(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``robowidgets find``, except its file."""
    add_conditions(parser)
    parser.add_argument(
        "--json",
        action="store_true",
        help="print a list of spans as JSON, times in seconds; for several recordings, a line for each span",
    )
    parser.add_argument("--cut", metavar="FOLDER", help="also write each span as an MCAP file into this folder")
    parser.add_argument(
        "--around", type=float, metavar="SECONDS", help="write so much before and after each span (default: 2)"
    )
    parser.add_argument("--force", action="store_true", help="replace existing files in the folder of --cut")


def add_conditions(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of a condition, and of the topics that it reads."""
    asked = parser.add_argument_group("conditions (all must hold)")
    asked.add_argument(
        "--touched",
        **_WITH_OR_WITHOUT,
        metavar="SENSOR",
        help="this sensor is touched; without SENSOR, any sensor; may be given again for another",
    )
    asked.add_argument("--nearest-below", type=float, metavar="METRES", help="a ray is shorter than this")
    asked.add_argument("--speed-above", type=float, metavar="SPEED", help="the speed, without its sign, is above this")
    asked.add_argument("--gap", type=float, metavar="SECONDS", help="no message came for longer than this")
    asked.add_argument(
        "--field",
        action="append",
        default=[],
        metavar="COMPARISON",
        help="a comparison of a field of any topic, such as '/imu.linear_acceleration.x > 12', by <, <=, >, >=, == or "
        "!=, with a number, true, false or a text; abs(/imu.angular_velocity.z) is the absolute value; may be given "
        "again for another",
    )
    asked.add_argument(
        "--event",
        **_WITH_OR_WITHOUT,
        metavar="TOPIC",
        help="a log message, a change of a status, or a press; without TOPIC, on any topic with events",
    )
    asked.add_argument(
        "--label",
        **_WITH_OR_WITHOUT,
        metavar="NAME",
        help="a span with this label; without NAME, with any label",
    )
    asked.add_argument("--any", action="store_true", help="at least one of the conditions must hold instead of all")
    how = parser.add_argument_group("where to look")
    how.add_argument(
        "--sector",
        type=_angle,
        nargs=2,
        metavar=("FROM", "TO"),
        help="only rays between these angles, counter-clockwise, in radians, or degrees as in -30deg 30deg; or a name: "
        f"{', '.join(SECTORS)} (default: all)",
    )
    how.add_argument("--level", help="lowest level of the event: DEBUG, INFO, WARN, ERROR or FATAL (default: any)")
    how.add_argument("--text", metavar="WORDS", help="part of the text or the source of the event, ignoring case")
    how.add_argument("--axis", help="axis of the speed (default: linear.x; angular.z is yaw)")
    for name in (kind.sample_name for kind in _LOOKS_AT.values()):
        how.add_argument(f"--{name}", metavar="TOPIC", help=f"the topic of the {name} (default: the only one)")
    how.add_argument(
        "--silent", metavar="TOPIC", help="the topic with a gap (default: any of scans, measured speeds or sonars)"
    )
    add_topics(how)


def add_topics(parser: Any) -> None:
    """Add the argument for the topics to use in several recordings."""
    parser.add_argument(
        "--topics",
        action="append",
        default=[],
        metavar="PATTERN",
        help="for several recordings: name or pattern, such as '/front*', of the topics to use",
    )


def _is_there(word: str) -> bool:
    return is_url(word) or os.path.exists(word)


_TAKE_A_WORD = ["--touched"], ["--event"], ["--label"]
"""Options with an optional word after them."""


def readable(words: Iterable[str]) -> list[str]:
    """Return the words of a command in a form that argparse reads as intended.

    Without changes, argparse reads ``-30deg`` as an option unless a space precedes it, requires two words after
    ``--sector``, and reads a file after ``--touched`` as a sensor, after ``--event`` as a topic, and after ``--label``
    as a name.
    """
    read: list[str] = []
    given = list(words)
    for word, after in zip(given, [*given[1:], ""], strict=False):
        if read[-1:] in _TAKE_A_WORD and _is_there(word) and not any(map(_is_there, read[1:])):
            read.insert(1, word)
            continue
        if read[-1:] == ["--sector"] and word.isalpha() and not DEGREES.fullmatch(after):
            read.append(word)
        read.append(f" {word}" if DEGREES.fullmatch(word) else word)
    return read


def _angle(word: str) -> float | str:
    try:
        return float(word)
    except ValueError:
        return word.strip()


def _sector(words: list[Any] | None) -> SectorLike:
    if not words:
        return ALL_ROUND
    if words[0] == words[1] and str(words[0]).isalpha():
        return str(words[0])
    try:
        return to_sector(words)
    except TypeError as error:
        raise CommandError(_in_options(str(error))) from None


def condition(arguments: argparse.Namespace) -> Condition:
    """Return the condition that the arguments describe.

    Raises:
        CommandError: they contain no condition, or an option that no condition uses.
        ValueError: an argument is invalid.
    """
    asked: list[Condition] = [conditions.touched(label or None, arguments.touch) for label in arguments.touched]
    if arguments.nearest_below is not None:
        asked.append(conditions.nearest_below(arguments.nearest_below, _sector(arguments.sector), arguments.scan))
    if arguments.speed_above is not None:
        asked.append(conditions.speed_above(arguments.speed_above, arguments.axis or "linear.x", arguments.speed))
    if arguments.gap is not None:
        asked.append(conditions.gap(arguments.gap, arguments.silent))
    asked += map(_compared, arguments.field)
    asked += (conditions.event(topic or None, arguments.level, arguments.text) for topic in arguments.event)
    asked += map(_labelled, arguments.label)
    if not asked:
        raise CommandError(
            "find: expected a condition: --touched, --nearest-below, --speed-above, --gap, --field, --event or --label"
        )
    _check_used(arguments)
    return reduce(or_ if arguments.any else and_, asked)


def condition_options(arguments: argparse.Namespace) -> list[str]:
    """Return the options of conditions that were given."""
    names = (*_LOOKS_AT, "gap", "field", "event", "label", "any", *_USED_BY)
    return [f"--{name.replace('_', '-')}" for name in names if getattr(arguments, name) not in (None, [], False)]


def _compared(words: str) -> Condition:
    try:
        return compared(words)
    except ValueError as error:
        raise CommandError(f"find: --field: {error}") from None


def _labelled(name: str) -> Condition:
    try:
        return conditions.label(name or None)
    except ValueError as error:  # it begins with "label: "
        raise CommandError(f"find: --{error}") from None


def _check_used(arguments: argparse.Namespace) -> None:
    for name, user in _USED_BY.items():
        unused = getattr(arguments, name) is not None and getattr(arguments, user) in (None, [])
        if unused:
            raise CommandError(f"find: --{name} needs --{user.replace('_', '-')}, which is missing")


def find(arguments: argparse.Namespace, warn: Callable[[str], None]) -> tuple[str, int]:
    """Return the output of ``robowidgets find``, and its exit code: 0 with spans, 1 without, 130 if interrupted.

    ``warn`` receives a line for each problem of the recording.

    Raises:
        CommandError: the condition is invalid.
        RecordingError: the recording cannot be read, or does not have the topic.
    """
    if not arguments.cut and (arguments.around is not None or arguments.force):
        raise CommandError("find: --around and --force need --cut, which is missing")
    file = None if fleet.is_index(arguments.files) else fleet.the_only(arguments.files)
    if file is None or arguments.topics or arguments.cut:
        return _find_in_many(arguments, warn)
    with robowidgets.open(file) as recording:
        try:
            spans = recording.find(condition(arguments))
        except (TypeError, ValueError) as error:
            raise CommandError(_in_options(str(error))) from None
        except UnnamedTopicError as error:
            option = _NAMED_BY[error.widget]
            raise CommandError(f"{error.there}: name the topic, as in {option} {error.topics[0]}") from None
        finally:
            # Also after an error, because damage of the recording may have caused it.
            for line in recording.losses:
                warn(f"! {line}")
    code = (FOUND if spans else NONE) if spans.is_complete else INTERRUPTED
    if arguments.json:
        return _spans_as_json(spans), code
    return _spans_as_text(spans, heads_of(arguments)), code


def _find_in_many(arguments: argparse.Namespace, warn: Callable[[str], None]) -> tuple[str, int]:
    try:
        if fleet.is_index(arguments.files):
            if arguments.topics:
                raise CommandError("find: an index has fixed topics: give --topics to robowidgets index instead")
            hits = fleet.drives(arguments.files[0]).find(condition(arguments))
        else:
            hits = fleet.find(condition(arguments), *arguments.files, topics=arguments.topics)
    except (TypeError, ValueError) as error:
        raise CommandError(_in_options(str(error))) from None
    for one in hits.unread:
        warn(f"! {one.file}: {one.problem}")
    for file, lines in hits.problems.items():
        for line in lines:
            warn(f"! {file}: {line}")
    if len(hits.unread) == len(hits.files):
        raise CommandError("none of these recordings could be searched")
    code = (FOUND if hits else NONE) if hits.is_complete else INTERRUPTED
    if arguments.cut and hits:
        _cut(hits, arguments, warn)
    if arguments.json:
        return hits.to_json(), code
    heads = heads_of(arguments)
    stopped = [] if hits.is_complete else [f"# stopped after {hits.until} of {len(hits.files)} files"]
    return "\n".join(
        ["# " + "\t".join(["file", "topic", *heads]), *(line_of(hit, heads) for hit in hits), *stopped]
    ), code


def _cut(hits: fleet.Hits, arguments: argparse.Namespace, warn: Callable[[str], None]) -> None:
    try:
        around = 2.0 if arguments.around is None else arguments.around
        written = hits.to_mcap(arguments.cut, around=around, overwrite=arguments.force)
    except ValueError as error:
        raise CommandError(f"find: --{error}") from None
    except FileExistsError as error:
        raise FileExistsError(in_options(str(error))) from None
    warn(f"Wrote {many(len(written), 'file')} into {arguments.cut}")


def _in_options(error: str) -> str:
    """Replace the argument of a condition in an error by the name of its option."""
    argument, colon, what = error.partition(":")
    option = next((option for option, gives in _GIVES.items() if gives == argument), argument)
    return f"find: {option}{colon}{what.replace(OF_DEGREES, 'degrees are written as -30deg')}"


_COLUMNS: dict[str, Callable[[Any], str]] = {
    "start": "{:.3f}".format,
    "end": "{:.3f}".format,
    "seconds": "{:.3f}".format,
    "nearest": "{:g}".format,
    "index": "{}".format,
    "angle": lambda angle: f"{degrees(angle):.2f}",
    "value": lambda value: rounded_text(value, 10),
    "silent": ", ".join,
}
"""The columns of a span by its attributes, with their formats; angles in degrees."""


def heads_of(arguments: argparse.Namespace) -> list[str]:
    """Return the columns that the conditions fill."""
    left_out = set()
    if arguments.nearest_below is None:
        left_out |= {"nearest", "index", "angle"}
    if arguments.speed_above is None and not arguments.field:
        left_out.add("value")
    if arguments.gap is None:
        left_out.add("silent")
    return [head for head in _COLUMNS if head not in left_out]


def line_of(hit: fleet.Hit, heads: Iterable[str]) -> str:
    """Return the line of a span in one of several recordings."""
    return "\t".join([hit.file, hit.topic, *(_text(hit, head) for head in heads)])


def _spans_as_text(spans: Spans, heads: list[str]) -> str:
    lines = ["\t".join(_text(span, head) for head in heads) for span in spans]
    stopped = [] if spans.is_complete else [f"# stopped at {spans.until:.3f}: the rest was not searched"]
    return "\n".join(["# " + "\t".join(heads), *lines, *stopped])


def _text(span: Any, head: str) -> str:
    value = getattr(span, head)
    return "" if value is None else _COLUMNS[head](value)


def _spans_as_json(spans: Spans) -> str:
    return json.dumps(
        {
            "condition": spans.condition,
            "complete": spans.is_complete,
            "spans": [span._asdict() for span in spans],
            "problems": list(spans.problems),
        },
        indent=2,
    )
