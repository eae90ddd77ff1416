"""The file states that reveal a changed recording."""

from __future__ import annotations

import sqlite3
from pathlib import Path
from threading import Barrier

import pytest
from rosbags.rosbag2 import StoragePlugin

import robowidgets
from robowidgets import conditions
from robowidgets.files import remote
from robowidgets.fleet import find
from robowidgets.fleet._kept import states_of
from robowidgets.repair import RecordingError

from ..recordings import recorded


def test_servers_are_asked_at_once_and_each_answer_belongs_to_its_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    together = Barrier(4)  # breaks unless four are asked at once

    def state_of(url: str) -> str:
        together.wait(60)
        if url.endswith("3"):
            raise RecordingError("no permission")
        if url.endswith("2"):
            raise ZeroDivisionError("of a driver")
        return f"state of {url}"

    monkeypatch.setattr(remote, "state_of", state_of)
    urls = [f"s3://bucket/{number}" for number in range(4)]
    missing = tmp_path / "missing.bag"
    found = states_of([*urls, Path(robowidgets.SAMPLE), missing])
    assert list(found) == [*urls, str(robowidgets.SAMPLE), str(missing)]
    assert [found[url].text for url in urls] == [*(f"state of {url}" for url in urls[:2]), None, None]
    assert found[urls[3]].problem == "no permission"
    assert found[urls[2]].problem == "its state cannot be read: ZeroDivisionError: of a driver"
    assert str(robowidgets.SAMPLE.stat().st_size) in (found[str(robowidgets.SAMPLE)].text or "")


def test_a_database_whose_recorder_goes_on_writing_next_to_it_is_searched_again(tmp_path: Path) -> None:
    messages = [(i / 10, "/f", {"data": float(i)}) for i in range(20)]
    folder = recorded.write(tmp_path / "run", {"/f": "std_msgs/msg/Float32"}, messages, StoragePlugin.SQLITE3)
    (database,) = folder.glob("*.db3")
    (folder / "metadata.yaml").unlink()
    recorder = sqlite3.connect(database)
    recorder.execute("PRAGMA journal_mode=WAL")
    recorder.execute("PRAGMA wal_autocheckpoint=0")
    ends = []
    for _ in range(2):
        with recorder:
            (last, data), *_ = recorder.execute("SELECT timestamp, data FROM messages ORDER BY timestamp DESC")
            recorder.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (1, ?, ?)", (last + 10**9, data))
        ends += [find(conditions.field("/f.data") > 10, path)[0].end for path in (database, folder)]
    recorder.close()
    assert ends == pytest.approx([2.9, 2.9, 3.9, 3.9])
