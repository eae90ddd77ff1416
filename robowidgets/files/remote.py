"""Remote recordings: in object storage, on a web server, or anywhere that fsspec can read."""

from __future__ import annotations

import glob
import json
import os
import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple, NoReturn, TypeGuard
from urllib.parse import unquote, urlsplit
from urllib.request import url2pathname
from uuid import uuid4

from ..messages.decoding import one_line
from ..notebook.progress import Progress
from ..repair import SUFFIX, RecordingError
from ..runtime.text import listed, many, megabytes
from ..runtime.urls import redacted, without_secrets
from . import METADATA, counts_up
from ._copies import Copy, find, holding, make

_URL = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+(://|::)")
_WEB = re.compile(r"(.*::)?https?://", re.IGNORECASE)
_QUERY = re.compile(r"(?<=.)\?.*")
_OTHER = re.compile(r"\.(log|clf)(\.gz)?$")
_UNSAFE = re.compile(r"[^\w.+ -]")
_FROM = ".url"
"""The file next to a copy that contains its URL."""
_BLOCK = 8 << 20
_STATE = (
    "etag", "content-md5", "md5hash", "md5", "generation", "versionid", "lastmodified", "last-modified",
    "last_modified", "mtime", "modified", "updated", "created",
)  # fmt: skip
"""The names that drivers use for the properties that change with an object, in addition to its size."""
_LONGEST = 60.0
"""Seconds without an answer from a web server."""
_CREDENTIALS = (
    "give credentials as its driver takes them (for s3: ~/.aws/credentials or AWS_ACCESS_KEY_ID and "
    "AWS_SECRET_ACCESS_KEY; FSSPEC_S3_ANON=true for what is public)"
)
_SIGNATURE = "give its whole URL, with credentials or a valid signature: URLs are stored and shown without them"
_NO_CREDENTIALS = (
    "NoCredentialsError",
    "PartialCredentialsError",
    "DefaultCredentialsError",
    "ClientAuthenticationError",
)


class _Object(NamedTuple):
    """One file of a recording: its path in its file system, its local name, its size in bytes, and its state."""

    path: str
    name: str
    size: int | None
    state: str


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


def fetch(url: str) -> Fetched:
    """Return the recording at a URL as a local file or folder; fetch it unless a copy of its current state exists.

    Raises:
        RecordingError: it cannot be fetched or stored; the text gives the reason and the remedy.
    """
    if url.lower().startswith(("file://", "local://")):
        return held(Path(url2pathname(urlsplit(url).path)))
    shown = url = named(url)
    system, path = _system(url)
    objects, is_folder = _objects(system, path, shown)
    key = f"{_short(url)}-{_short(_state(objects))}"
    name = _safe(file_name(path)) or "recording"

    def write(folder: Path) -> None:
        (folder / _FROM).write_text(url, encoding="utf-8")
        _download(system, objects, folder / name if is_folder else folder, name, shown)

    copy = find(key)
    if copy is None:
        try:
            copy = make(
                key,
                sum(one.size or 0 for one in objects),
                write,
            )
        except RecordingError as error:
            message = str(error)
            raise RecordingError(message if message.startswith(shown) else f"{shown}: {message}") from None
        except OSError as error:
            raise RecordingError(f"{shown}: its copy cannot be written: {error.strerror or error}") from None
    return Fetched(copy.folder / (name if is_folder else objects[0].name), url, copy)


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
        matches = sorted(_asked(lambda: system.glob(path), shown))
        for match in matches:
            yield from _within(system, match, _url(system, match, url))
        if not matches:
            yield shown, "nothing matches this pattern"
    except RecordingError as error:
        yield shown, str(error).removeprefix(f"{shown}: ")


def _within(system: Any, path: str, url: str) -> Iterator[tuple[str, str]]:
    shown = without_secrets(url)
    if not _is_folder(system, path, shown):
        yield (named(url.removesuffix(f"/{METADATA}")), "")
        return
    there = _asked(lambda: system.find(path), shown)
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
        _fail(error, shown)
    return system, path.removesuffix(f"/{METADATA}")


def _objects(system: Any, path: str, shown: str) -> tuple[list[_Object], bool]:
    """Return the files of the recording at a path, and True if it is a folder."""
    if not _is_folder(system, path, shown):
        return [_object(_asked(lambda: system.info(path), shown), path)], False
    there = {file_name(one["name"]): one for one in _asked(lambda: system.ls(path, detail=True), shown)}
    names = sorted(name for name in there if SUFFIX.search(name))
    if not names:
        raise RecordingError(f"{shown}: no recording in this folder: expected .db3, .mcap or .bag files")
    if METADATA in there:
        names.append(METADATA)
    elif len(names) > 1 and not counts_up(names):
        raise RecordingError(f"{shown}: {len(names)} recordings in this folder: open one of them: {listed(names, 5)}")
    return [_object(there[name], there[name]["name"]) for name in names], True


def _is_folder(system: Any, path: str, shown: str) -> bool:
    system.invalidate_cache()  # clears listings: an object may have changed since
    return path.endswith("/") or bool(_asked(lambda: system.info(path), shown)["type"] == "directory")


def _object(info: dict[str, Any], path: str) -> _Object:
    size = info.get("size")
    known = {name.lower(): str(value) for name, value in info.items() if name.lower() in _STATE and value}
    state = json.dumps([size, sorted(known.items())]) if known else ""
    return _Object(path, _safe(file_name(path)) or "recording", size, state)


def _state(objects: list[_Object]) -> str:
    """Return a text for the state of the files, which differs each time if the server does not report a state."""
    return json.dumps([(one.name, one.state or uuid4().hex) for one in objects])


def _download(system: Any, objects: list[_Object], folder: Path, name: str, shown: str) -> None:
    folder.mkdir(exist_ok=True)
    total = sum(one.size or 0 for one in objects)
    done = 0
    with Progress(total or None, f"Fetching {name}", "B") as bar:
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
                _fail(error, shown, f" after {megabytes(done + got)}{of}, which were discarded")
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


def _asked(ask: Callable[[], Any], shown: str) -> Any:
    try:
        return ask()
    except Exception as error:
        _fail(error, shown)


def _fail(error: Exception, shown: str, when: str = "") -> NoReturn:
    """Raise the error of a driver as a RecordingError; each driver has different errors."""
    causes: list[BaseException] = [error]
    while (cause := causes[-1].__cause__) is not None and cause not in causes:
        causes.append(cause)
    codes = {code for cause in causes if (code := _status(cause)) is not None}
    text = redacted(one_line(causes[-1] if isinstance(causes[-1], Exception) else error))
    kinds = {type(cause).__name__ for cause in causes}
    if any(isinstance(cause, PermissionError) for cause in causes) or codes & {401, 403} or kinds & {*_NO_CREDENTIALS}:
        text = f"no permission to read it ({text}): {_SIGNATURE if _WEB.match(shown) else _CREDENTIALS}"
    elif codes & {404, 410} or (isinstance(error, FileNotFoundError) and len(causes) == 1):
        text = "no such object, nor a folder with any"
    else:
        text = f"cannot be read{when}: {type(causes[-1]).__name__}: {text}"
    raise RecordingError(f"{shown}: {text}") from None


def _status(error: BaseException) -> int | None:
    """Return the HTTP status in an error of a driver, or None."""
    with suppress(Exception):
        code = getattr(error, "status", None) or error.response["ResponseMetadata"]["HTTPStatusCode"]  # type: ignore[attr-defined]
        return int(code)
    return None


def file_name(url: str) -> str:
    """Return the last part of the path of a URL."""
    return unquote(_QUERY.sub("", url).rstrip("/").rpartition("/")[2])


def _safe(name: str) -> str:
    """Return a safe local file name."""
    stem, suffix = os.path.splitext(_UNSAFE.sub("_", name).lstrip("."))
    return stem[:100] + suffix[:20]


def _short(text: str) -> str:
    return sha256(text.encode()).hexdigest()[:24]
