"""Remote folders of several MCAP files that are read in parts: the messages of the local folder."""

from __future__ import annotations

import functools
import shutil
import threading
from collections.abc import Callable, Iterator
from contextlib import closing
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest

import robowidgets
from robowidgets.files import METADATA, open_source, remote

from .written import START_NS, STEP_NS, messages, read, write_indexed_mcap

fsspec = pytest.importorskip("fsspec")
from robowidgets.files import _blocks  # noqa: E402 (needs fsspec)
from robowidgets.files._blocks import driver_fetch  # noqa: E402

COUNT = 360
FILES = 12
"""More than ten: their names are not in alphabetical order."""


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("ROBOWIDGETS_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(remote, "WHOLE", 0)
    return tmp_path / "cache" / "remote"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A rosbag2 folder that was split into files."""
    held, each = messages(COUNT), COUNT // FILES
    folder = tmp_path / "drive"
    folder.mkdir()
    for number in range(FILES):
        part = write_indexed_mcap(tmp_path / f"part_{number}", held[number * each : (number + 1) * each])
        shutil.move(part, folder / f"drive_{number}.mcap")
    write_metadata(folder)
    return folder


def write_metadata(folder: Path, count: int = COUNT, files: int = FILES) -> None:
    names = "".join(f"    - drive_{number}.mcap\n" for number in range(files))
    text = (
        f"rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n  relative_file_paths:\n{names}"
        f"  duration:\n    nanoseconds: {(COUNT - 1) * STEP_NS}\n"
        f"  starting_time:\n    nanoseconds_since_epoch: {START_NS}\n  message_count: {count}\n"
    )
    (folder / METADATA).write_text(text)


@pytest.fixture
def url(folder: Path) -> Iterator[str]:
    """The URL at which `put` puts the folder."""
    yield "memory://runs/drive"
    fsspec.filesystem("memory").store.clear()


def put(folder: Path) -> None:
    for path in folder.iterdir():
        fsspec.filesystem("memory").pipe(f"/runs/drive/{path.name}", path.read_bytes())


def test_a_folder_of_several_files_is_read_in_parts(folder: Path, url: str, cache: Path) -> None:
    put(folder)
    with closing(open_source(folder)) as here:
        fetched, there = remote.opened(url)
        assert fetched.is_in_parts
        assert there.channels == here.channels
        assert (there.start_ns, there.end_ns) == (here.start_ns, here.end_ns)
        assert [there.span_ns(one) for one in there.channels] == [here.span_ns(one) for one in here.channels]
        assert read(there) == read(here)
        assert (there.problems, cache.exists()) == ((), False)
        there.close()


def test_a_moment_takes_bytes_of_its_file_only(folder: Path, url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[tuple[str, int]] = []

    def counted(system: Any, path: str, is_same: Callable[[], bool], shown: str) -> Any:
        fetch = driver_fetch(system, path, is_same, shown)
        return lambda start, end: asked.append((path, end - start)) or fetch(start, end)

    monkeypatch.setattr(_blocks, "driver_fetch", counted)
    monkeypatch.setattr(_blocks, "BLOCK", 2000)
    put(folder)
    fetched, there = remote.opened(url)
    size = sum(path.stat().st_size for path in folder.iterdir())
    assert sum(count for _, count in asked) < size
    asked.clear()
    time_ns = START_NS + 200 * STEP_NS
    assert [time_ns for _, time_ns, _ in there.messages(there.channels, time_ns, time_ns + 1)] == [time_ns]
    assert {path for path, _ in asked} == {"/runs/drive/drive_6.mcap"}
    asked.clear()
    assert next(there.messages(there.channels))[1] == START_NS
    assert {path for path, _ in asked} == {"/runs/drive/drive_0.mcap"}
    there.close()
    fetched.close()


@pytest.mark.parametrize("odd", ["no metadata", "another count", "a file that is not named"])
def test_a_folder_that_its_metadata_do_not_describe_is_fetched_whole(
    folder: Path, url: str, cache: Path, odd: str
) -> None:
    if odd == "no metadata":
        (folder / METADATA).unlink()
    elif odd == "another count":
        write_metadata(folder, COUNT - 1)
    else:
        write_metadata(folder, files=FILES - 1)
    put(folder)
    with closing(open_source(folder)) as here:
        fetched, there = remote.opened(url)
        assert not fetched.is_in_parts
        assert read(there) == read(here)
        assert there.problems == here.problems
        there.close()
    fetched.close()


def test_a_damaged_file_of_a_folder_is_fetched_with_the_others_and_repaired(
    folder: Path, url: str, cache: Path
) -> None:
    damaged = folder / "drive_7.mcap"
    raw = bytearray(damaged.read_bytes())
    raw[len(raw) // 3 : len(raw) // 3 + 200] = bytes(200)
    damaged.write_bytes(raw)
    put(folder)
    with closing(open_source(folder)) as here:
        fetched, there = remote.opened(url)
        assert read(there) == read(here)
        assert there.problems == here.problems != ()
        assert len([*cache.glob("*/drive/*.mcap")]) == FILES
        there.close()
    fetched.close()


def test_a_small_folder_on_a_web_server_is_fetched_once(
    folder: Path, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("aiohttp")
    monkeypatch.setattr(remote, "WHOLE", 1 << 20)
    gets: list[str] = []

    class Handler(SimpleHTTPRequestHandler):
        def end_headers(self) -> None:
            self.send_header("ETag", '"1"')  # early versions of fsspec leave out the time
            super().end_headers()

        def log_request(self, *_: Any) -> None:
            if self.command == "GET" and not self.path.endswith("/"):
                gets.append(self.path)

    server = ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Handler, directory=str(folder.parent)))
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    for _ in range(2):
        with robowidgets.open(f"http://127.0.0.1:{server.server_port}/drive/") as there:
            assert sum(topic.count for topic in there.topics) == COUNT
            assert there.problems == ()
    server.shutdown()
    thread.join()
    server.server_close()
    assert sorted(gets) == sorted({*gets})
    assert len([*cache.glob("*/drive")]) == 1
