"""The recordings that paths name: files, folders with all recordings in them, patterns, and URLs of all these."""

from __future__ import annotations

import glob
import os
from collections.abc import Callable, Iterable, Iterator
from itertools import starmap
from pathlib import Path
from typing import NamedTuple

from ..files import METADATA, NO_SUCH_PATH, is_one_recording
from ..files.remote import is_url, recordings_at
from ..repair import find_files, is_carmen, natural

PathLike = str | os.PathLike[str]


class NamedPath(NamedTuple):
    """A path or URL that was given for a recording, and the reason if nothing is read there, or empty."""

    path: Path | str
    problem: str = ""


def places_of(paths: Iterable[PathLike | NamedPath]) -> list[NamedPath]:
    """Return the recordings that some paths name, each once, in the given order, and in a folder by name.

    Args:
        paths: files, folders with recordings at any depth, or patterns such as ``"runs/*.mcap"`` (``**`` for any
            depth); or their URLs, such as ``"s3://bucket/runs/*.mcap"``. A rosbag2 folder, and a folder with only the
            parts of one recording, count as one recording; at a URL, only a rosbag2 folder does. A `NamedPath` is one
            recording.

    Raises:
        TypeError: a path is not a path. ValueError: no path is given.
    """
    found: dict[Path | str, NamedPath] = {}
    for path in paths:
        if isinstance(path, NamedPath):
            found.setdefault(path.path, path)
            continue
        if not isinstance(path, (str, os.PathLike)):
            hint = "; give each path as an argument of its own: *paths" if isinstance(path, (list, tuple)) else ""
            raise TypeError(f"expected the path of a recording, a folder or a pattern, got {path!r}{hint}")
        if not os.fspath(path):
            raise ValueError('expected files, folders or patterns of recordings, got an empty text; "." is this folder')
        for place in named_places(os.fspath(path)):
            found.setdefault(_real(place.path), place)
    if not found:
        raise ValueError("expected files, folders or patterns of recordings, got none")
    return list(found.values())


def places_in_index(files: Iterable[str]) -> list[NamedPath]:
    """Return the recordings of an index; each path is one recording, also a folder that lost its metadata."""
    found = (file if is_url(file) else Path(file) for file in files)
    return [NamedPath(one, "" if isinstance(one, str) or one.exists() else NO_SUCH_PATH) for one in found]


def the_only(paths: Iterable[PathLike]) -> Path | str | None:
    """Return the only recording that some paths name, or the path without one, or None for several recordings."""
    places = places_of(paths)
    return places[0].path if len(places) == 1 else None


def named_places(text: str, is_one: Callable[[Path], bool] = is_one_recording) -> Iterator[NamedPath]:
    """Yield the recordings that a path, pattern or URL names; ``is_one`` returns True if a folder is one recording."""
    if is_url(text):
        yield from starmap(NamedPath, recordings_at(text))
        return
    path = Path(os.path.abspath(Path(text).expanduser()))
    if path.is_dir():
        there = list(_within(path, is_one))
        yield from there or [NamedPath(path, "no recording in this folder")]
    elif path.exists():
        yield NamedPath(path.parent if path.name == METADATA else path)
    elif glob.has_magic(text):
        matches = sorted(glob.glob(str(path), recursive=True), key=natural)
        for match in matches:
            yield from named_places(match, is_one)
        if not matches:
            yield NamedPath(path, "nothing matches this pattern")
    else:
        yield NamedPath(path, NO_SUCH_PATH)


def _within(folder: Path, is_one: Callable[[Path], bool]) -> Iterator[NamedPath]:
    """Yield the recordings in a folder; links to other folders are not followed."""
    try:
        if is_one(folder):
            yield NamedPath(folder)
            return
        inside = sorted(folder.iterdir(), key=lambda path: natural(path.name))
        yield from (NamedPath(path) for path in [*find_files(folder), *filter(is_carmen, inside)])
    except OSError as error:
        yield NamedPath(folder, f"cannot be read: {error.strerror or error}")
        return
    for path in inside:
        if path.is_dir() and not path.is_symlink() and not path.name.startswith("."):
            yield from _within(path, is_one)


def _real(path: Path | str) -> Path | str:
    return path if isinstance(path, str) else Path(os.path.realpath(path))
