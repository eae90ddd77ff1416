"""rosbag2 databases (.db3), read row by row and past damage, and never written."""

from __future__ import annotations

import os
import shutil
from array import array
from collections.abc import Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from shlex import quote
from tempfile import TemporaryDirectory
from threading import Lock
from typing import NamedTuple

from ..messages.channel import Channel, definition_text
from ..notebook.in_browser import NO_DATABASES
from ..notebook.progress import Progress
from ._byte_range import FileRange
from ._found_messages import MAX_PLACES, Damage, Walk
from ._report import HEAD, foreign
from .source import RecordingError

try:
    import sqlite3
except ModuleNotFoundError:  # in a browser, which opens all other files without it
    sqlite3 = None  # type: ignore[assignment,unused-ignore]

MAGIC = b"SQLite format 3\0"
_WALK = "SELECT rowid FROM messages WHERE rowid >= ? ORDER BY rowid"
_LOOK_UP = "SELECT topic_id, timestamp, data FROM messages WHERE rowid = ?"
_MAX_ROW = 2**62
_LOG_HEAD, _PAGE_HEAD = 32, 24
"""Bytes before the pages of a log, and before each page."""


def walk_sqlite(path: Path) -> Walk:
    """Find all readable messages of a rosbag2 database, which may be damaged.

    Files that a killed recorder left next to it (``-wal``, ``-journal``) are read too.

    Args:
        path: the file, with any suffix.

    Raises:
        RecordingError: the file cannot be opened, or is not a rosbag2 database.

    Source: the tables topics, messages and (since ROS 2 Iron) message_definitions of rosbag2_storage_sqlite3.
    """
    if sqlite3 is None:
        raise RecordingError(NO_DATABASES.format(name=path.name, quoted=quote(path.name)))
    with ExitStack() as stack:
        try:
            connection, damage = _connect(path, stack)
            _check_tables(connection, path.name)
            walk = _walk_rows(path, connection, damage)
        except sqlite3.Error as error:
            raise RecordingError(
                f"{path.name}: the database cannot be read ({error}): expected a rosbag2 .db3; "
                f"`sqlite3 {quote(path.name)} .recover` may save some of it"
            ) from None
        walk.close = stack.pop_all().close
        return walk


def files_beside(path: Path) -> list[Path]:
    """Return the files of a recorder next to a database (``-wal``, ``-journal``) that are read with it."""
    beside = [f"{path}{ending}" for ending in ("-wal", "-journal")]
    return [Path(file) for file in beside if os.path.isfile(file) and os.path.getsize(file)]


def _walk_rows(path: Path, connection: sqlite3.Connection, damage: Damage) -> Walk:
    rows, times, topics = array("q"), array("q"), array("q")
    with Progress(None, f"Reading {path.name}") as bar:
        for row in _rows(connection, damage):
            if message := _look_up(connection, row):
                rows.append(row)
                times.append(message.time_ns)
                topics.append(message.topic)
            else:
                damage.places += 1
            bar.update(1)
    channels = _channels(connection, damage)
    if damage.cut:
        damage.places = 0
    lock = Lock()

    def read(number: int) -> bytes:
        with lock:
            message = _look_up(connection, rows[number])
        if not message:
            raise RecordingError(f"{path.name}: is closed, or has changed since it was opened; open it again")
        return message.data

    hint = f", try `sqlite3 {quote(path.name)} .recover`"
    return Walk(path.name, path.stat().st_size, channels, times, topics, read, connection.close, damage, hint=hint)


def _connect(path: Path, stack: ExitStack) -> tuple[sqlite3.Connection, Damage]:
    """Return a connection, and the damage that is visible before any row is read.

    The file is opened read-only and immutable, so that sqlite creates no file next to it. In two cases a temporary copy
    is opened instead, which sqlite may change: to apply the files of a killed recorder (``-wal``, ``-journal``), and to
    drop an incomplete page at the end, whose missing bytes sqlite would read as zeros.

    Args:
        path: the file.
        stack: closes the connection and removes the copy.

    Raises:
        RecordingError: the file cannot be opened or copied, or is not a database.
        sqlite3.Error: sqlite cannot open it.
    """
    beside = files_beside(path)
    if beside:
        damage = Damage(unfinished=True)
        opened = _copy(path, beside, stack)
    else:
        size, page_size, pages = _sizes(path)
        damage = Damage(cut=size < pages * page_size)
        opened = path.absolute()
        if damage.cut and size % page_size:
            opened = _copy(path, [], stack)
            with opened.open("r+b") as copy:
                copy.truncate(size - size % page_size)
    connection = sqlite3.connect(
        f"{opened.as_uri()}{'?mode=ro&immutable=1' if not beside else ''}", uri=True, check_same_thread=False
    )
    stack.callback(connection.close)
    connection.text_factory = lambda raw: raw.decode("utf-8", errors="replace")
    # Without the first, sqlite refuses a file with missing pages; the others guard against a hostile file.
    for pragma in ("writable_schema = ON", "cell_size_check = ON", "trusted_schema = OFF"):
        connection.execute(f"PRAGMA {pragma}")
    damage.log = any(not _is_log_whole(file, connection) for file in beside if file.name.endswith("-wal"))
    return connection, damage


