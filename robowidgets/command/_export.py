"""The command ``robowidgets export``: a recording as a page that plays anywhere."""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Callable
from pathlib import Path

import robowidgets

from ..files.remote import file_name, is_url
from ..runtime.text import megabytes
from ._error import CommandError

_MEGA = 1_000_000
_OPTIONS = (
    ("start=,", "--start,"),
    ("end=)", "--end)"),
    ("every=", "--every "),
    ("start:", "--start:"),
    ("end:", "--end:"),
    ("every:", "--every:"),
    ("max_size above", "--max-size above"),
)


def add_export(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``robowidgets export``, except its file."""
    parser.add_argument("-o", "--output", type=Path, metavar="OUT.html", help="default: FILE.html, in this folder")
    parser.add_argument("--start", type=float, metavar="SECONDS", help="from the start of the recording")
    parser.add_argument("--end", type=float, metavar="SECONDS", help="from the start of the recording")
    parser.add_argument("--topic", action="append", default=[], metavar="TOPIC", help="show it; may be given again")
    parser.add_argument("--title", default="", help="title of the page (default: the name of the recording)")
    parser.add_argument("--note", default="", help="a text under the title")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="take only every n-th scan")
    parser.add_argument("--max-size", type=float, default=50, metavar="MB", help="refuse a larger file (default: 50)")
    parser.add_argument("--size", action="store_true", help="only print the approximate size of the file")
    parser.add_argument("--force", action="store_true", help="replace an existing file")


def export(arguments: argparse.Namespace, warn: Callable[[str], None]) -> str:
    """Write the page, and return a line about it. ``warn`` receives a line for each problem of the recording.

    Raises:
        RecordingError: the recording cannot be read, or does not have the topic.
        CommandError: the recording does not have the span, or the page would be too large.
        OSError: the file cannot be written, or already exists.
    """
    given = arguments.file
    name = file_name(given) if is_url(given) else Path(os.path.abspath(given)).name
    output = arguments.output or Path(f"{Path(name).stem or name}.html")
    part = {name: getattr(arguments, name) for name in ("start", "end", "every")} | {"topics": arguments.topic}
    with robowidgets.open(arguments.file) as recording:
        try:
            if arguments.size:
                return f"{output}: about {megabytes(recording.html_size(**part))}"
            if output.exists() and not arguments.force:
                raise FileExistsError(f"{output}: already exists; replace it with --force, or name another with -o")
            most = arguments.max_size * _MEGA
            path = recording.to_html(output, **part, title=arguments.title, note=arguments.note, max_size=most)
        except ValueError as error:
            raise CommandError(_in_options(str(error))) from None
        finally:
            for line in recording.problems:
                warn(f"! {line}")
    return f"Wrote {path}: {megabytes(path.stat().st_size)}"


def _in_options(error: str) -> str:
    """Replace the argument names of `Recording.to_html` in an error by the names of the options."""
    for given, option in _OPTIONS:
        error = error.replace(given, option)
    return re.sub(r"max_size=([\d_]+)", lambda found: f"--max-size {int(found[1]) // _MEGA}", error)
