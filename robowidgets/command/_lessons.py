"""The command ``robowidgets lessons``: the lessons in a language, as assignments, and the progress of a class."""

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
        help=f"folder for the lessons (default: {_notebooks.LESSONS_FOLDER}); existing files stay unchanged",
    )
    parser.add_argument(
        "--language",
        help=f"language of the lessons and checks: {', '.join(lessons.languages())} (default: {lessons.ENGLISH})",
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
        help=f"print the progress of the students from their reports in FOLDER, and write it as FOLDER/{PAGE}",
    )

    instead.add_argument(
        "--grade",
        action="store_true",
        help="run the answers in FOLDER, each submission in a separate process, and mark them; then as --summary",
    )
    parser.add_argument(
        "--user",
        help="with --grade, as root: the user that runs the answers, best one without rights, such as nobody",
    )


def language_of(arguments: argparse.Namespace) -> str:
    """Return the requested language; CommandError if the lessons are not available in it."""
    language = lessons.ENGLISH if arguments.language is None else str(arguments.language)
    if language not in lessons.languages():
        raise CommandError(
            f"--language: the lessons are not available in {language!r}; choose one of {', '.join(lessons.languages())}"
        )
    return language


def print_assignments(arguments: argparse.Namespace, say: Callable[[str], None]) -> None:
    """Write the assignments for nbgrader."""
    for line in _assignments.write_assignments(arguments.folder, language_of(arguments)):
        say(line)


def grade(arguments: argparse.Namespace, say: Callable[[str], None]) -> int:
    """Mark the submissions, and print the progress of the class. Return 1 if something could not be read or run."""
    if not arguments.folder.is_dir():
        raise CommandError(f"--grade: {str(arguments.folder)!r} is not a folder; expected the one with the submissions")
    if arguments.user is not None and (not hasattr(os, "geteuid") or os.geteuid() != 0):
        raise CommandError("--user: only root may run answers as another user; see the page on grading for a container")
    try:
        lessons.grade(arguments.folder, user=arguments.user, tell=say)
    except (KeyError, PermissionError) as error:
        raise CommandError(f"--user: answers cannot run as {arguments.user!r}: {error}") from None
    say("")
    return print_summary(arguments, say)


def print_summary(arguments: argparse.Namespace, say: Callable[[str], None]) -> int:
    """Print the progress of a class, and write it as a page. Return 1 if a file could not be read."""
    try:
        found = lessons.summary(arguments.folder)
    except ValueError as error:  # the marks are damaged
        raise CommandError(f"{error}; robowidgets lessons --grade {arguments.folder} writes them again") from None
    page = arguments.folder / PAGE
    found.to_html(page)
    say(str(found))
    say(f"\nAs a page, with the answers of the students who are stuck: {page}")
    return 1 if found.problems else 0
