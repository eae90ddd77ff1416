"""A connection to a database that is never written to, though it be damaged or not finished."""

from __future__ import annotations

import shutil
import sqlite3
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory

from ._records import Damage
from ._report import foreign
from ._stretch import FileStretch
from .source import RecordingError

MAGIC = b"SQLite format 3\0"


def connect(path: Path, stack: ExitStack) -> tuple[sqlite3.Connection, Damage]:
    """A connection, and what is known to be wrong with the file.

    The file is opened read-only and as one that nobody changes, so that no file appears beside it. Where it has to be
    changed, a temporary copy is opened: to take in what a killed recorder left beside it (``-wal``, ``-journal``), or
    to drop the piece of a page with which a file ends that was cut off: sqlite takes what is missing of it for zeros.

    Args:
        path: the file.
        stack: takes in what has to be closed.

    Raises:
        RecordingError: the file cannot be opened or copied, or is no database.
        sqlite3.Error: sqlite cannot open it.
    """
    beside = [path.with_name(path.name + ending) for ending in ("-wal", "-journal")]
    beside = [file for file in beside if file.is_file() and file.stat().st_size]
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
    # Without the first, sqlite refuses a file with pages missing; the others guard against a hostile one.
    for pragma in ("writable_schema = ON", "cell_size_check = ON", "trusted_schema = OFF"):
        connection.execute(f"PRAGMA {pragma}")
    return connection, damage


def _sizes(path: Path) -> tuple[int, int, int]:
    """Size of the file, size of a page, and the number of pages that the file says it has."""
    file = FileStretch(path)
    try:
        head = file.read(0, 64)
        if not head.startswith(MAGIC):
            raise foreign(file.name, "a rosbag2 database (.db3)", head)
        page_size = int.from_bytes(head[16:18], "big")
        return file.size, page_size if page_size > 1 else 1 << 16, int.from_bytes(head[28:32], "big")
    finally:
        file.close()


def _copy(path: Path, beside: list[Path], stack: ExitStack) -> Path:
    """A copy with what lies beside it."""
    folder = Path(stack.enter_context(TemporaryDirectory(prefix="robowidgets-")))
    try:
        for file in (path, *beside):
            shutil.copyfile(file, folder / file.name)
    except OSError as error:
        raise RecordingError(
            f"{path.name}: is not whole, and cannot be copied to be read: {error.strerror or error}"
        ) from None
    return folder / path.name
