"""Recordings behind a URL: fetched once, within a size limit, and never half."""

from __future__ import annotations

import json
import os
import shutil
import sys
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets.command import _notebooks, main
from robowidgets.files import _copies, remote

from ..pages import display_html

fsspec = pytest.importorskip("fsspec")

SAMPLE = Path(robowidgets.SAMPLE)
DATA = SAMPLE.read_bytes()


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("ROBOWIDGETS_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache" / "remote"


@pytest.fixture
def memory() -> Iterator[Any]:
    system = fsspec.filesystem("memory")
    system.store.clear()
    system.pipe("/runs/drive.mcap", DATA)
    yield system
    system.store.clear()


@pytest.fixture
def reads(memory: Any, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The objects that were fetched from the memory."""
    found: list[str] = []
    opened = type(memory)._open

    def noted(self: Any, path: str, *args: Any, **kwargs: Any) -> Any:
        if "r" in kwargs.get("mode", "rb"):
            found.append(path)
        return opened(self, path, *args, **kwargs)

    monkeypatch.setattr(type(memory), "_open", noted)
    return found


def copies(folder: Path) -> list[Path]:
    return [path for path in folder.iterdir() if not path.name.startswith(".")] if folder.exists() else []


def parts(folder: Path) -> list[Path]:
    return [path for path in folder.iterdir() if path.name.startswith(".")] if folder.exists() else []


def test_a_url_gives_what_the_file_gives_and_is_fetched_once(reads: list[str]) -> None:
    with robowidgets.open(SAMPLE) as there, robowidgets.open("memory://runs/drive.mcap") as recording:
        assert recording.topics == there.topics
        assert np.array_equal(recording.scans().ranges, there.scans().ranges, equal_nan=True)
        assert recording.path.name == "drive.mcap"
        assert recording.url == "memory://runs/drive.mcap"
        assert recording.info().startswith("memory://runs/drive.mcap: ")
    with robowidgets.open("memory://runs/drive.mcap"):
        pass
    assert len(reads) == 1


@pytest.mark.slow
def test_a_player_and_a_page_need_no_second_fetch(reads: list[str], tmp_path: Path) -> None:
    with robowidgets.open("memory://runs/drive.mcap") as recording:
        player = recording.show(scanogram=False)
        page = recording.to_html(tmp_path / "drive.html", start=0, end=1)
    assert player.recording.url == "memory://runs/drive.mcap"
    player.close()
    assert page.stat().st_size
    assert len(reads) == 1


def test_a_recording_closed_long_ago_is_fetched_again_to_be_shown(reads: list[str], cache: Path) -> None:
    with robowidgets.open("memory://runs/drive.mcap") as recording:
        pass
    shutil.rmtree(cache)
    recording.show(scanogram=False).close()
    assert len(reads) == 2


def test_an_object_that_changed_is_fetched_again(memory: Any, reads: list[str]) -> None:
    with robowidgets.open("memory://runs/drive.mcap"):
        before = remote.state_of("memory://runs/drive.mcap")
    memory.pipe("/runs/drive.mcap", DATA)
    assert remote.state_of("memory://runs/drive.mcap") != before
    with robowidgets.open("memory://runs/drive.mcap"):
        pass
    assert len(reads) == 2


def test_a_folder_of_rosbag2_is_one_recording(memory: Any) -> None:
    metadata = "rosbag2_bagfile_information:\n  relative_file_paths:\n    - a_0.mcap\n"
    memory.pipe("/bag/a_0.mcap", DATA)
    memory.pipe("/bag/metadata.yaml", metadata.encode())
    for url in ("memory://bag", "memory://bag/", "memory://bag/metadata.yaml"):
        with robowidgets.open(url) as recording:
            assert recording.path.name == "bag"
            assert recording.path.is_dir()
            assert recording.topics
    assert [*remote.recordings_at("memory://bag")] == [("memory:///bag", "")]


def test_a_folder_of_several_recordings_is_not_fetched(memory: Any, reads: list[str]) -> None:
    memory.pipe("/runs/other.mcap", DATA)
    with pytest.raises(
        robowidgets.RecordingError, match=r"2 recordings in this folder: open one of them: drive.mcap, "
    ):
        robowidgets.open("memory://runs")
    assert not reads


@pytest.mark.parametrize("size", ["much", "-3 GB", "10 XB"])
def test_a_limit_that_is_not_a_size_is_reported(memory: Any, monkeypatch: pytest.MonkeyPatch, size: str) -> None:
    monkeypatch.setenv("ROBOWIDGETS_CACHE_SIZE", size)
    with pytest.raises(
        robowidgets.RecordingError, match="ROBOWIDGETS_CACHE_SIZE: expected a size such as '20 GB', got"
    ):
        robowidgets.open("memory://runs/drive.mcap")


def test_more_than_all_copies_may_take_is_refused_before_it_is_fetched(
    reads: list[str], cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROBOWIDGETS_CACHE_SIZE", "1 kB")
    with pytest.raises(robowidgets.RecordingError, match=r"memory://runs/drive.mcap: .* set ROBOWIDGETS_CACHE_SIZE hi"):
        robowidgets.open("memory://runs/drive.mcap")
    assert not reads
    assert not copies(cache)


def test_those_used_longest_ago_go_first_and_never_an_open_one(
    memory: Any, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("a", "b", "c", "d"):
        memory.pipe(f"/runs/{name}.mcap", DATA)
    monkeypatch.setenv("ROBOWIDGETS_CACHE_SIZE", str(len(DATA) * 3 + 1000))
    oldest = robowidgets.open("memory://runs/a.mcap")
    for name in ("b", "c"):
        robowidgets.open(f"memory://runs/{name}.mcap").close()
    again = robowidgets.open("memory://runs/a.mcap")
    again.close()
    age(cache, {"a": 3, "b": 2, "c": 1})
    with robowidgets.open("memory://runs/d.mcap"):
        assert names(cache) == ["a", "c", "d"]
        assert oldest.scans().ranges.size
    age(cache, {"a": 3, "c": 2, "d": 1})
    oldest.close()
    with robowidgets.open("memory://runs/b.mcap"):
        assert names(cache) == ["b", "c", "d"]
    assert not parts(cache)


def names(cache: Path) -> list[str]:
    return sorted(file.stem for file in cache.glob("*/*.mcap"))


def age(cache: Path, ages: dict[str, float]) -> None:
    for file in cache.glob("*/*.mcap"):
        used = file.stat().st_mtime - 1000 * ages[file.stem]
        os.utime(file.parent / ".lock", (used, used))


def test_a_local_file_in_the_cache_is_held_too(memory: Any, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with robowidgets.open("memory://runs/drive.mcap") as recording:
        again = robowidgets.open(recording.path)
    memory.pipe("/runs/b.mcap", DATA)
    monkeypatch.setenv("ROBOWIDGETS_CACHE_SIZE", str(len(DATA) + 10))
    with robowidgets.open("memory://runs/b.mcap"):
        assert again.scans().ranges.size
    again.close()


def test_what_a_killed_process_left_is_removed(memory: Any, cache: Path) -> None:
    left = cache / ".part-left"
    left.mkdir(parents=True)
    (left / ".lock").touch()
    os.utime(left / ".lock", (0, 0))
    (left / "drive.mcap").write_bytes(DATA)
    robowidgets.open("memory://runs/drive.mcap").close()
    assert not left.exists()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only Linux has a disk that is always full")
def test_a_full_disk_is_reported_and_leaves_nothing(memory: Any, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    opened = Path.open

    def on_full_disk(self: Path, mode: str = "r", *args: Any, **kwargs: Any) -> Any:
        if mode == "wb" and cache in self.parents:
            return opened(Path("/dev/full"), mode, 0)
        return opened(self, mode, *args, **kwargs)

    monkeypatch.setattr(Path, "open", on_full_disk)
    with pytest.raises(robowidgets.RecordingError, match="its copy cannot be written: No space left on device"):
        robowidgets.open("memory://runs/drive.mcap")
    assert not copies(cache)
    assert not parts(cache)


def test_a_disk_with_less_room_is_reported_before_anything_is_fetched(
    reads: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    usage = shutil.disk_usage("/")
    monkeypatch.setattr(_copies.shutil, "disk_usage", lambda _: usage._replace(free=10))
    with pytest.raises(robowidgets.RecordingError, match=r"and the disk of .* has 0 kB left"):
        robowidgets.open("memory://runs/drive.mcap")
    assert not reads


def test_an_interrupt_leaves_nothing(memory: Any, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*args: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(remote, "_write", interrupted)
    with pytest.raises(KeyboardInterrupt):
        robowidgets.open("memory://runs/drive.mcap")
    assert not copies(cache)
    assert not parts(cache)


@pytest.mark.parametrize(
    ("url", "error"),
    [
        ("memory://runs/none.mcap", "memory://runs/none.mcap: no such object"),
        ("nonsense://x/y.mcap", "nonsense://x/y.mcap: cannot be read: .*Protocol not known: nonsense"),
        ("memory://", "no recording in this folder"),
    ],
)
def test_a_wrong_url_is_reported(memory: Any, url: str, error: str) -> None:
    with pytest.raises(robowidgets.RecordingError, match=error):
        robowidgets.open(url)


@pytest.mark.parametrize(
    ("missing", "text"), [("fsspec.core", "needs fsspec"), ("s3fs", "its driver is missing .*s3fs")]
)
def test_a_missing_driver_is_reported_with_the_command_that_brings_it(
    monkeypatch: pytest.MonkeyPatch, missing: str, text: str
) -> None:
    monkeypatch.setitem(sys.modules, missing, None)
    registered = sys.modules["fsspec.registry"]
    monkeypatch.delitem(registered._registry, "s3", raising=False)
    with pytest.raises(robowidgets.RecordingError, match=f'{text}.*pip install "robowidgets\\[remote\\]"'):
        robowidgets.open("s3://bucket/drive.mcap")


def test_a_file_url_is_the_file(cache: Path) -> None:
    with robowidgets.open(SAMPLE.as_uri()) as recording:
        assert recording.path == SAMPLE
    assert not cache.exists()


def test_patterns_and_folders_name_their_recordings(memory: Any) -> None:
    memory.pipe("/runs/deep/bag/a_0.mcap", DATA)
    memory.pipe("/runs/deep/bag/metadata.yaml", b"x")
    memory.pipe("/runs/notes.txt", b"x")
    assert [*remote.recordings_at("memory://runs")] == [
        ("memory:///runs/deep/bag", ""),
        ("memory:///runs/drive.mcap", ""),
    ]
    assert [*remote.recordings_at("memory://runs/*.mcap")] == [("memory:///runs/drive.mcap", "")]
    assert [*remote.recordings_at("memory://runs/*.bag")] == [("memory://runs/*.bag", "nothing matches this pattern")]
    ((_, problem),) = remote.recordings_at("memory://nowhere")
    assert problem.startswith("no such object")


def test_the_command_takes_a_url(memory: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["info", "--json", "memory://runs/drive.mcap"]) == 0
    assert json.loads(capsys.readouterr().out)["path"] == "memory://runs/drive.mcap"


class Server(ThreadingHTTPServer):
    """A web server that may cut connections, ask for a password, or send no version of its files."""

    cut = 0
    status = 200
    tag: str | None = '"1"'
    fetched = 0
    signature = ""


class Handler(BaseHTTPRequestHandler):
    server: Server

    def do_HEAD(self) -> None:
        self._head()

    def do_GET(self) -> None:
        self._head()
        if self._status() == 200:
            self.server.fetched += 1
            self.wfile.write(DATA[: len(DATA) - self.server.cut])

    def _head(self) -> None:
        self.send_response(self._status())
        self.send_header("Content-Length", str(len(DATA)))
        if self.server.tag:
            self.send_header("ETag", self.server.tag)
        self.end_headers()

    def _status(self) -> int:
        if self.server.signature not in self.path:
            return 403
        return self.server.status if "none" not in self.path else 404

    def log_message(self, *args: Any) -> None:
        pass


@pytest.fixture
def server() -> Iterator[Server]:
    pytest.importorskip("aiohttp")
    with Server(("127.0.0.1", 0), Handler) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def url_of(server: Server, name: str = "drive.mcap?signature=secret") -> str:
    return f"http://127.0.0.1:{server.server_port}/{name}"


def test_a_web_server_is_read_once_and_again_after_a_change(server: Server) -> None:
    for tag, fetched in (('"1"', 1), ('"1"', 1), ('"2"', 2)):
        server.tag = tag
        with robowidgets.open(url_of(server)) as recording:
            assert recording.path.name == "drive.mcap"
            assert recording.scans().ranges.size
            assert "secret" not in recording.info()
        assert server.fetched == fetched


def test_a_server_that_tells_no_state_is_read_each_time(server: Server) -> None:
    server.tag = None
    for fetched in (1, 2):
        with robowidgets.open(url_of(server)) as recording:
            recording.show(scanogram=False).close()
        assert server.fetched == fetched
    assert remote.state_of(url_of(server)) is None


def test_a_connection_lost_in_the_middle_leaves_nothing_and_is_reported(server: Server, cache: Path) -> None:
    server.cut = len(DATA) // 2
    with pytest.raises(robowidgets.RecordingError, match=r"drive\.mcap: .*which were discarded") as e:
        robowidgets.open(url_of(server))
    assert "secret" not in str(e.value)
    assert not copies(cache)
    assert not parts(cache)
    server.cut = 0
    robowidgets.open(url_of(server)).close()


@pytest.mark.parametrize(
    ("status", "name", "error"),
    [(403, "a.mcap", "no permission to read it .*credentials"), (200, "none.mcap", "no such object")],
)
def test_what_a_web_server_refuses_is_reported(server: Server, status: int, name: str, error: str) -> None:
    server.status = status
    with pytest.raises(robowidgets.RecordingError, match=error):
        robowidgets.open(url_of(server, name))


SECRET = "hunter2SECRET"


def signed_by(server: Server, secret: str = SECRET) -> str:
    """A URL that holds a password, a signature, and a parameter that names the object."""
    return f"http://ada:{secret}@127.0.0.1:{server.server_port}/drive.mcap?versionId=3&X-Amz-Signature={secret}"


@pytest.fixture
def guarded(server: Server, monkeypatch: pytest.MonkeyPatch) -> Server:
    """A server that sends its file for the right signature; this process has no URL yet."""
    monkeypatch.setattr(remote, "_given", {})
    server.signature = SECRET
    return server


@pytest.mark.slow
def test_a_secret_of_a_url_is_neither_shown_nor_written_and_its_name_opens_while_the_process_runs(
    guarded: Server, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("pyarrow")
    url = signed_by(guarded)
    name = f"http://127.0.0.1:{guarded.server_port}/drive.mcap?versionId=3"
    wrong = signed_by(guarded).replace("drive.mcap", "none.mcap")
    near = robowidgets.conditions.nearest_below(0.5)
    index = tmp_path / "drives.parquet"
    drives = robowidgets.index(url, wrong, output=index)
    hits = robowidgets.find(near, url, keep=True)
    many = robowidgets.find(near, url, wrong, keep=False)  # by processes of their own
    tables = [hits, many, drives.find(near), robowidgets.summary(url), robowidgets.fleet.doctor(url)]
    assert drives.files == (name, name.replace("drive", "none"))
    assert {hit.file for hit in [*hits, *many, *drives.find(near)]} == {name}
    with robowidgets.open(url) as recording:
        shown = [recording.url, repr(recording), display_html(recording)]
        with pytest.raises(robowidgets.RecordingError, match="labels cannot be stored with a copy") as error:
            recording.label("door", 0, 1)
    shown += [str(error.value), *(f"{table!r}{display_html(table)}" for table in tables)]
    shown += [f"{table.to_json()}{table.files}{table.unread}" for table in (hits, many)]
    hits[:2].to_html(tmp_path / "hits.html")
    (tmp_path / "folder").mkdir()
    assert f"robowidgets.open('{name}')" in _notebooks.write_for(url, tmp_path / "folder").read_text("utf-8")
    assert main(["info", "--json", url]) == 0
    assert main(["find", "--nearest-below", "0.5", url, wrong]) == 0
    shown += capsys.readouterr()
    assert not [text for text in shown if SECRET in text]
    written = [file for file in tmp_path.rglob("*") if file.is_file()]
    assert {".url", ".jsonl", ".parquet", ".html", ".ipynb"} <= {file.suffix or file.name for file in written}
    assert not [file.name for file in written if SECRET.encode() in file.read_bytes()]
    columns = drives.to_arrow().to_pylist()
    assert not [row for row in columns if SECRET in json.dumps(row, default=str)]
    shutil.rmtree(tmp_path / "cache")  # fetched again, by its name
    with robowidgets.open(name) as recording:
        assert recording.url == name


def test_in_another_process_the_name_asks_for_the_whole_url_and_the_command_passes_it_to_its_kernels(
    guarded: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    url = signed_by(guarded)
    with robowidgets.open(url) as recording:
        name = recording.url
    monkeypatch.setenv(remote.IN_ENVIRONMENT, "")
    remote.pass_secrets(str(name))
    monkeypatch.setattr(remote, "_given", {})  # as in another process
    robowidgets.open(str(name)).close()
    monkeypatch.delenv(remote.IN_ENVIRONMENT)
    with pytest.raises(robowidgets.RecordingError, match=r"no permission .*: give its whole URL, with cred") as error:
        robowidgets.open(str(name))
    assert SECRET not in str(error.value)


def test_a_signature_made_again_is_the_same_recording_and_needs_no_second_fetch(guarded: Server) -> None:
    robowidgets.open(signed_by(guarded)).close()
    before, guarded.signature = remote.state_of(signed_by(guarded)), "another"
    robowidgets.open(signed_by(guarded, "another")).close()
    assert remote.state_of(signed_by(guarded, "another")) == before
    assert guarded.fetched == 1


def test_a_server_that_is_not_there_is_reported(server: Server) -> None:
    with Server(("127.0.0.1", 0), Handler) as gone:
        url = url_of(gone)
    with pytest.raises(robowidgets.RecordingError, match=r"cannot be read: ConnectionRefused"):
        robowidgets.open(url)
