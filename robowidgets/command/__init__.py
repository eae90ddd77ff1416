"""The command ``robowidgets``: open the tour, the lessons or a recording, and search, check or convert recordings."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable, Sequence
from io import TextIOWrapper
from pathlib import Path

import robowidgets

from .. import fleet
from ..files.remote import is_url, named, pass_secrets
from . import _lab, _lessons, _notebooks
from ._cut import add_cut, cut
from ._error import CommandError
from ._export import add_export, export
from ._find import INTERRUPTED, add_conditions, add_find, find, readable
from ._follow import add_follow, check_unused, follow, taken_columns
from ._mcp import add_mcp, serve


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command with some arguments.

    Returns:
        0 on success. On a failure, 1, or 2 for the commands below, after one line on stderr with the reason. ``find``
        is like grep: 1 if nothing was found, 2 on a failure. ``doctor`` is like diff: 1 if it found problems, 2 on a
        failure. ``index``, ``repair``, ``cut`` and ``export`` return 2 on a failure. Invalid arguments exit with 2.
    """
    if isinstance(sys.stdout, TextIOWrapper) and sys.stdout.errors == "strict":
        # On Windows, the encoding of a file, as in `> class.txt`, lacks some characters.
        sys.stdout.reconfigure(errors="replace")
    arguments = _parser().parse_args(readable(sys.argv[1:] if argv is None else argv))
    try:
        return int(arguments.do(arguments) or 0)
    except (robowidgets.RecordingError, CommandError, OSError) as error:
        _warn(f"robowidgets: {error}")
        return int(arguments.failed)
    except KeyboardInterrupt:
        return INTERRUPTED


def _open_tour(arguments: argparse.Namespace) -> None:
    _in_lab(_notebooks.copy_shipped, arguments)


def _open_recording(arguments: argparse.Namespace) -> None:
    file = named(arguments.file) if is_url(arguments.file) else Path(os.path.abspath(arguments.file))
    with robowidgets.open(file):
        pass
    if is_url(file):
        pass_secrets(file)
    _in_lab(lambda folder: _notebooks.write_for(file, folder), arguments)


def _print_info(arguments: argparse.Namespace) -> int:
    file = fleet.the_only(arguments.files)
    if file is None:
        return _print_many(fleet.summary(*arguments.files), arguments)
    with robowidgets.open(file) as recording:
        recording.check_topics()
        facts = {
            "path": recording.url or str(recording.path),
            "start_ns": recording.start_ns,
            "seconds": recording.duration,
            "topics": [topic._asdict() for topic in recording.topics],
            "problems": list(recording.problems),
        }
        _say(json.dumps(facts, indent=2) if arguments.json else recording.info())
    return 0


def _print_many(found: fleet.Summary | fleet.CheckUp, arguments: argparse.Namespace) -> int:
    """Print the table of many recordings; CommandError if none of them could be read."""
    if len(found.unread) == len(found.files):
        for one in found.unread:
            _warn(f"! {one.file}: {one.problem}")
        raise CommandError("none of these recordings could be read")
    _say(found.to_json() if arguments.json else str(found))
    return 0 if found.is_complete else INTERRUPTED


def _print_spans(arguments: argparse.Namespace) -> int:
    text, code = find(arguments, _warn)
    _say(text)
    return code


def _print_report(arguments: argparse.Namespace) -> int:
    file = fleet.the_only(arguments.files)
    if file is None:
        found = fleet.doctor(*arguments.files)
        return _print_many(found, arguments) or (1 if found.kinds or found.unread else 0)
    with robowidgets.open(file) as recording:
        report = recording.doctor()
    _say(json.dumps(report.to_dict(), indent=2) if arguments.json else str(report))
    return 1 if report.problems else 0


def _write_index(arguments: argparse.Namespace) -> int:
    if arguments.follow:
        return follow(arguments, _say, _warn)
    columns = taken_columns(arguments)
    check_unused(arguments)
    try:
        _say(str(fleet.index(*arguments.files, output=arguments.output, topics=arguments.topics, fields=columns)))
    except (ImportError, ValueError) as error:
        raise CommandError(f"index: {error}") from None
    return 0


