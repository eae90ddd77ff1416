"""The recordings that an assistant may read: files, and all recordings in folders, and nothing outside of them."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from .. import fleet
from ..fleet.places import places_of
from ..recording import Recording
from ..recording import open as open_recording
from ..runtime.text import listed
from .answer import AnswerError

MAX_IDLE = 3
"""The most recordings that stay open between two questions."""


class Library:
    """Files and folders of recordings. Any thread may use it.

    Args:
        places: the files and folders, which must exist.

    Raises:
        FileNotFoundError: a place does not exist. ValueError: a place is a URL, whose files cannot be checked.
    """

    def __init__(self, places: Iterable[str | os.PathLike[str]]) -> None:
        self._places: list[Path] = []
        for place in places:
            path = Path(place).expanduser()
            if not path.exists():
                raise FileNotFoundError(f"{place}: expected a recording, or a folder of recordings; it does not exist")
            self._places.append(path.resolve())
        self._idle: deque[tuple[Path, object, Recording]] = deque()

    def __bool__(self) -> bool:
        return bool(self._places)

    def names(self) -> list[str]:
        """Return the names of the recordings, for `open`."""
        found = places_of(self._places)
        return [self._name_of(Path(one.path)) for one in found if not one.problem]

    def resolve(self, name: str) -> Path:
        """Return the path of a recording. Links are followed first.

        Raises:
            AnswerError: it is outside of the places, or does not exist.
        """
        given = Path(name).expanduser()
        tried = [given] if given.is_absolute() else [self._root(place) / given for place in self._places]
        inside = [path for path in (Path(os.path.realpath(one)) for one in tried) if self._allows(path)]
        if not inside or "\0" in name or "://" in name:
            raise AnswerError(
                f"recording: {name[:200]!r} is outside of the folders that this server may read; `recordings` lists "
                "what it may"
            )
        there = [path for path in inside if path.exists()]
        if not there:
            names = self.names()
            all_by = ", listed by `recordings`" if len(names) > 5 else ""
            raise AnswerError(f"recording: found no {name[:200]!r}; there are {listed(names, 5) or 'none'}{all_by}")
        only = fleet.the_only([there[0]])
        if only is None or not self._allows(Path(os.path.realpath(only))):
            raise AnswerError(f"recording: {name[:200]!r} is a folder of several recordings; name one of them")
        return Path(only)

    @contextmanager
    def open(self, name: str) -> Iterator[Recording]:
        """Open a recording, or take one that the last questions left open. One question at a time has it.

        Raises:
            AnswerError: as `resolve`. RecordingError: it cannot be read.
        """
        path = self.resolve(name)
        state = _state_of(path)
        recording = self._take(path, state) or open_recording(path)
        try:
            yield recording
        except BaseException:
            recording.close()
            raise
        self._idle.append((path, state, recording))
        while len(self._idle) > MAX_IDLE:
            self._idle.popleft()[2].close()

    def close(self) -> None:
        """Close what is open between two questions."""
        while self._idle:
            self._idle.popleft()[2].close()

    def _take(self, path: Path, state: object) -> Recording | None:
        for entry in list(self._idle):
            if entry[:2] == (path, state):
                try:
                    self._idle.remove(entry)
                except ValueError:  # another thread has taken it
                    continue
                return entry[2]
        return None

    def _allows(self, path: Path) -> bool:
        return any(path == place or (place.is_dir() and place in path.parents) for place in self._places)

    def _name_of(self, path: Path) -> str:
        roots = [self._root(place) for place in self._places if place == path or place in path.parents]
        return path.relative_to(roots[0]).as_posix() if len(self._places) == 1 and roots else str(path)

    @staticmethod
    def _root(place: Path) -> Path:
        """Return the folder to which names are relative."""
        return place if place.is_dir() and not (place / "metadata.yaml").exists() else place.parent


def _state_of(path: Path) -> object:
    """Return what changes if the file of a recording, or a file in its folder, is written again."""
    files = sorted(path.iterdir()) if path.is_dir() else [path]
    return tuple((one.name, one.stat().st_mtime_ns, one.stat().st_size) for one in files)
