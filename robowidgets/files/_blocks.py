"""Remote files that are read in parts: blocks that fsspec fetches when they are needed, and keeps in memory.

fsspec is optional, so this module is imported only for a URL.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any
from weakref import WeakValueDictionary

from fsspec.asyn import sync
from fsspec.spec import AbstractBufferedFile

from ..repair import RemoteError
from ..runtime.clock import Clock, RealClock
from ._driver_errors import fail, status_of

BLOCK = 4 << 20
"""Bytes of one request. Chunks are smaller, so that several of them arrive together."""
_MOST_BLOCKS = 16
"""Blocks in memory for one recording, for all readers of it; each of its files has at least one."""
_MOST_LOOKS = 4
"""Blocks that may be fetched to make the times of rare topics exact, apart from the first block and the last."""
_PAUSES = (0.5, 1.0, 2.0)
"""Seconds before each further attempt."""
_RANGE = re.compile(r"bytes (\d+)-(\d+)/(\d+|\*)")
_RETRIED = (408, 425, 429)

Fetch = Callable[[int, int], bytes]
clock: Clock = RealClock()
"""The clock that measures the pauses."""


class NoPartsError(Exception):
    """The server of a file sends no parts of it."""


class Parts(AbstractBufferedFile):  # type: ignore[misc]  # fsspec has no types
    """A remote file that is open for reading in blocks.

    Args:
        system: the file system.
        path: the path in it.
        size: the size in bytes.
        fetch: returns the bytes between two offsets.
        shown: the URL for messages.
        files: the number of files of the recording.
    """

    def __init__(self, system: Any, path: str, size: int, fetch: Fetch, shown: str, files: int) -> None:
        self._fetch_once, self._shown = fetch, shown
        options = {"maxblocks": max(1, _MOST_BLOCKS // files)}
        super().__init__(system, path, "rb", BLOCK, cache_type="blockcache", cache_options=options, size=size)

    def fetch(self, start: int, end: int) -> bytes:
        """Return the bytes between two offsets by one request, past the blocks in memory."""
        return self._fetch_range(start, end)

    def _fetch_range(self, start: int, end: int) -> bytes:
        """Return the bytes between two offsets; see `AbstractBufferedFile`."""
        end = min(end, self.size)
        for pause in (*_PAUSES, None):
            try:
                raw = self._fetch_once(start, end)
                if len(raw) == end - start:
                    return raw
                raise EOFError(f"{len(raw):,} bytes came of {end - start:,}")
            except (RemoteError, NoPartsError):
                raise
            except Exception as error:  # each driver has different errors
                if pause is None or _is_final(error):
                    fail(error, self._shown, f" at byte {start:,}", is_open=True)
            clock.sleep(pause)
        raise AssertionError


class RemoteFile:
    """A remote file, as the readers of local files open it. All readers of one state of a file share its blocks.

    Args:
        name: the URL for messages.
        key: the name of this state of the file.
        open_parts: opens the file.
    """

    def __init__(self, name: str, key: str, open_parts: Callable[[], Parts]) -> None:
        self._name, self._key, self._open_parts = name, key, open_parts
        self._looked_at: set[int] = set()
        self._size = 0

    def exists(self) -> bool:
        """Return True: its server has reported its size."""
        return True

    def open(self, mode: str) -> Parts:
        """Open the file for reading."""
        assert mode == "rb"
        parts = self._open_parts()
        shared = _shared.setdefault(self._key, parts.cache)
        shared.fetcher = parts.cache.fetcher  # a signature may be newer
        parts.cache = shared
        self._size = parts.size
        return parts

    def is_near(self, offset: int, size: int) -> bool:
        """Return True if a few bytes may be read while the file is opened, because few such places were read before."""
        blocks = {offset // BLOCK, (offset + size - 1) // BLOCK} - {0, (self._size - 1) // BLOCK}
        if len(self._looked_at | blocks) > _MOST_LOOKS:
            return False
        self._looked_at |= blocks
        return True

    def __str__(self) -> str:
        return self._name


_shared: WeakValueDictionary[str, Any] = WeakValueDictionary()
"""The blocks in memory, by the names of the states of files."""


def web_fetch(system: Any, path: str, size: int, state: dict[str, str], shown: str) -> Fetch:
    """Return the function that fetches ranges of a file from a web server, and checks that it sent what was requested.

    Args:
        system: the file system.
        path: the URL.
        size: the size of the file in bytes.
        state: the headers of the file when it was opened.
        shown: the URL for messages.
    """

    async def get(start: int, end: int) -> bytes:
        options = {**system.kwargs}
        headers = {**options.pop("headers", {}), "Range": f"bytes={start}-{end - 1}"}
        session = await system.set_session()
        async with session.get(system.encode_url(path), headers=headers, **options) as answer:
            if answer.status == 416:
                raise changed(shown)
            answer.raise_for_status()
            _check_same(answer.headers, state, shown)
            if answer.status != 206:
                raise NoPartsError
            sent = answer.headers.get("Content-Range", "")
            found = _RANGE.fullmatch(sent)
            if found and found[3] not in ("*", str(size)):
                raise changed(shown)
            length = answer.headers.get("Content-Length", str(end - start))
            if found is None or (int(found[1]), int(found[2])) != (start, end - 1) or length != str(end - start):
                raise RemoteError(
                    f"{shown}: its server answered a request for bytes {start}-{end - 1} with "
                    f"{sent or 'no range'!r} of {length} bytes: it cannot be read in parts; download it, and open the "
                    "file"
                )
            return bytes(await answer.content.readexactly(end - start))

    return lambda start, end: sync(system.loop, get, start, end)


def driver_fetch(system: Any, path: str, is_same: Callable[[], bool], shown: str) -> Fetch:
    """Return the function that fetches ranges of a file by the driver of its file system.

    Args:
        system: the file system.
        path: the path in it.
        is_same: returns True if the file has not changed since it was opened.
        shown: the URL for messages.
    """
    file = system.open(path, "rb", cache_type="none")

    def of_file(start: int, end: int) -> bytes:
        return bytes(system.cat_file(path, start=start, end=end))

    # Drivers provide this method for ranges; files in memory, for example, lack it.
    read = getattr(file, "_fetch_range", of_file)
    is_checked = "IfMatch" in {**getattr(file, "req_kw", {}), **getattr(file, "read_kw", {})}

    def fetch(start: int, end: int) -> bytes:
        try:
            raw = read(start, end)
        except Exception as error:
            if type(error).__name__ == "FileExpired":  # by S3
                raise changed(shown) from None
            raise
        if not is_checked and not is_same():
            raise changed(shown)
        return bytes(raw)

    return fetch


def changed(shown: str) -> RemoteError:
    """Return the error of a file that changed while it was read."""
    return RemoteError(f"{shown}: it has changed since it was opened: open it again")


def _check_same(headers: Any, state: dict[str, str], shown: str) -> None:
    for name, value in state.items():
        now = headers.get(name)
        if now is not None and now.removeprefix("W/") != value.removeprefix("W/"):
            raise changed(shown)


def _is_final(error: Exception) -> bool:
    """Return True if another attempt would fail, too."""
    code = status_of(error)
    return isinstance(error, (PermissionError, FileNotFoundError)) or (
        code is not None and 400 <= code < 500 and code not in _RETRIED
    )
