"""The command ``robowidgets cut``: a span of a recording as an MCAP file."""

from __future__ import annotations

import argparse
from math import inf
from pathlib import Path

import robowidgets

from ..runtime.text import megabytes
from ._error import CommandError


def add_cut(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of ``robowidgets cut``, except its file."""
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="OUT.mcap", help="the file to write")
    parser.add_argument("--start", type=float, metavar="SECONDS", help="from the start of the recording")
    parser.add_argument(
        "--end",
        type=float,
        metavar="SECONDS",
        help="from the start of the recording; not included, except at the end of the recording",
    )
    parser.add_argument("--force", action="store_true", help="replace an existing file")


def cut(arguments: argparse.Namespace) -> str:
    """Write the span, and return a line about the file.

    Raises:
        RecordingError: the recording cannot be read. OSError: the output exists, or cannot be written.
        CommandError: the span is not a span, or the name of the output does not end in .mcap.
    """
    with robowidgets.open(arguments.file) as recording:
        try:
            # A slice does not contain its end, but the length that `info` prints means all of the recording.
            is_all = arguments.end is not None and recording.duration <= arguments.end < inf
            part = recording[arguments.start : None if is_all else arguments.end]
            path = part.to_mcap(arguments.output, overwrite=arguments.force)
        except ValueError as error:
            text = in_options(str(error))
            dashes = "--" if text.startswith(("start:", "end:")) else ""
            raise CommandError(f"cut: {dashes}{text}") from None
        except FileExistsError as error:
            raise FileExistsError(in_options(str(error))) from None
    return f"Wrote {path}: {part}, {megabytes(path.stat().st_size)}"


def in_options(error: str) -> str:
    """Return the text of an error with the option of the command instead of the argument of the method."""
    return error.replace("to_mcap(): ", "").replace("give overwrite=True", "replace it with --force")
