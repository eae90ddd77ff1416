"""The command ``robowidgets lessons``: the lessons in a language, as assignments, and how far a class is."""

from __future__ import annotations

import argparse
import os
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

    instead.add_argument(
        "--grade",
        action="store_true",
        help="run the answers in FOLDER, each submission in a process of its own, and mark them; then as --summary",
    )
    parser.add_argument(
        "--user", help="with --grade, as root: the user as whom answers run, who should have no rights, such as nobody"
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


def grade(arguments: argparse.Namespace, say: Callable[[str], None]) -> int:
    """Mark what was handed in, and print how far the class is; returns 1 when something could not be read or run."""
    if not arguments.folder.is_dir():
        raise CommandError(f"--grade: there is no folder {str(arguments.folder)!r}; name the one with the submissions")
    if arguments.user is not None and (not hasattr(os, "geteuid") or os.geteuid() != 0):
        raise CommandError("--user: only root may run answers as another user; see the page on grading for a container")
    try:
        lessons.grade(arguments.folder, user=arguments.user, tell=say)
    except (KeyError, PermissionError) as error:
        raise CommandError(f"--user: answers cannot run as {arguments.user!r}: {error}") from None
    say("")
    return print_summary(arguments, say)


def print_summary(arguments: argparse.Namespace, say: Callable[[str], None]) -> int:
    """Print how far a class is, and write it as a page; returns 1 when a file could not be read."""
    try:
        found = lessons.summary(arguments.folder)
    except ValueError as error:  # the marks are damaged
        raise CommandError(f"{error}; robowidgets lessons --grade {arguments.folder} writes them again") from None
    page = arguments.folder / PAGE
    found.to_html(page)
    say(str(found))
    say(f"\nAs a page, with the answers of those who are stuck: {page}")
    return 1 if found.problems else 0
