"""Output files, which are written completely or not at all."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Collection, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO


def checked_output(call: str, path: str | os.PathLike[str], suffixes: Collection[str]) -> Path:
    """Return the absolute path of a file that can be written; ``call`` is the method's name, for the errors.

    Raises:
        TypeError: it is not a path. ValueError: the name does not end in one of ``suffixes``. OSError: the folder is
            missing or not writable.
    """
    if not isinstance(path, (str, os.PathLike)):
        raise TypeError(f"{call}(): expected the path of a file, got {path!r}")
    target = Path(os.path.realpath(Path(os.fsdecode(path)).expanduser()))
    if target.suffix.lower() not in suffixes:
        raise ValueError(f"{call}(): expected a name that ends in {' or '.join(suffixes)}, got {str(path)!r}")
    if not target.parent.is_dir():
        raise FileNotFoundError(f"{call}(): there is no folder {str(target.parent)!r} for {target.name!r}; make it")
    if target.is_dir():
        raise IsADirectoryError(f"{call}(): {str(target)!r} is a folder; expected the name of a file")
    if not os.access(target if target.exists() else target.parent, os.W_OK):
        raise PermissionError(f"{call}(): {str(target)!r} may not be written; choose another folder or name")
    return target


@contextmanager
def whole_file(path: Path) -> Iterator[BinaryIO]:
    """Open a file that appears under its name once it is complete, and then replaces an existing file.

    Until then it has a name that ends in ``.part``, in the same folder. After an error, the part is removed. So are
    parts that a killed process left of earlier attempts.

    Raises:
        OSError: the file cannot be written, for example because the disk is full.
    """
    for left in _left_behind(path):
        with suppress(PermissionError):  # of another user, or, on Windows, still written to
            left.unlink(missing_ok=True)
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    try:
        with part.open("wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def _left_behind(path: Path) -> list[Path]:
    """Return the parts of a file whose processes have ended; on Windows, which removes no open file, all parts."""
    name = re.compile(re.escape(path.name) + r"\.(\d+)\.part")
    found = ((name.fullmatch(entry.name), entry) for entry in path.parent.iterdir())
    return [entry for match, entry in found if match and not _runs(int(match[1]))]


def _runs(process: int) -> bool:
    """Return True if a process of this number runs; False on Windows, where signal 0 is Ctrl-C for the console."""
    if sys.platform == "win32":
        return False
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):  # of another user, or not a number of a process
        return True
    return True
