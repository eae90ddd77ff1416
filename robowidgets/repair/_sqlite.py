"""rosbag2 databases (.db3), read row by row past what is missing, without ever writing to them."""

from __future__ import annotations

import sqlite3
from array import array
from collections.abc import Collection, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from threading import Lock
from typing import NamedTuple

from .._core.progress import Progress
from ._definition import definition
from ._known import Known
from ._records import MAX_PLACES, Damage
from ._report import nothing
from ._sqlite_file import connect
from .source import Channel, RecordingError

_WALK = "SELECT rowid FROM messages WHERE rowid >= ? ORDER BY rowid"
_LOOK_UP = "SELECT topic_id, timestamp, data FROM messages WHERE rowid = ?"
_MAX_ROW = 2**62


def open_sqlite(path: Path) -> SavedDatabase:
    """Every message that can be read from a rosbag2 database, whole or not.

    What a recorder that was killed left beside the file (``-wal``, ``-journal``) is taken in.

    Args:
        path: the file, whatever its name ends in.

    Raises:
        RecordingError: it cannot be opened, is no rosbag2 database, or holds nothing that can be saved.

    Source: the tables topics, messages and (since ROS 2 Iron) message_definitions of rosbag2_storage_sqlite3.
    """
    with ExitStack() as stack:
        try:
            connection, damage = connect(path, stack)
            _check_tables(connection, path.name)
            source = SavedDatabase(path, connection, damage)
        except sqlite3.Error as error:
            raise RecordingError(
                f"{path.name}: the database cannot be read ({error}): expected a rosbag2 .db3; "
                f"'sqlite3 {path.name} .recover' may save some of it"
            ) from None
        source.closing = stack.pop_all()
        return source


class SavedDatabase(Known):
    """A `SavedSource` over the rows of a rosbag2 database that can be read.

    Args:
        path: the file, to name it in errors.
        connection: the open database.
        damage: what is known to be wrong so far.

    Raises:
        RecordingError: the database is damaged and holds no message.
    """

    def __init__(self, path: Path, connection: sqlite3.Connection, damage: Damage) -> None:
        self.closing = ExitStack()
        self._name = path.name
        self._connection = connection
        self._lock = Lock()
        self._rows, times, topics = array("q"), array("q"), array("q")
        with Progress(None, f"Reading {path.name}") as bar:
            for row in _walk(connection, damage):
                if message := _look_up(connection, row):
                    self._rows.append(row)
                    times.append(message.time_ns)
                    topics.append(message.topic)
                else:
                    damage.places += 1
                bar.update(1)
        super().__init__(times, topics, _channels(connection, damage), damage)
        if damage.cut:
            damage.places = 0
        if self.problems and not len(self._times):
            raise nothing(path.name, path.stat().st_size, damage, f", try 'sqlite3 {path.name} .recover'")

    def messages(
        self, channels: Collection[Channel], start_ns: int | None = None, stop_ns: int | None = None
    ) -> Iterator[tuple[Channel, int, bytes]]:
        """Channel, log time and bytes of the messages of these channels, by log time."""
        wanted = {channel.id: channel for channel in channels}
        for row, channel, time_ns in self._times.rows(wanted, start_ns, stop_ns):
            yield wanted[channel], time_ns, self._read(self._rows[row])

    def close(self) -> None:
        """Close the database; doing it again does nothing."""
        self.closing.close()

    def _read(self, row: int) -> bytes:
        with self._lock:
            message = _look_up(self._connection, row)
        if not message:
            raise RecordingError(f"{self._name}: is closed, or has changed since it was opened; open it again")
        return message.data


def _check_tables(connection: sqlite3.Connection, name: str) -> None:
    tables = {row[0] for row in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
    if not tables >= {"topics", "messages"}:
        shown = ", ".join(sorted(map(repr, tables))) or "none"
        raise RecordingError(
            f"{name}: an SQLite database, but no rosbag2 recording: expected the tables 'topics' and 'messages', "
            f"got {shown[:200]}"
        )


def _channels(connection: sqlite3.Connection, damage: Damage) -> list[Channel]:
    definitions = {}
    with suppress(sqlite3.OperationalError):  # no such table before ROS 2 Iron
        rows = connection.execute("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions")
        definitions = {
            name: definition(encoding, name, text) for name, encoding, text in (map(str, row) for row in rows)
        }
    channels = []
    try:
        for number, *texts in connection.execute("SELECT id, name, type, serialization_format FROM topics"):
            topic, name, encoding = map(str, texts)
            channels.append(Channel(int(number), topic, name, encoding, definitions.get(name, ""), 0))
    except (sqlite3.DatabaseError, ValueError, TypeError):
        damage.places += 1
    return channels


class _Message(NamedTuple):
    topic: int
    time_ns: int
    data: bytes


def _look_up(connection: sqlite3.Connection, row: int) -> _Message | None:
    """A message by the number of its row; None where there is none that can be read."""
    try:
        found = connection.execute(_LOOK_UP, (row,)).fetchone()
    except sqlite3.Error:
        return None
    is_message = found and all(isinstance(value, kind) for value, kind in zip(found, (int, int, bytes), strict=True))
    return _Message(*found) if is_message else None


def _walk(connection: sqlite3.Connection, damage: Damage) -> Iterator[int]:
    """The numbers of the rows in their order, past places where the walk breaks off.

    A row met on the walk may still not be found when it is looked up.
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
        # Python reads a row ahead: the last before the break is still to be had, by itself.
        if row := _peek(connection, start):
            start = row + 1
            yield row
        damage.places += 1
        start = _next_start(connection, start) if damage.places < MAX_PLACES else None


def _next_start(connection: sqlite3.Connection, start: int) -> int | None:
    """The least row number after ``start`` from which the walk goes on; None when there is none."""
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
    """The first row number from ``start`` on, 0 where no row is left; None where the walk cannot go on."""
    try:
        row, *_ = connection.execute(f"{_WALK} LIMIT 1", (start,)).fetchone() or (0,)
    except sqlite3.DatabaseError:
        return None
    return row if row == 0 or row >= start else None
