"""The command ``robowidgets lessons``: the lessons in a language, as assignments, and how far a class is."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from .. import lessons
from . import _assignments, _notebooks
from ._error import CommandError

PAGE = "summary.html"


def add_lessons(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument(
        "folder",
        type=Path,
        nargs="?",
        default=Path(_notebooks.LESSONS_FOLDER),
        metavar="FOLDER",
        help=f"folder for the lessons (default: {_notebooks.LESSONS_FOLDER}); what is there already stays as it is",
    )
    parser.add_argument(
        "--language",
        help=f"of the lessons and their checks: {', '.join(lessons.languages())} (default: {lessons.ENGLISH})",
    )
    instead = parser.add_mutually_exclusive_group()
    instead.add_argument(
        "--for",
        dest="grader",
        choices=["nbgrader"],
        help="write the lessons as assignments, without solutions, into FOLDER/source of a course",
    )
    instead.add_argument(
        "--summary",
        action="store_true",
        help=f"print how far the students are whose reports are in FOLDER, and write it as a page (FOLDER/{PAGE})",
    )


def language_of(arguments: argparse.Namespace) -> str:
    """The language that is asked for; CommandError if no lesson is written in it."""
    language = lessons.ENGLISH if arguments.language is None else str(arguments.language)
    if language not in lessons.languages():
        raise CommandError(
            f"--language: no lesson is written in {language!r}; there are {', '.join(lessons.languages())}"
        )
    return language


def print_assignments(arguments: argparse.Namespace, say: Callable[[str], None]) -> None:
    """Write the assignments for nbgrader."""
    for line in _assignments.write_assignments(arguments.folder, language_of(arguments)):
        say(line)


def print_summary(arguments: argparse.Namespace, say: Callable[[str], None]) -> int:
    """Print how far a class is, and write it as a page; returns 1 when a file could not be read."""
    found = lessons.summary(arguments.folder)
    page = arguments.folder / PAGE
    found.to_html(page)
    say(str(found))
    say(f"\nAs a page, with the answers of those who are stuck: {page}")
    return 1 if found.problems else 0
