"""Remote ROS 1 bags that are read in parts: few requests, and the messages of the local file in its order."""

from __future__ import annotations

import struct
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

import robowidgets
from robowidgets.files import open_source, remote
from robowidgets.repair import JITTER_NS

from .range_server import serving
from .recorded import START_NS
from .written import STEP_NS, messages, read, write_bag

pytest.importorskip("fsspec")
pytest.importorskip("aiohttp")

IMAGE = 900_000
CHUNKS = 60
"""More than `remote.WHOLE` bytes in all."""


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("ROBOWIDGETS_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache" / "remote"


@pytest.fixture
def small_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Read small files in parts, too."""
    monkeypatch.setattr(remote, "WHOLE", 0)


def assert_same(path: Path, *, in_parts: bool = True) -> None:
    """Fail unless the remote bag has the channels, times and messages of the local one."""
    with closing(open_source(path)) as here, serving(path) as server:
        fetched, there = remote.opened(server.url)
        assert fetched.is_in_parts == in_parts
        assert there.channels == here.channels
        assert (there.start_ns, there.end_ns) == (here.start_ns, here.end_ns)
        assert read(there) == read(here)
        middle = (here.start_ns + here.end_ns) // 2
        for channels in (here.channels[:1], here.channels[1:]):
            within = [*here.messages(channels, middle - 2 * STEP_NS, middle + 20 * STEP_NS)]
            assert [*there.messages(channels, middle - 2 * STEP_NS, middle + 20 * STEP_NS)] == within
        if in_parts:
            assert [there.span_ns(one) for one in there.channels] == [here.span_ns(one) for one in here.channels]
        assert there.problems == here.problems
        there.close()
        fetched.close()


@pytest.mark.usefixtures("small_too")
@pytest.mark.parametrize("compression", ["none", "bz2", "lz4"])
def test_messages_come_in_the_order_of_the_local_bag(tmp_path: Path, compression: str) -> None:
    assert_same(write_bag(tmp_path / "a.bag", messages(300), compression))


@pytest.mark.usefixtures("small_too")
def test_messages_of_one_time_and_of_chunks_that_overlap_come_in_the_order_of_the_local_bag(tmp_path: Path) -> None:
    held = messages(200)
    # Pairs with one time, and single messages that arrive late: at the end of a chunk, too.
    times = [START_NS + (i // 2) * JITTER_NS // 4 - (i % 7 == 3) * JITTER_NS // 2 for i in range(len(held))]
    late = [(topic, time_ns, raw) for (topic, _, raw), time_ns in zip(held, times, strict=True)]
    assert_same(write_bag(tmp_path / "a.bag", late, chunk=1500))


@pytest.mark.usefixtures("small_too")
@pytest.mark.parametrize("name", ["good/turtlebot3_gazebo", "topics/scitos_amcl", "odd/lz4_stage_90_rays"])
def test_real_bags_are_read_in_parts(data: Path, name: str) -> None:
    assert_same(data / f"{name}.bag")


@pytest.mark.usefixtures("small_too")
@pytest.mark.parametrize("name", ["unindexed_killed_recorder", "truncated"])
def test_bags_without_an_index_are_fetched_whole(data: Path, name: str) -> None:
    assert_same(data / f"damaged/{name}.bag", in_parts=False)


@pytest.mark.usefixtures("small_too")
def test_a_bag_whose_clock_was_set_is_fetched_whole(tmp_path: Path) -> None:
    held = [(topic, time_ns - (i > 150) * 3600 * 10**9, raw) for i, (topic, time_ns, raw) in enumerate(messages(300))]
    assert_same(write_bag(tmp_path / "a.bag", held), in_parts=False)


@pytest.mark.usefixtures("small_too")
@pytest.mark.parametrize("damage", ["the table of chunks", "the index of a chunk", "a chunk"])
def test_a_bag_that_turns_out_to_be_damaged_is_fetched_and_repaired(tmp_path: Path, cache: Path, damage: str) -> None:
    path = write_bag(tmp_path / "a.bag", messages(300))
    raw = bytearray(path.read_bytes())
    if damage == "the table of chunks":
        at = raw.rindex(b"op=\x06") + 4
        at = raw.index(struct.pack("<L", 16), at) + 8  # the number of messages of the first connection
        raw[at : at + 4] = struct.pack("<L", 1)
    elif damage == "the index of a chunk":
        at = raw.index(b"op=\x04", len(raw) // 2)
        at = raw.rindex(b"count=", 0, raw.index(b"op=\x02", at)) + 6
        raw[at : at + 4] = struct.pack("<L", 1)
    else:
        at = raw.index(b"op=\x02", len(raw) // 2)
        raw[at : at + 4] = b"\xff" * 4
    path.write_bytes(raw)
    with closing(open_source(path)) as here, serving(path) as server:
        fetched, there = remote.opened(server.url)
        assert not cache.exists()
        assert read(there) == read(here)
        assert [one.name for one in cache.glob("*/*.bag")] == ["a.bag"]
        there.close()
        fetched.close()


def write_long(path: Path) -> Path:
    """A bag with a chunk each second: an image of so many bytes, and two rare topics."""
    store = get_typestore(Stores.ROS1_NOETIC)
    writer = Writer(path)
    writer.chunk_threshold = IMAGE
    with writer:
        names = {
            "/camera": "sensor_msgs/msg/CompressedImage",
            "/speed": "geometry_msgs/msg/Twist",
            "/alarm": "std_msgs/msg/String",
        }
        connections = {topic: writer.add_connection(topic, name, typestore=store) for topic, name in names.items()}
        speed, word, image = store.types[names["/speed"]], store.types[names["/alarm"]], store.types[names["/camera"]]
        vector, header = store.types["geometry_msgs/msg/Vector3"], store.types["std_msgs/msg/Header"]
        stamp = store.types["builtin_interfaces/msg/Time"](0, 0)

        def put(topic: str, time_ns: int, message: object) -> None:
            writer.write(connections[topic], time_ns, store.serialize_ros1(message, names[topic]))

        pixels = np.zeros(IMAGE, np.uint8)
        for second in range(CHUNKS):
            start = START_NS + second * 10**9
            for tenth in range(10):
                put("/speed", start + tenth * 10**8, speed(vector(0.1 * tenth, 0, 0), vector(0, 0, 0)))
            if second in (20, 40):
                put("/alarm", start + 95 * 10**7, word("bump"))
            put("/camera", start + 96 * 10**7, image(header(0, stamp, ""), "jpeg", pixels))
    return path


def test_topics_of_a_bag_take_few_requests_and_each_moment_few_more(tmp_path: Path, cache: Path) -> None:
    path = write_long(tmp_path / "long.bag")
    assert path.stat().st_size > remote.WHOLE
    with serving(path) as server, robowidgets.open(path) as here, robowidgets.open(server.url) as there:
        assert [topic._replace(rate=None) for topic in there.topics] == [
            topic._replace(rate=None) for topic in here.topics
        ]
        assert (there.start_ns, there.end_ns) == (here.start_ns, here.end_ns)
        assert len(server.requests) <= 10
        for seconds in (7.05, 30.0, 59.95):
            before = len(server.requests)
            assert there.at("/speed", seconds).sample == here.at("/speed", seconds).sample
            assert len(server.requests) - before <= 2
        assert server.sent < path.stat().st_size / 2
        alarms = [*there.messages("/alarm")]
        assert [str(one) for one in alarms] == [str(one) for one in here.messages("/alarm")]
        assert not cache.exists()


@pytest.mark.usefixtures("small_too")
def test_parts_of_a_bag_take_a_request_each_and_have_the_messages_of_their_time(tmp_path: Path) -> None:
    path = write_bag(tmp_path / "a.bag", messages(300), "lz4")
    with closing(open_source(path)) as here, serving(path) as server:
        fetched, there = remote.opened(server.url)
        requests = len(server.requests)
        parts = [*there.thinned(there.channels, 40_000, 4)]
        assert (len(parts), len(server.requests) - requests) == (4, 4)
        for part in parts:
            times = [time_ns for _, time_ns, _ in part]
            assert part == [*here.messages(here.channels, times[0], times[-1] + 1)]
        assert there.size_of(there.channels) <= path.stat().st_size
        there.close()
        fetched.close()
