"""Remote recordings: in object storage, on a web server, or anywhere that fsspec can read."""

from __future__ import annotations

import functools
import glob
import json
import os
import re
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple, TypeGuard
from urllib.parse import unquote, urlsplit
from urllib.request import url2pathname
from uuid import uuid4

from ..messages.decoding import one_line
from ..notebook.progress import Progress
from ..repair import SUFFIX, RecordingError, RemoteError, Source, has_clock_step, natural, open_repaired
from ..runtime.text import listed, many, megabytes
from ..runtime.urls import without_secrets
from . import METADATA, counts_up, is_described, open_source
from ._chain import Chain
from ._copies import Copy, copies_folder, find, holding, make
from ._driver_errors import asked, fail
from ._fallback import FallbackSource
from ._plain import is_plain
from ._rosbags import RosbagsSource, open_in_parts

_URL = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+(://|::)")
_QUERY = re.compile(r"(?<=.)\?.*")
_OTHER = re.compile(r"\.(log|clf)(\.gz)?$")
_UNSAFE = re.compile(r"[^\w.+ -]")
_FROM = ".url"
"""The file next to a copy that contains its URL."""
_BLOCK = 8 << 20
WHOLE = 32 << 20
"""The size in bytes up to which any file is fetched whole: then no later question needs the server."""
_NO_INDEX = re.compile(r"\.(db3|log|clf|gz|active|zstd?)$", re.IGNORECASE)
_ONLY_INDEXED = "only MCAP files and ROS 1 bags are read in parts"
_STATE = (
    "etag", "content-md5", "md5hash", "md5", "generation", "versionid", "lastmodified", "last-modified",
    "last_modified", "mtime", "modified", "updated", "created",
)  # fmt: skip
"""The names that drivers use for the properties that change with an object, in addition to its size."""
_LONGEST = 60.0
"""Seconds without an answer from a web server."""


class _Object(NamedTuple):
    """One file of a recording: its path in its file system, its local name, its size in bytes, and its state.

    ``headers`` are the properties in its state that a web server sends.
    """

    path: str
    name: str
    size: int | None
    state: str
    headers: dict[str, str]


def is_url(path: Any) -> TypeGuard[str]:
    """Return True if a path is a URL."""
    return isinstance(path, str) and _URL.match(path) is not None


_given: dict[str, str] = {}
"""The URLs with secrets that this process was given, by their names without secrets."""
IN_ENVIRONMENT = "ROBOWIDGETS_URLS"
"""The environment variable in which a command passes these URLs to the kernels that it starts."""


def named(url: str) -> str:
    """Return the name of a URL: the same without secrets. This process finds the URL by this name from now on."""
    name = without_secrets(url)
    if name != url:
        _given[name] = url
    return name


def with_secrets(name: str) -> str:
    """Return the URL that was given under a name, in this process or the command that started it."""
    if name not in _given:
        with suppress(ValueError):
            found = json.loads(os.environ.get(IN_ENVIRONMENT, "{}"))
            return str(found.get(name, name)) if isinstance(found, dict) else name
    return _given.get(name, name)


def pass_secrets(name: str) -> None:
    """Allow child processes to find a URL by its name, too."""
    if (url := with_secrets(name)) != name:
        os.environ[IN_ENVIRONMENT] = json.dumps({name: url})


class Fetched:
    """A recording that was fetched or copied before. Its copy stays until this object is closed.

    Attributes:
        path: the local file or folder.
        url: the URL of the original without secrets, or None if the recording is not a copy.
    """

    def __init__(self, path: Path, url: str | None = None, copy: Copy | None = None) -> None:
        self.path, self.url, self._copy = path, url, copy

    @property
    def is_in_parts(self) -> bool:
        """True if the recording is on a server and has no local copy."""
        return self.url is not None and self._copy is None

    def keep(self, other: Fetched) -> None:
        """Keep another copy, too, until this object is closed."""
        self._copy = other._copy

    def close(self) -> None:
        """Allow the copy to be removed when room is needed; closing it again does nothing."""
        if self._copy is not None:
            self._copy.close()


def held(path: Path) -> Fetched:
    """Return the recording at a local path; if the path is in a copy, the copy stays until the result is closed."""
    # Absolute, because the working directory may have changed when a player opens the file again.
    path = path.absolute()
    if ".." in path.parts:
        path = path.resolve()  # not by its text alone: a part before it may be a link
    if path.name == METADATA:
        path = path.parent
    copy = holding(path)
    if copy is None:
        return Fetched(path)
    return Fetched(path, without_secrets((copy.folder / _FROM).read_text(encoding="utf-8")), copy)


def opened(url: str) -> tuple[Fetched, Source]:
    """Return the recording at a URL, and its messages as the file has them.

    Large MCAP files and ROS 1 bags with an index are read in parts; nothing lies at the path. Others are fetched whole.

    Raises:
        RecordingError: it cannot be fetched, stored or read; the text gives the reason and the remedy.
    """
    fetched, reason = None, _ONLY_INDEXED
    if not _is_local(url):
        found = _find(url)
        if found.may_have_index and found.size > WHOLE and find(found.key) is None:
            try:
                return _in_parts(found)
            except _WholeError as error:
                reason = str(error)
        fetched = _fetch(found, reason)
    return _opened(fetched or fetch(url))


def opened_here(path: Path) -> tuple[Fetched, Source]:
    """Return the recording at a local path, and its messages as `opened` does."""
    return _opened(held(path))


def _opened(file: Fetched) -> tuple[Fetched, Source]:
    try:
        return file, open_source(file.path)
    except BaseException:
        file.close()
        raise


def fetch(url: str) -> Fetched:
    """Return the recording at a URL as a local file or folder; fetch it unless a copy of its current state exists.

    Raises:
        RecordingError: it cannot be fetched or stored; the text gives the reason and the remedy.
    """
    return held(Path(url2pathname(urlsplit(url).path))) if _is_local(url) else _fetch(_find(url))


class _WholeError(Exception):
    """A file cannot be read in parts; the text gives the reason."""


class _Found(NamedTuple):
    """A recording at a URL: its file system and path, its files, and the names of its copy and of the state it has."""

    url: str
    system: Any
    path: str
    objects: list[_Object]
    is_folder: bool
    key: str
    name: str

    @property
    def files(self) -> list[_Object]:
        """Its files with messages, in their order."""
        return [one for one in self.objects if one.name != METADATA]

    @property
    def size(self) -> int:
        """The bytes of its files, without those whose server reports no size."""
        return sum(one.size or 0 for one in self.objects)

    @property
    def may_have_index(self) -> bool:
        """True if all of its files may be MCAP files or ROS 1 bags."""
        return not any(_NO_INDEX.search(one.name) for one in self.files)

    @property
    def local(self) -> Path:
        """The path of its copy."""
        return copies_folder() / self.key / (self.name if self.is_folder else self.objects[0].name)


def _is_local(url: str) -> bool:
    return url.lower().startswith(("file://", "local://"))


def _find(url: str) -> _Found:
    url = named(url)
    system, path = _system(url)
    objects, is_folder = _objects(system, path, url)
    key = f"{_short(url)}-{_short(_state(objects))}"
    return _Found(url, system, path, objects, is_folder, key, _safe(file_name(path)) or "recording")


def _fetch(found: _Found, reason: str = "") -> Fetched:
    url = found.url

    def write(folder: Path) -> None:
        (folder / _FROM).write_text(url, encoding="utf-8")
        target = folder / found.name if found.is_folder else folder
        _download(found.system, found.objects, target, found.name, url, reason)

    copy = find(found.key)
    if copy is None:
        try:
            copy = make(found.key, found.size, write)
        except RecordingError as error:
            message = str(error)
            raise RecordingError(message if message.startswith(url) else f"{url}: {message}") from None
        except OSError as error:
            raise RecordingError(f"{url}: its copy cannot be written: {error.strerror or error}") from None
    return Fetched(found.local, url, copy)


def _in_parts(found: _Found) -> tuple[Fetched, Source]:
    """Open MCAP files or ROS 1 bags with an index, and read only what is requested.

    Raises:
        _WholeError: the recording has to be fetched whole; the text gives the reason.
        RemoteError: it cannot be read at all.
    """
    from ._blocks import NoPartsError  # needs fsspec, which is optional

    fetched = Fetched(found.local, found.url)

    def repaired() -> Source:
        whole = _fetch(found, "it is damaged")
        fetched.keep(whole)
        return open_repaired([whole.path / one.name for one in found.files] if found.is_folder else [whole.path])

    try:
        with ExitStack() as opened:
            sources = []
            for one in found.files:
                sources.append(_open_file(found, one))
                opened.callback(sources[-1].close)
            source = Chain(sources) if found.is_folder else sources[0]
            if found.is_folder and not _is_described(found, source):
                raise _WholeError(f"it has no {METADATA} that describes its files")
            if has_clock_step(source.arrivals):
                raise _WholeError("its clock was set")
            if is_plain(source):
                raise _WholeError("it has JSON or protobuf, whose fields are found by reading many messages")
            opened.pop_all()
    except (RemoteError, _WholeError):
        raise
    except NoPartsError:
        raise _WholeError("its server sends no parts") from None
    except Exception:  # rosbags raises anything
        raise _WholeError("it has no index that is complete and in order") from None
    return fetched, FallbackSource(source, repaired)


def _open_file(found: _Found, one: _Object) -> RosbagsSource:
    """Open one of the files of a recording, to read it in parts. Raises as rosbags does."""
    from ._blocks import Parts, RemoteFile, driver_fetch, web_fetch

    system, path = found.system, one.path
    shown = f"{found.url}/{one.name}" if found.is_folder else found.url

    def look() -> _Object:
        system.invalidate_cache()
        return _object(asked(lambda: system.info(path), shown), path)

    if found.is_folder:
        one = look()  # lists of folders have fewer properties
    size = one.size or 0

    def is_same() -> bool:
        return look().state == one.state

    def open_parts() -> Parts:
        if {"http", "https"} & {*([system.protocol] if isinstance(system.protocol, str) else system.protocol)}:
            fetch_range = web_fetch(system, path, size, one.headers, shown)
        else:
            fetch_range = asked(lambda: driver_fetch(system, path, is_same, shown), shown)
        return Parts(system, path, size, fetch_range, shown, len(found.files))

    file = RemoteFile(shown, f"{found.key}-{_short(one.name + one.state)}", open_parts)
    return open_in_parts(file, file.is_near)


def _is_described(found: _Found, source: Source) -> bool:
    """Return True if a folder has rosbag2 metadata that agree with its files."""
    path = next((one.path for one in found.objects if one.name == METADATA), None)
    if path is None:
        return False
    text: bytes = asked(lambda: found.system.cat_file(path), found.url)
    return is_described([one.name for one in found.files], source, text.decode(errors="replace"))


def state_of(url: str) -> str | None:
    """Return a text that changes whenever the recording at a URL changes, or None if its server reports no state.

    Raises:
        RecordingError: its state cannot be read.
    """
    url = named(url)
    objects, _ = _objects(*_system(url), url)
    return f"{_short(url)}-{_short(_state(objects))}" if all(one.state for one in objects) else None


def recordings_at(url: str) -> Iterator[tuple[str, str]]:
    """Yield the names of the recordings at a URL (see `named`), each with the reason if it is not read, or empty.

    A URL may be a pattern such as ``s3://bucket/runs/*.mcap``, or a folder: a rosbag2 folder, which is one recording,
    or a folder with recordings at any depth.
    """
    shown = named(url)
    try:
        system, path = _system(shown)
        url = with_secrets(shown)
        if not _is_pattern(url):
            yield from _within(system, path, url)
            return
        matches = sorted(asked(lambda: system.glob(path), shown))
        for match in matches:
            yield from _within(system, match, _url(system, match, url))
        if not matches:
            yield shown, "nothing matches this pattern"
    except RecordingError as error:
        yield shown, str(error).removeprefix(f"{shown}: ")


def _within(system: Any, path: str, url: str) -> Iterator[tuple[str, str]]:
    shown = without_secrets(url)
    if _info(system, path, shown) is not None:
        yield (named(url.removesuffix(f"/{METADATA}")), "")
        return
    there = asked(lambda: system.find(path), shown)
    folders = {one.rpartition("/")[0] for one in there if file_name(one) == METADATA}
    found = {one for one in there if SUFFIX.search(file_name(one)) or _OTHER.search(file_name(one))}
    found = {one for one in found if one.rpartition("/")[0] not in folders} | folders
    yield from ((named(_url(system, one, url)), "") for one in sorted(found))
    if not found:
        yield named(url), "no recording in this folder"


def _url(system: Any, path: str, beside: str) -> str:
    """Return the URL of a path, in the chain of another URL."""
    _, chained, rest = beside.partition("::")
    return f"{system.unstrip_protocol(path)}{chained}{rest}"


def _is_pattern(url: str) -> bool:
    is_web = url.lower().startswith(("http://", "https://"))
    return glob.has_magic(_QUERY.sub("", url) if is_web else url)


def _system(url: str) -> tuple[Any, str]:
    """Return the file system of a URL, and the path in it; with the secrets that were given under this name."""
    shown = without_secrets(url)
    url = with_secrets(url)
    try:
        from fsspec.core import url_to_fs
    except ImportError:
        raise RecordingError(f'{shown}: needs fsspec; type: pip install "robowidgets[remote]"') from None
    options: dict[str, Any] = {}
    try:
        if url.lower().startswith(("http://", "https://")):
            from aiohttp import ClientTimeout

            # Streamed, because not all servers send parts. The total time has no limit, because a file may be large.
            options = {
                "client_kwargs": {"timeout": ClientTimeout(total=None, sock_connect=_LONGEST, sock_read=_LONGEST)},
                "headers": {"Accept-Encoding": "identity"},
                "block_size": 0,
            }
        system, path = url_to_fs(url, **options)
    except ImportError as error:
        raise RecordingError(
            f"{shown}: its driver is missing ({one_line(error)}); for s3 and http type: "
            'pip install "robowidgets[remote]"'
        ) from None
    except Exception as error:
        fail(error, shown)
    return system, path.removesuffix(f"/{METADATA}")


def _objects(system: Any, path: str, shown: str) -> tuple[list[_Object], bool]:
    """Return the files of the recording at a path, and True if it is a folder."""
    info = _info(system, path, shown)
    if info is not None:
        return [_object(info, path)], False
    there = {file_name(one["name"]): one for one in asked(lambda: system.ls(path, detail=True), shown)}
    names = sorted((name for name in there if SUFFIX.search(name)), key=natural)
    if not names:
        raise RecordingError(f"{shown}: no recording in this folder: expected .db3, .mcap or .bag files")
    if METADATA in there:
        names.append(METADATA)
    elif len(names) > 1 and not counts_up(names):
        raise RecordingError(f"{shown}: {len(names)} recordings in this folder: open one of them: {listed(names, 5)}")
    # The page of a web server lists names only; without sizes and states, the files would be fetched each time.
    infos = [
        one if one.get("size") is not None else asked(functools.partial(system.info, one["name"]), shown)
        for one in map(there.__getitem__, names)
    ]
    return [_object(info, info["name"]) for info in infos], True


def _info(system: Any, path: str, shown: str) -> dict[str, Any] | None:
    """Return the properties of a file, or None for a folder."""
    system.invalidate_cache()  # clears listings: an object may have changed since
    info: dict[str, Any] | None = None if path.endswith("/") else asked(lambda: system.info(path), shown)
    return None if info is None or info["type"] == "directory" else info


def _object(info: dict[str, Any], path: str) -> _Object:
    size = info.get("size")
    known = {name.lower(): str(value) for name, value in info.items() if name.lower() in _STATE and value}
    state = json.dumps([size, sorted(known.items())]) if known else ""
    headers = {name: str(info[name]) for name in ("ETag", "Last-Modified") if info.get(name)}
    return _Object(path, _safe(file_name(path)) or "recording", size, state, headers)


def _state(objects: list[_Object]) -> str:
    """Return a text for the state of the files, which differs each time if the server does not report a state."""
    return json.dumps([(one.name, one.state or uuid4().hex) for one in objects])


def _download(system: Any, objects: list[_Object], folder: Path, name: str, shown: str, reason: str) -> None:
    folder.mkdir(exist_ok=True)
    total = sum(one.size or 0 for one in objects)
    done = 0
    what = f"Fetching all of {name}, because {reason}" if reason and total > WHOLE else f"Fetching {name}"
    with Progress(total or None, what, "B") as bar:
        for one in objects:
            got = 0
            try:
                with system.open(one.path, "rb") as source, (folder / one.name).open("wb") as target:
                    while block := source.read(_BLOCK):
                        _write(target.write, block, shown)
                        got += len(block)
                        bar.update(len(block))
            except RecordingError:
                raise
            except Exception as error:
                of = f" of {megabytes(total)}" if total else ""
                fail(error, shown, f" after {megabytes(done + got)}{of}, which were discarded")
            if one.size is not None and got != one.size:
                raise RecordingError(
                    f"{shown}: the connection was lost, or it changed: {many(got, 'byte')} came of {one.size:,}, "
                    "which were discarded; open it again"
                )
            done += got


def _write(write: Callable[[bytes], Any], block: bytes, shown: str) -> None:
    try:
        write(block)
    except OSError as error:
        raise RecordingError(f"{shown}: its copy cannot be written: {error.strerror or error}") from None


def file_name(url: str) -> str:
    """Return the last part of the path of a URL."""
    return unquote(_QUERY.sub("", url).rstrip("/").rpartition("/")[2])


def _safe(name: str) -> str:
    """Return a safe local file name."""
    stem, suffix = os.path.splitext(_UNSAFE.sub("_", name).lstrip("."))
    return stem[:100] + suffix[:20]


def _short(text: str) -> str:
    return sha256(text.encode()).hexdigest()[:24]
