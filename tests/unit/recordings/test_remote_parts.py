"""Remote MCAP files that are read in parts: few requests, the rows of the local file, and a clear line for failures."""

from __future__ import annotations

import tracemalloc
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import conditions
from robowidgets.files import remote

from ..pages import synced
from . import long_drive
from .range_server import RangeServer, serving

fsspec = pytest.importorskip("fsspec")
pytest.importorskip("aiohttp")

NEAR = conditions.nearest_below(1.5)
IMAGE = 900_000
CHUNKS = 45
"""More than `remote.WHOLE` bytes in all."""


class Pauses:
    """A clock whose pauses take no time."""

    def __init__(self) -> None:
        self.taken: list[float] = []

    def sleep(self, seconds: float) -> None:
        self.taken.append(seconds)


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("ROBOWIDGETS_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache" / "remote"


@pytest.fixture(autouse=True)
def pauses(monkeypatch: pytest.MonkeyPatch) -> Pauses:
    from robowidgets.files import _blocks

    clock = Pauses()
    monkeypatch.setattr(_blocks, "clock", clock)
    return clock


@pytest.fixture
def drive(tmp_path: Path) -> Path:
    return long_drive.write(tmp_path / "drive.mcap", CHUNKS, image=IMAGE, others=3)


@pytest.fixture
def server(drive: Path) -> Iterator[RangeServer]:
    with serving(drive) as one:
        yield one


def copies(cache: Path) -> list[str]:
    return [path.name for path in cache.glob("*/*.mcap")]


def plain(moment: Any) -> tuple[Any, ...]:
    """The content of a moment with a scan or a speed, to compare."""
    sample = moment.sample
    values = sample.ranges if moment.topic == "/scan" else sample.linear
    return moment.topic, moment.time_ns, tuple(values)


@pytest.mark.slow
def test_topics_take_few_requests_and_each_moment_few_more(tmp_path: Path, cache: Path) -> None:
    path = long_drive.write(tmp_path / "long.mcap", 2000, image=IMAGE, others=20, rare=12)
    assert path.stat().st_size > 1.8e9
    with serving(path) as server, robowidgets.open(path) as here, robowidgets.open(server.url) as there:
        assert [topic._replace(rate=None) for topic in there.topics] == [
            topic._replace(rate=None) for topic in here.topics
        ]
        assert there.topics[:23] == here.topics[:23]
        assert (there.start_ns, there.end_ns) == (here.start_ns, here.end_ns)
        assert len(server.requests) <= 10
        assert server.sent < path.stat().st_size / 50
        for seconds in (700.05, 1500.0, 1999.95):
            before = len(server.requests)
            assert plain(there.at("/scan", seconds)) == plain(here.at("/scan", seconds))
            assert plain(there.at("/speed", seconds)) == plain(here.at("/speed", seconds))
            assert len(server.requests) - before <= 2
        assert not copies(cache)


def test_a_search_gives_the_rows_of_the_local_file_and_asks_for_no_byte_twice(
    server: RangeServer, drive: Path, cache: Path
) -> None:
    with robowidgets.open(drive) as here, robowidgets.open(server.url) as there:
        assert there.topics == here.topics
        assert [*there.find(NEAR)] == [*here.find(NEAR)] != []
        assert np.array_equal(there.scans().ranges, here.scans().ranges)
        assert there.problems == here.problems == ()
        assert (there.path.name, there.url) == ("drive.mcap", server.url.partition("?")[0])
    gets = [request for request in server.requests if request.startswith("GET")]
    assert len(gets) == len(set(gets))
    assert server.sent <= drive.stat().st_size
    assert not copies(cache)


def test_readers_of_one_file_share_its_parts(server: RangeServer) -> None:
    with robowidgets.open(server.url) as recording:
        recording.at("/scan", 20.0)
        before = [request for request in server.requests if request.startswith("GET")]
        with recording.reopened() as again:
            assert plain(again.at("/scan", 20.0)) == plain(recording.at("/scan", 20.0))
        assert [request for request in server.requests if request.startswith("GET")] == before


@pytest.mark.parametrize(("most", "parts"), [((8 << 20, 5), 5), ((4 << 20, 100), 4), ((100, 100), 0)])
def test_parts_of_a_drive_take_a_request_each_and_no_more_bytes_than_allowed(
    server: RangeServer, monkeypatch: pytest.MonkeyPatch, most: tuple[int, int], parts: int
) -> None:
    monkeypatch.setattr("robowidgets.recordings.data.THINNED_FETCHED", most)
    with robowidgets.open(server.url) as recording:
        recording.at("/scan", 0.0)  # reads the mount of the scanner
        requests, sent = len(server.requests), server.sent
        found = recording.thinned_scans("/scan")
        assert (len(found), len(server.requests) - requests) == (parts, parts)
        assert server.sent - sent <= most[0]
        assert all(sum(map(len, chunks)) == 10 for chunks in found)


def test_a_server_that_fails_while_parts_are_read_is_named_and_the_player_is_shown(
    server: RangeServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("robowidgets.recordings.data.MOST_FETCHED", 10 << 20)
    with robowidgets.open(server.url) as recording:
        recording.at("/scan", 0.0)
        server.refusals += [403]
        with closing(recording.show("/scan")) as player:
            assert player.scanogram is None
            assert synced(player.bar, "_note").startswith("no scanogram: http://127.0.0.1")


@pytest.mark.slow
def test_a_player_of_a_long_drive_reads_what_it_shows_and_makes_a_scanogram_of_parts(tmp_path: Path) -> None:
    path = long_drive.write(tmp_path / "long.mcap", 200, image=IMAGE)
    with serving(path) as server, robowidgets.open(server.url) as recording:
        before = server.sent
        with closing(recording.show("/scan", "/speed")) as player:
            assert player.scanogram is not None
            assert synced(player.bar, "_note") == (
                "the scanogram shows 740 of 2,000 scans, evenly spread: its messages lie in 180.3 MB on a server; "
                "recording.show(scanogram=True) reads all"
            )
            player.seek(100.0)
            player.scanogram._wanted = [50.0, 60.0, 500.0]
            assert server.sent - before < (64 << 20) + 0.4 * path.stat().st_size


def test_a_lost_connection_and_a_busy_server_are_asked_again(server: RangeServer, drive: Path, pauses: Pauses) -> None:
    server.refusals, server.cuts = [503, 429], 1
    with robowidgets.open(drive) as here, robowidgets.open(server.url) as there:
        assert np.array_equal(there.scans().ranges, here.scans().ranges)
    assert pauses.taken == [0.5, 1.0, 2.0]


def test_a_server_that_stays_away_is_reported_and_nothing_is_read_by_half(
    server: RangeServer, drive: Path, pauses: Pauses
) -> None:
    with robowidgets.open(server.url) as there, robowidgets.open(drive) as here:
        server.refusals = [503] * 4
        with pytest.raises(robowidgets.RecordingError, match=r"drive\.mcap: cannot be read at byte [\d,]+: .*503") as e:
            there.scans().ranges  # noqa: B018
        assert "secret" not in str(e.value)
        assert len(pauses.taken) == 3
        assert np.array_equal(there.scans().ranges, here.scans().ranges)
        assert there.problems == ()


def test_credentials_that_expire_while_it_is_read_are_named(server: RangeServer, pauses: Pauses) -> None:
    with robowidgets.open(server.url) as recording:
        server.refusals = [403]
        with pytest.raises(
            robowidgets.RecordingError, match=r"its credentials have expired since it was opened.*give its whole URL"
        ):
            list(recording.samples())
        assert not pauses.taken


def test_a_newer_signature_is_used_for_what_is_not_there_yet(server: RangeServer) -> None:
    first = robowidgets.open(server.url)
    with robowidgets.open(server.url.replace("secret", "newer")) as recording:
        assert len(list(recording.samples("/scan"))) == 10 * CHUNKS
    first.close()
    assert {url.rpartition("=")[2] for url in server.urls} == {"secret", "newer"}
    assert server.urls[-1].endswith("newer")


@pytest.mark.parametrize("what", ["tag", "size"])
def test_a_file_that_changes_while_it_is_read_is_reported(server: RangeServer, drive: Path, what: str) -> None:
    if what == "size":
        server.tag = None
    with robowidgets.open(server.url) as recording:
        if what == "tag":
            server.tag = '"2"'
        else:
            long_drive.write(drive, CHUNKS + 1, image=IMAGE, others=3)
        with pytest.raises(robowidgets.RecordingError, match="it has changed since it was opened: open it again"):
            list(recording.samples())
    with robowidgets.open(server.url) as recording:
        assert len(list(recording.samples("/scan"))) == 10 * (CHUNKS + (what == "size"))


def test_a_server_without_ranges_sends_the_whole_file_once(server: RangeServer, drive: Path, cache: Path) -> None:
    server.mode = "ignore"
    for _ in range(2):
        with robowidgets.open(drive) as here, robowidgets.open(server.url) as there:
            assert there.topics == here.topics
            assert [*there.find(NEAR)] == [*here.find(NEAR)]
    assert copies(cache) == ["drive.mcap"]
    assert server.requests.count("GET") == 1


def test_a_server_that_sends_other_ranges_than_requested_is_reported(server: RangeServer) -> None:
    server.mode = "longer"
    with pytest.raises(
        robowidgets.RecordingError,
        match=r"answered a request for bytes 0-4194303 with 'bytes 0-4194313/\d+' of 4194314 bytes: .*download",
    ):
        robowidgets.open(server.url)


def test_a_cut_has_the_messages_of_a_cut_of_the_local_file(server: RangeServer, drive: Path, tmp_path: Path) -> None:
    with robowidgets.open(drive) as here, robowidgets.open(server.url) as there:
        cuts = [one[20:22].to_mcap(tmp_path / f"{number}.mcap") for number, one in enumerate((here, there))]
    with robowidgets.open(cuts[0]) as first, robowidgets.open(cuts[1]) as second:
        assert [topic._replace(rate=None) for topic in first.topics] == [
            topic._replace(rate=None) for topic in second.topics
        ]
        assert np.array_equal(first.scans().ranges, second.scans().ranges)


def test_a_file_of_another_program_is_read_in_parts(drive: Path, cache: Path) -> None:
    long_drive.write(drive, CHUNKS, image=IMAGE, profile="")
    with serving(drive) as server, robowidgets.open(drive) as here, robowidgets.open(server.url) as there:
        assert there.topics == here.topics
        assert [*there.find(NEAR)] == [*here.find(NEAR)] != []
        assert "GET" not in server.requests
    assert not copies(cache)


@pytest.mark.parametrize("damage", ["no index", "an index that lies", "JSON", "a clock set back"])
def test_a_file_without_a_usable_index_is_fetched_whole(
    damage: str, drive: Path, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    raw = bytearray(drive.read_bytes())
    if damage == "no index":
        drive.write_bytes(raw[: len(raw) - 2000])
    elif damage == "an index that lies":
        raw[-28:-20] = (1 << 20).to_bytes(8, "little")  # the offset of the summary, in the footer
        drive.write_bytes(raw)
    elif damage == "JSON":
        long_drive.write(drive, CHUNKS, image=IMAGE, others=3, encoding="json")
    else:
        long_drive.write(drive, CHUNKS, image=IMAGE, overlap_ns=2 * 10**9)
    bars: list[str] = []
    shown = remote.Progress

    def noted(total: Any, what: str, unit: str) -> Any:
        bars.append(what)
        return shown(total, what, unit)

    monkeypatch.setattr(remote, "Progress", noted)
    with serving(drive) as server, robowidgets.open(drive) as here, robowidgets.open(server.url) as there:
        assert there.topics == here.topics
        assert [*there.find(NEAR)] == [*here.find(NEAR)]
    assert copies(cache) == ["drive.mcap"]
    (bar,) = bars
    assert bar.startswith("Fetching all of drive.mcap, because it")


def test_a_file_that_turns_out_to_be_damaged_is_fetched_and_repaired(drive: Path, cache: Path) -> None:
    raw = bytearray(drive.read_bytes())
    middle = raw.index(b"jpeg", len(raw) // 2)
    raw[middle - 60 : middle - 40] = b"\xff" * 20
    drive.write_bytes(raw)
    with serving(drive) as server, robowidgets.open(drive) as here, robowidgets.open(server.url) as there:
        assert not copies(cache)
        assert [plain(one) for one in there.samples("/scan")] == [plain(one) for one in here.samples("/scan")]
        assert there.problems == here.problems != ()
        assert copies(cache) == ["drive.mcap"]


def test_other_file_systems_are_read_in_parts_and_checked_for_changes(drive: Path, cache: Path) -> None:
    system = fsspec.filesystem("memory")
    system.store.clear()
    system.pipe("/runs/drive.mcap", drive.read_bytes())
    with robowidgets.open("memory://runs/drive.mcap") as there:
        system.pipe("/runs/drive.mcap", drive.read_bytes())
        with pytest.raises(robowidgets.RecordingError, match="it has changed since it was opened: open it again"):
            list(there.samples())
    with robowidgets.open(drive) as here, robowidgets.open("memory://runs/drive.mcap") as there:
        assert there.topics == here.topics
        assert [*there.find(NEAR)] == [*here.find(NEAR)]
    system.store.clear()
    assert not copies(cache)


@pytest.mark.slow
def test_a_search_in_a_large_local_file_takes_little_memory(tmp_path: Path) -> None:
    path = long_drive.write(tmp_path / "large.mcap", 200, image=IMAGE)
    tracemalloc.start()
    with robowidgets.open(path) as recording:
        assert len([*recording.find(lambda moment: moment.scan.distance() < 1.5)])
        peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 0.1 * path.stat().st_size
