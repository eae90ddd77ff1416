"""rosbag2 databases (.db3), read row by row past what is missing, without ever writing to them."""

from __future__ import annotations

import shutil
import sqlite3
from array import array
from collections.abc import Collection, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock
from typing import NamedTuple

from ..source import Channel, RecordingError
from .definition import definition
from .records import MAX_PLACES, Damage
from .report import foreign, nothing, problems
from .stretch import FileStretch
from .times import Times

MAGIC = b"SQLite format 3\0"
_WALK = "SELECT rowid FROM messages WHERE rowid > ? ORDER BY rowid"
_LOOK_UP = "SELECT topic_id, timestamp, data FROM messages WHERE rowid = ?"
_MAX_ROW = 2**62


def open_sqlite(path: Path) -> SavedDatabase:
    """Every message that can be read from a rosbag2 database, whole or not.

    The file is opened read-only and as one that nobody changes, so that no file appears beside it. What a recorder that
    was killed left beside it (``-wal``, ``-journal``) is taken in, in a temporary copy.

    Args:
        path: the file, whatever its name ends in.

    Raises:
        RecordingError: it cannot be opened, is no rosbag2 database, or holds nothing that can be saved.

    Source: the tables topics, messages and (since ROS 2 Iron) message_definitions of rosbag2_storage_sqlite3.
    """
    with ExitStack() as stack:
        left_behind = [beside for beside in (_beside(path, "-wal"), _beside(path, "-journal")) if _size(beside)]
        damage = Damage(unfinished=bool(left_behind))
        if left_behind:
            database = _copy(path, left_behind, stack)
        else:
            damage.cut = _is_cut(path)
            database = f"{path.absolute().as_uri()}?mode=ro&immutable=1"
        try:
            connection = sqlite3.connect(database, uri=True, check_same_thread=False)
            stack.callback(connection.close)
            connection.text_factory = lambda raw: raw.decode("utf-8", errors="replace")
            # Without the first, sqlite refuses a file with pages missing; the others guard against a hostile one.
            for pragma in ("writable_schema = ON", "cell_size_check = ON", "trusted_schema = OFF"):
                connection.execute(f"PRAGMA {pragma}")
            _check_tables(connection, path.name)
            source = SavedDatabase(path, connection, damage)
        except sqlite3.Error as error:
            raise RecordingError(
                f"{path.name}: the database cannot be read ({error}): expected a rosbag2 .db3; "
                f"'sqlite3 {path.name} .recover' may save some of it"
            ) from None
        source.closing = stack.pop_all()
        return source


class SavedDatabase:
    """A `Source` over the rows of a rosbag2 database that can be read.

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
        for row in _walk(connection, damage):
            if message := _look_up(connection, row):
                self._rows.append(row)
                times.append(message.time_ns)
                topics.append(message.topic)
            else:
                damage.places += 1
        channels = _channels(connection, damage)
        self._times = Times(times, topics, {channel.id for channel in channels})
        counts = self._times.counts()
        self.channels = tuple(channel._replace(count=counts.get(channel.id, 0)) for channel in channels)
        self.start_ns = self._times.start_ns
        self.end_ns = self._times.end_ns
        damage.unnamed = len(times) - len(self._times)
        if damage.cut:
            damage.places = 0
        self.problems = problems(damage, len(self._times), (self.end_ns or 0) - (self.start_ns or 0))
        if self.problems and not len(self._times):
            raise nothing(path.name, _size(path), damage)

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


def _beside(path: Path, ending: str) -> Path:
    return path.with_name(path.name + ending)


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0


def _copy(path: Path, left_behind: Collection[Path], stack: ExitStack) -> str:
    """A copy with what was left beside it, where sqlite may put the two together."""
    folder = Path(stack.enter_context(TemporaryDirectory(prefix="robowidgets-")))
    try:
        for file in (path, *left_behind):
            shutil.copyfile(file, folder / file.name)
    except OSError as error:
        raise RecordingError(
            f"{path.name}: its recorder was killed, and it cannot be copied to be read: {error.strerror or error}"
        ) from None
    return (folder / path.name).as_uri()


def _is_cut(path: Path) -> bool:
    """Whether the file is shorter than its header says; RecordingError when it is no database."""
    file = FileStretch(path)
    try:
        head = file.read(0, 64)
        if not head.startswith(MAGIC):
            raise foreign(file.name, "a rosbag2 database (.db3)", head)
        page_size = int.from_bytes(head[16:18], "big")
        pages = int.from_bytes(head[28:32], "big")
        return file.size < pages * (page_size if page_size > 1 else 1 << 16)
    finally:
        file.close()


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
    last: int | None = -1
    while last is not None:
        with suppress(sqlite3.DatabaseError):
            for (row,) in connection.execute(_WALK, (last,)):
                if row <= last:
                    raise sqlite3.DatabaseError("rows are out of order")
                last = row
                yield row
            return
        damage.places += 1
        last = _next_row(connection, last) if damage.places < MAX_PLACES else None


def _next_row(connection: sqlite3.Connection, last: int) -> int | None:
    """The least row number after ``last`` from which the walk goes on; None when there is none."""
    step = 1
    while not _goes_on(connection, last + step):
        step *= 2
        if last + step > _MAX_ROW:
            return None
    low, high = last + step // 2, last + step
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if _goes_on(connection, middle) else (middle, high)
    return high


def _goes_on(connection: sqlite3.Connection, last: int) -> bool:
    try:
        row = connection.execute(f"{_WALK} LIMIT 1", (last,)).fetchone()
    except sqlite3.DatabaseError:
        return False
    return row is None or row[0] > last