def _is_log_whole(log: Path, connection: sqlite3.Connection) -> bool:
    """Return True if sqlite reads all pages of a log (``-wal``) that belong to it.

    It silently ignores all pages from the first damaged one on, and a last transaction without an end. A log is
    overwritten from its start, so pages of earlier rounds, which have another salt, may follow its last page.

    Source: https://www.sqlite.org/fileformat2.html#the_write_ahead_log
    """
    _, taken, _ = connection.execute("PRAGMA wal_checkpoint").fetchone()
    file = FileRange(log)
    try:
        head = file.read(0, _LOG_HEAD)
        salt, size = head[16:24], _PAGE_HEAD + int.from_bytes(head[8:12], "big")
        pages = -(-max(file.size - _LOG_HEAD, 0) // size)
        own = (n for n in range(pages, 0, -1) if salt.startswith(file.read(_LOG_HEAD + (n - 1) * size + 8, 8)))
        # If no page has the salt of the log, its header is damaged.
        return file.size >= _LOG_HEAD and taken >= next(own, min(pages, 1))
    finally:
        file.close()


def is_cut(path: Path) -> bool:
    """Return True if a database is shorter than its header says. SQLite reads missing bytes of a page as zeros."""
    size, page_size, pages = _sizes(path)
    return size < pages * page_size


def _sizes(path: Path) -> tuple[int, int, int]:
    """Return the size of the file, the size of a page, and the number of pages by the header of the file."""
    file = FileRange(path)
    try:
        head = file.read(0, HEAD)
        if not head.startswith(MAGIC):
            raise foreign(file.name, "a rosbag2 database (.db3)", head)
        page_size = int.from_bytes(head[16:18], "big")
        return file.size, page_size if page_size > 1 else 1 << 16, int.from_bytes(head[28:32], "big")
    finally:
        file.close()


def _copy(path: Path, beside: list[Path], stack: ExitStack) -> Path:
    """Copy the file and the files next to it, and return the copy of the former."""
    folder = Path(stack.enter_context(TemporaryDirectory(prefix="robowidgets-")))
    try:
        for file in (path, *beside):
            shutil.copyfile(file, folder / file.name)
    except OSError as error:
        raise RecordingError(
            f"{path.name}: is not complete, and cannot be copied to be read: {error.strerror or error}"
        ) from None
    return folder / path.name


def _check_tables(connection: sqlite3.Connection, name: str) -> None:
    tables = {row[0] for row in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
    if not tables >= {"topics", "messages"}:
        shown = ", ".join(sorted(map(repr, tables))) or "none"
        raise RecordingError(
            f"{name}: an SQLite database, but not a rosbag2 recording: expected the tables 'topics' and 'messages', "
            f"got {shown[:200]}"
        )


def _channels(connection: sqlite3.Connection, damage: Damage) -> list[Channel]:
    definitions = {}
    with suppress(sqlite3.OperationalError):  # the table does not exist before ROS 2 Iron
        rows = connection.execute("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions")
        definitions = {
            name: definition_text(encoding, name, text) for name, encoding, text in (map(str, row) for row in rows)
        }
    channels = []
    profiles = {}
    with suppress(sqlite3.DatabaseError):  # the column does not exist before ROS 2 Foxy; messages are read without it
        profiles = dict(connection.execute("SELECT id, offered_qos_profiles FROM topics"))
    try:
        for number, *texts in connection.execute("SELECT id, name, type, serialization_format FROM topics"):
            topic, name, encoding = map(str, texts)
            qos = profiles.get(number)
            about = (("offered_qos_profiles", str(qos)),) if qos else ()
            channels.append(Channel(int(number), topic, name, encoding, definitions.get(name, ""), 0, (), about))
    except (sqlite3.DatabaseError, ValueError, TypeError):
        damage.places += 1
    return channels


class _Message(NamedTuple):
    topic: int
    time_ns: int
    data: bytes


def _look_up(connection: sqlite3.Connection, row: int) -> _Message | None:
    """Return a message by the number of its row, or None if it is missing or cannot be read."""
    try:
        found = connection.execute(_LOOK_UP, (row,)).fetchone()
    except sqlite3.Error:
        return None
    is_message = found and all(isinstance(value, kind) for value, kind in zip(found, (int, int, bytes), strict=True))
    return _Message(*found) if is_message else None


def _rows(connection: sqlite3.Connection, damage: Damage) -> Iterator[int]:
    """Yield the numbers of the rows in their order; if sqlite fails, continue after the damage.

    A row that was found may still be missing when it is looked up.
    """
    start: int | None = 1
    while start is not None:
        with suppress(sqlite3.DatabaseError):
            for (row,) in connection.execute(_WALK, (start,)):
                if row < start:
                    raise sqlite3.DatabaseError("rows are out of order")
                start = row + 1
                yield row
            return
        # Python reads one row ahead, so the last row before the damage can still be read separately.
        if row := _peek(connection, start):
            start = row + 1
            yield row
        damage.places += 1
        start = _next_start(connection, start) if damage.places < MAX_PLACES else None


def _next_start(connection: sqlite3.Connection, start: int) -> int | None:
    """Return the least row number after ``start`` from which the walk can continue, or None."""
    step = 1
    while _peek(connection, start + step) is None:
        step *= 2
        if start + step > _MAX_ROW:
            return None
    low, high = start + step // 2, start + step
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if _peek(connection, middle) is None else (low, middle)
    return high


def _peek(connection: sqlite3.Connection, start: int) -> int | None:
    """Return the first row number from ``start`` on, 0 if no row is left, or None if sqlite cannot read on."""
    try:
        row, *_ = connection.execute(f"{_WALK} LIMIT 1", (start,)).fetchone() or (0,)
    except sqlite3.DatabaseError:
        return None
    return row if row == 0 or row >= start else None
