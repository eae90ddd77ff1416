"""rosbag2 databases that are cut, damaged, unfinished or foreign; no test writes to one."""

from __future__ import annotations

import shlex
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from robowidgets.files._rosbags import open_sqlite
from robowidgets.repair import RecordingError, open_repaired

from ..recordings.written import START_NS, STEP_NS, Message, messages, read, write_db3

HUMBLE = """
    CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
        serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
    CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
        data BLOB NOT NULL);
    CREATE INDEX timestamp_idx ON messages (timestamp ASC);
    INSERT INTO topics VALUES (1, '/scan', 'sensor_msgs/msg/LaserScan', 'cdr', ''),
        (2, '/cmd_vel', 'geometry_msgs/msg/Twist', 'cdr', '');
"""


def insert(connection: sqlite3.Connection, held: list[Message]) -> None:
    rows = [({"/scan": 1, "/cmd_vel": 2}[topic], time_ns, data) for topic, time_ns, data in held]
    connection.executemany("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)", rows)


def write_old(path: Path, held: list[Message]) -> Path:
    """A database as ROS 2 Humble writes it, without definitions."""
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.executescript(HUMBLE)
        insert(connection, held)
    return path


@pytest.fixture
def untouched(tmp_path: Path) -> Iterator[None]:
    """No file appears next to a database that is read."""
    yield
    strays = [path for path in tmp_path.rglob("*") if path.name.endswith(("-wal", "-shm", "-journal"))]
    assert strays == []


def test_reads_every_message_and_definition_that_rosbags_wrote(tmp_path: Path, untouched: None) -> None:
    held = messages()
    path = write_db3(tmp_path / "whole", held)
    before = path.read_bytes()
    source = open_repaired([path])
    assert read(source) == held
    assert source.problems == ()
    assert [(c.topic, c.type, c.encoding, c.count) for c in source.channels] == [
        ("/scan", "sensor_msgs/msg/LaserScan", "cdr", 67),
        ("/cmd_vel", "geometry_msgs/msg/Twist", "cdr", 33),
    ]
    assert "float32 angle_increment" in source.channels[0].definition
    assert (source.start_ns, source.end_ns) == (START_NS, START_NS + 99 * STEP_NS)
    source.close()
    assert path.read_bytes() == before


def test_reads_a_database_of_the_days_before_definitions(tmp_path: Path, untouched: None) -> None:
    held = messages()
    source = open_repaired([write_old(tmp_path / "old.db3", held)])
    assert read(source) == held
    assert {channel.definition for channel in source.channels} == {""}


def test_a_folder_without_write_permission_does_not_matter(tmp_path: Path) -> None:
    folder = tmp_path / "locked"
    folder.mkdir()
    path = write_old(folder / "a b#?%.db3", messages())
    path.chmod(0o400)
    folder.chmod(0o500)
    try:
        source = open_repaired([path])
        assert read(source) == messages()
        source.close()
        assert [entry.name for entry in folder.iterdir()] == ["a b#?%.db3"]
    finally:
        folder.chmod(0o700)


def test_a_file_cut_in_the_middle_is_read_up_to_the_cut(tmp_path: Path, untouched: None) -> None:
    held = messages(500)
    path = write_old(tmp_path / "cut.db3", held)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    source = open_repaired([path])
    saved = read(source)
    assert 200 <= len(saved) <= 300
    assert saved == held[: len(saved)]
    assert source.problems == (
        f"the recording was cut off: read {len(saved)} messages, up to {(saved[-1][1] - saved[0][1]) / 1e9:.1f} s",
    )


def test_a_lost_page_costs_the_messages_on_it_and_no_others(tmp_path: Path, untouched: None) -> None:
    held = messages(500)
    path = write_old(tmp_path / "page.db3", held)
    raw = bytearray(path.read_bytes())
    page = raw.index(held[250][2]) // 4096 * 4096
    raw[page : page + 4096] = bytes(4096)
    path.write_bytes(raw)
    source = open_repaired([path])
    saved = read(source)
    lost = [at for at, message in enumerate(held) if message not in saved]
    assert 1 <= len(lost) <= 10
    assert lost == list(range(lost[0], lost[-1] + 1))
    assert 250 in lost
    assert source.problems == (
        f"the recording is damaged in 1 place: read {500 - len(lost)} messages, up to {499 * STEP_NS / 1e9:.1f} s",
    )