def _write_repaired(arguments: argparse.Namespace) -> None:
    # Imported here: the other commands need not wait for mcap.
    from ._repair import repair

    for line in repair(arguments.file, arguments.output, force=arguments.force):
        _say(line)


def _write_cut(arguments: argparse.Namespace) -> None:
    _say(cut(arguments))


def _write_page(arguments: argparse.Namespace) -> None:
    _say(export(arguments, _warn))


def _serve_assistants(arguments: argparse.Namespace) -> None:
    serve(arguments, _warn)


def _do_lessons(arguments: argparse.Namespace) -> int:
    if arguments.grade:
        return _lessons.grade(arguments, _say)
    if arguments.user is not None:
        raise CommandError("--user names the user that runs the answers: use it with --grade")
    if arguments.summary:
        return _lessons.print_summary(arguments, _say)
    if arguments.grader:
        _lessons.print_assignments(arguments, _say)
        return 0
    language = _lessons.language_of(arguments)

    def copy(folder: Path) -> Path:
        if arguments.language:
            for notebook, other in _notebooks.in_others(folder, language):
                _say(f"{notebook} exists in {other!r} and stays unchanged; name another folder for {language!r}")
        return _notebooks.copy_shipped(folder, _notebooks.LESSON, language)

    _in_lab(copy, arguments, runs_cells=False)
    return 0


def _in_lab(make_notebook: Callable[[Path], Path], arguments: argparse.Namespace, *, runs_cells: bool = True) -> None:
    if not _lab.is_installed():
        raise CommandError('JupyterLab is not installed here; type: pip install "robowidgets[lab]"')
    folder = arguments.folder.absolute()
    if folder.exists() and not folder.is_dir():
        raise NotADirectoryError(f"--folder: {arguments.folder} is a file; name a folder for the notebooks")
    folder.mkdir(parents=True, exist_ok=True)
    notebook = make_notebook(folder)
    _say(f"Opening {notebook} in JupyterLab. It is your copy: you can change and save it. Ctrl-C ends JupyterLab.")
    if runs_cells:
        _say("Running its cells first, so that their widgets are live when the page opens ...")
    _lab.run(notebook, arguments.port, arguments.browser, _say, runs_cells=runs_cells)