def test_a_message_whose_end_is_lost_costs_itself_alone(tmp_path: Path, untouched: None) -> None:
    held = messages(40, size=32 * 400)
    path = write_old(tmp_path / "long.db3", held)
    raw = path.read_bytes()
    tail = raw.rindex(held[-1][2][-500:])
    path.write_bytes(raw[: tail // 4096 * 4096])
    source = open_repaired([path])
    saved = read(source)
    assert saved == [message for message in held if message in saved]
    assert len(saved) >= 35


def test_a_page_that_is_named_twice_gives_no_message_twice(tmp_path: Path, untouched: None) -> None:
    held = messages(500)
    path = write_old(tmp_path / "twice.db3", held)
    with closing(sqlite3.connect(path)) as connection:
        (page,) = connection.execute("SELECT rootpage FROM sqlite_master WHERE name = 'messages'").fetchone()
    raw = bytearray(path.read_bytes())
    root = (page - 1) * 4096
    cells = [root + int.from_bytes(raw[at : at + 2], "big") for at in range(root + 12, root + 32, 2)]
    assert raw[root] == 5
    raw[cells[6] : cells[6] + 4] = raw[cells[2] : cells[2] + 4]
    path.write_bytes(raw)
    source = open_repaired([path])
    saved = read(source)
    assert len(saved) == len(set(saved))
    assert 485 <= len(saved) < 500
    assert len(source.problems) == 1


@pytest.mark.parametrize("ending", ["-wal", "-journal"])
def test_the_log_of_a_killed_recorder_next_to_the_file_is_read_too(tmp_path: Path, ending: str) -> None:
    held = messages()
    live = tmp_path / "live" / "drive.db3"
    live.parent.mkdir()
    write_old(live, held[:60])
    with closing(sqlite3.connect(live, isolation_level=None)) as recorder:
        recorder.execute(f"PRAGMA journal_mode = {'WAL' if ending == '-wal' else 'DELETE'}")
        recorder.execute("PRAGMA cache_size = 1")
        recorder.execute("BEGIN")
        insert(recorder, held[60:])
        if ending == "-wal":
            recorder.execute("COMMIT")
        killed = tmp_path / "killed"
        killed.mkdir()
        for name in ("drive.db3", f"drive.db3{ending}"):
            (killed / name).write_bytes((live.parent / name).read_bytes())
    before = {path.name: path.read_bytes() for path in killed.iterdir()}
    assert before[f"drive.db3{ending}"]
    source = open_repaired([killed / "drive.db3"])
    count = 100 if ending == "-wal" else 60
    assert read(source) == held[:count]
    assert source.problems == (
        f"the recorder was stopped before it closed the file: read all of its {count} messages, "
        f"up to {(count - 1) * STEP_NS / 1e9:.1f} s",
    )
    source.close()
    assert {path.name: path.read_bytes() for path in killed.iterdir()} == before


class TestALogNextToADatabase:
    """The data that a killed recorder left in its ``-wal`` file: a transaction for each ten messages."""

    @pytest.fixture
    def killed(self, tmp_path: Path) -> Path:
        live = write_old(tmp_path / "live.db3", messages()[:60])
        killed = tmp_path / "killed" / "drive.db3"
        killed.parent.mkdir()
        with closing(sqlite3.connect(live)) as recorder:
            recorder.execute("PRAGMA journal_mode = WAL")
            recorder.execute("PRAGMA wal_checkpoint(RESTART)")
            for start in range(60, 100, 10):
                with recorder:
                    insert(recorder, messages()[start : start + 10])
            for ending in ("", "-wal"):
                killed.with_name(f"drive.db3{ending}").write_bytes(live.with_name(f"live.db3{ending}").read_bytes())
        return killed

    def check(self, killed: Path, least: int, most: int) -> None:
        source = open_repaired([killed])
        got = read(source)
        assert least <= len(got) <= most
        assert got == messages()[: len(got)]
        assert source.problems == (
            f"the recorder was stopped before it closed the file: read {len(got)} messages, up to "
            f"{(len(got) - 1) * STEP_NS / 1e9:.1f} s; "
            "the end of its -wal file is incomplete or damaged, so that messages are missing",
        )
        source.close()

    @pytest.mark.parametrize("left", [10, 31, 40, 60, 0.5, -4000, -100, -1])
    def test_that_was_cut_misses_messages(self, killed: Path, left: float) -> None:
        log = killed.with_name("drive.db3-wal")
        raw = log.read_bytes()
        log.write_bytes(raw[: int(len(raw) * left) if isinstance(left, float) else left])
        self.check(killed, 60, 90)

    @pytest.mark.parametrize("at", [2, 9, 17, 25, 30, 50, 5000, -5000, -4120, -4105, -3000])
    def test_with_a_flipped_bit_misses_messages(self, killed: Path, at: int) -> None:
        log = killed.with_name("drive.db3-wal")
        raw = bytearray(log.read_bytes())
        raw[at] ^= 4
        log.write_bytes(raw)
        self.check(killed, 60, 90)

    def test_may_end_with_pages_of_an_earlier_round(self, tmp_path: Path) -> None:
        live, killed = write_old(tmp_path / "live.db3", messages()[:10]), tmp_path / "drive.db3"
        with closing(sqlite3.connect(live)) as recorder:
            recorder.execute("PRAGMA journal_mode = WAL")
            with recorder:
                insert(recorder, messages()[10:90])
            recorder.execute("PRAGMA wal_checkpoint(RESTART)")
            with recorder:
                insert(recorder, messages()[90:])
            for ending in ("", "-wal"):
                killed.with_name(f"drive.db3{ending}").write_bytes(live.with_name(f"live.db3{ending}").read_bytes())
        source = open_repaired([killed])
        assert read(source) == messages()
        assert source.problems[0].startswith("the recorder was stopped before it closed the file: read all of its 100 ")
        source.close()


def test_rows_that_are_not_messages_are_left_out_and_reported(tmp_path: Path) -> None:
    path = write_old(tmp_path / "odd.db3", messages(10))
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("UPDATE messages SET data = 'text' WHERE id = 3")
        connection.execute("UPDATE messages SET timestamp = 'noon' WHERE id = 4")
        connection.execute("UPDATE messages SET topic_id = 9 WHERE id = 5")
    source = open_repaired([path])
    assert read(source) == messages(10)[:2] + messages(10)[5:]
    assert source.problems == (
        "the recording is damaged in 2 places: read 7 messages, up to 0.5 s",
        "left out 1 message of topics that the file does not name",
    )


def test_a_window_of_time_holds_its_start_and_not_its_stop(tmp_path: Path) -> None:
    source = open_repaired([write_old(tmp_path / "window.db3", messages())])
    scans = [channel for channel in source.channels if channel.topic == "/scan"]
    window = source.messages(scans, START_NS + 30 * STEP_NS, START_NS + 33 * STEP_NS)
    assert [(time_ns - START_NS) // STEP_NS for _, time_ns, _ in window] == [30, 31]


def test_an_empty_recording_is_not_an_error(tmp_path: Path) -> None:
    source = open_repaired([write_old(tmp_path / "empty.db3", [])])
    assert (source.start_ns, source.end_ns, source.problems) == (None, None, ())
    assert [channel.count for channel in source.channels] == [0, 0]


def test_a_closed_database_says_so(tmp_path: Path) -> None:
    source = open_repaired([write_old(tmp_path / "closed.db3", messages(3))])
    source.close()
    source.close()
    with pytest.raises(
        RecordingError, match=r"closed\.db3: is closed, or has changed since it was opened; open it again"
    ):
        read(source)


def test_another_database_is_named_by_its_tables(tmp_path: Path) -> None:
    path = tmp_path / "shop.db3"
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.executescript("CREATE TABLE orders(id); CREATE TABLE topics(id); CREATE VIEW messages AS SELECT 1;")
    with pytest.raises(RecordingError) as error:
        open_repaired([path])
    assert str(error.value) == (
        "shop.db3: an SQLite database, but not a rosbag2 recording: expected the tables 'topics' and 'messages', "
        "got 'orders', 'topics'"
    )


def test_foreign_empty_and_missing_files_are_named(tmp_path: Path) -> None:
    path = tmp_path / "x.db3"
    with pytest.raises(RecordingError, match=r"^x\.db3: cannot be opened: No such file"):
        open_repaired([path])
    path.touch()
    with pytest.raises(RecordingError, match=r"^x\.db3: the file is empty \(0 bytes\)"):
        open_repaired([path])
    path.write_bytes(b"\x1f\x8b\x08\0")
    with pytest.raises(RecordingError, match=r"^x\.db3: expected a rosbag2 database \(\.db3\), got gzip data$"):
        open_repaired([path])


def test_a_table_that_is_lost_is_named_with_a_way_out(tmp_path: Path) -> None:
    path = write_old(tmp_path / "x.db3", messages(500))
    path.write_bytes(path.read_bytes()[: 2 * 4096])
    with pytest.raises(
        RecordingError, match=r"^x\.db3: was cut off before its first message .*`sqlite3 x\.db3 \.recover`"
    ):
        open_repaired([path])


def test_a_recommended_command_runs_nothing_in_the_name_of_a_file(tmp_path: Path) -> None:
    path = write_old(tmp_path / "it's $(x) `y`.db3", messages(500))
    path.write_bytes(path.read_bytes()[: 2 * 4096])
    with pytest.raises(RecordingError) as raised:
        open_repaired([path])
    told = str(raised.value).partition("try `")[2].partition(".recover`")[0]
    assert shlex.split(told) == ["sqlite3", path.name]


def test_a_database_whose_first_page_is_lost_is_named_with_a_way_out(tmp_path: Path) -> None:
    path = write_old(tmp_path / "x.db3", messages())
    raw = path.read_bytes()
    path.write_bytes(raw[:100] + b"\xff" * 3996 + raw[4096:])
    with pytest.raises(
        RecordingError, match=r"^x\.db3: the database cannot be read .*`sqlite3 x\.db3 \.recover` may save"
    ):
        open_repaired([path])


def test_an_index_whose_times_differ_from_the_messages_is_not_read(tmp_path: Path) -> None:
    path = write_old(tmp_path / "flipped.db3", messages())
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("PRAGMA writable_schema = ON")
        connection.execute(
            "UPDATE sqlite_master SET sql = replace(sql, 'timestamp ASC', 'topic_id') WHERE type = 'index'"
        )
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("UPDATE messages SET timestamp = timestamp + 250000000 WHERE id = 40")
        connection.execute("PRAGMA writable_schema = ON")
        connection.execute("UPDATE sqlite_master SET sql = replace(sql, 'topic_id', 'timestamp') WHERE type = 'index'")
    with closing(open_sqlite(path)) as source, pytest.raises(RecordingError, match="its index of times disagrees"):
        source.arrivals  # noqa: B018