def _say(text: str) -> None:
    try:
        print(text, flush=True)
    except BrokenPipeError:
        # The reader, such as `head`, has ended. Python must not flush the rest at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _warn(line: str) -> None:
    print(line, file=sys.stderr)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="robowidgets", description="The hard data of a robot's sensors, live in the notebook."
    )
    parser.add_argument("--version", action="version", version=f"robowidgets {robowidgets.__version__}")
    parser.set_defaults(failed=1)
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)

    demo = commands.add_parser("demo", help="open a tour in JupyterLab", description="Open a tour in JupyterLab.")
    demo.set_defaults(do=_open_tour)
    show = commands.add_parser(
        "open", help="open a recording in JupyterLab", description="Open a recording in JupyterLab."
    )
    show.set_defaults(do=_open_recording)
    lessons = commands.add_parser(
        "lessons",
        help="open the lessons in JupyterLab, or show the progress of a class",
        description="Open the lessons in JupyterLab, write them as assignments, or show the progress of a class.",
        epilog="With --summary it exits with 1 if a file in the folder could not be read.",
    )
    _lessons.add_lessons(lessons)
    lessons.set_defaults(do=_do_lessons)
    info = commands.add_parser(
        "info",
        help="print the contents of a recording",
        description="Print topics, types, counts and rates; for several recordings, a line for each.",
    )
    info.set_defaults(do=_print_info)
    spans = commands.add_parser(
        "find",
        help="print when conditions held in a recording",
        description="Print the spans in which conditions held, in seconds from the start of the recording.",
        epilog="Exits with 0 if something was found, 1 if nothing was found, 2 on a failure.",
    )
    add_find(spans)
    spans.set_defaults(do=_print_spans, failed=2)

    doctor = commands.add_parser(
        "doctor",
        help="print the problems of a recording, and what to do about them",
        description="Check the scans of a recording (rays, angles, limits, frames), its rates, and its topics.",
        epilog="Exits with 0 without problems, 1 with problems, 2 on a failure.",
    )
    doctor.set_defaults(do=_print_report, failed=2)

    seconds = commands.add_parser(
        "index",
        help="write an index of many recordings, second by second, for fast searches",
        description="Summarize each second of recordings in a Parquet file, for fast searches with find and SQL.",
        epilog="Recordings in an earlier index with this name are read again only if they changed, or if the topics or "
        "fields differ. --field NAME without a comparison adds the values of that field, so that find needs no "
        "recordings for it. With --follow it exits with 0 if something was found, 1 if nothing was found.",
    )
    seconds.add_argument("-o", "--output", required=True, metavar="OUT.parquet", help="the file to write")
    add_conditions(seconds)
    add_follow(seconds)
    seconds.set_defaults(do=_write_index, failed=2)

    mend = commands.add_parser(
        "repair",
        help="write a damaged recording as an MCAP file that every tool reads",
        description="Write all readable messages of a recording as an MCAP file, with times that never go back.",
        epilog="Exits with 0 if the file was written, 2 on a failure.",
    )
    mend.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="OUT.mcap",
        help="the file to write (default: FILE_repaired.mcap in the folder of FILE)",
    )
    mend.add_argument("--force", action="store_true", help="replace an existing file")
    mend.set_defaults(do=_write_repaired, failed=2)

    part = commands.add_parser(
        "cut",
        help="write a part of a recording as an MCAP file",
        description="Write a part of a recording as an MCAP file: all topics, unchanged, after fixed transforms and "
        "latched messages. To write what was found, see find --cut.",
        epilog="Exits with 0 if the file was written, 2 on a failure.",
    )
    add_cut(part)
    part.set_defaults(do=_write_cut, failed=2)

    page = commands.add_parser(
        "export",
        help="write a recording as a page that plays anywhere",
        description="Write a recording, or a part of it, as one HTML file that plays without a kernel or the web.",
        epilog="Exits with 0 if the file was written, 2 on a failure.",
    )
    add_export(page)
    page.set_defaults(do=_write_page, failed=2)

    assistants = commands.add_parser(
        "mcp",
        help="let an assistant see recordings and a robot, by the Model Context Protocol",
        description="Serve recordings and a robot to an assistant, over stdin and stdout, or over HTTP with a token.",
        epilog="It only looks, unless --drive lets it drive.",
    )
    add_mcp(assistants)
    assistants.set_defaults(do=_serve_assistants, failed=2)

    of_file = "a .bag, .db3, .mcap, a rosbag2 folder, a CARMEN log (.log, .clf, gzipped too), or its URL"
    for command in (show, mend, part, page):
        command.add_argument("file", type=_file, metavar="FILE", help=of_file)
    for command in (info, spans, doctor, seconds):
        command.add_argument(
            "files",
            nargs="+",
            metavar="FILE",
            help=f"{of_file}; or several, folders with recordings at any depth, and patterns such as 'runs/*.mcap'",
        )
    for command in (info, doctor):
        command.add_argument("--json", action="store_true", help="print it as JSON")
    for command in (demo, lessons, show):
        command.add_argument(
            "--port", type=_port, help="port on 127.0.0.1, 0 for any free one (default: the first free one from 8888)"
        )
        command.add_argument(
            "--no-browser", dest="browser", action="store_false", help="only print the address, open no browser"
        )
    for command in (demo, show):
        command.add_argument(
            "--folder",
            type=Path,
            default=Path(_notebooks.FOLDER),
            help=f"folder for the notebooks (default: {_notebooks.FOLDER}); existing files stay unchanged",
        )
    return parser


def _file(text: str) -> Path | str:
    return text if is_url(text) else Path(text)


def _port(text: str) -> int:
    if not text.isdecimal() or int(text) > 65535:
        raise argparse.ArgumentTypeError(f"expected a number from 0 to 65535, got {text!r}")
    return int(text)
