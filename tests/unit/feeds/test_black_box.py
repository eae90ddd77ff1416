"""The last minute of a robot, which becomes a file when something happens."""

from __future__ import annotations

import errno
import logging
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import conditions
from robowidgets.behaviors import Drive
from robowidgets.command import main
from robowidgets.events.frames import event_marks
from robowidgets.feeds import Advert, Feed, FeedError
from robowidgets.recordings import ring, ring_writer

from ..clocks import ManualClock
from ..pages import synced
from ..waiting import threads_named, wait_for
from .scripted import CMD_VEL, IMU, ODOM, SCAN, Scripted, scan

BUMPER = Advert("/bumper", "kobuki_msgs/msg/BumperEvent", wanted=False)
DIAGNOSTICS = Advert("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", wanted=False)
TF_STATIC = Advert("/tf_static", "tf2_msgs/msg/TFMessage", wanted=False)

ROOT = Path(__file__).parents[3]
KILLED = """
import sys
from robowidgets import feeds
from robowidgets.behaviors import Drive
from tests.unit.waiting import wait_for
robot = feeds.simulator(wander=False, hz=50)
box = robot.black_box("/scan", "/odom", seconds=30, folder=sys.argv[1])
@robot.program
def ahead():
    return Drive(0.1)
wait_for(lambda: box.written["/scan"] >= 20, "scans are written")
box.save("a strange noise")
wait_for(lambda: box.written["/robowidgets/black_box"], "the cause is written")
count = box.written["/scan"]
wait_for(lambda: box.written["/scan"] > count, "the cause is flushed, before the next message")
print("ready", flush=True)
sys.stdin.read()
"""


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


def words(path: Path) -> list[str]:
    """The causes in a file."""
    with robowidgets.open(path) as recording:
        assert recording.problems == ()
        return [event.text for event in recording.events(ring.CAUSES)]


def pass_seconds(script: Scripted, clock: ManualClock, seconds: int) -> None:
    """Send a scan each second."""
    for _ in range(seconds):
        script.listener.on_message("/scan", scan())
        clock.advance(1.0)


def there(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def fill_disk(*_: Any) -> None:
    raise OSError(errno.ENOSPC, "No space left on device")


def feel(monkeypatch: pytest.MonkeyPatch, box: Any, causes_in: Any) -> None:
    """Replace the function that finds causes in messages."""
    writer = box._writer
    monkeypatch.setattr(writer, "_finder", replace(writer._finder, causes_in=causes_in))


def test_a_file_has_the_minute_before_and_the_seconds_after_its_cause_which_it_marks(
    tmp_path: Path, clock: ManualClock
) -> None:
    script = Scripted(SCAN, CMD_VEL)
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(folder=tmp_path / "box")
        pass_seconds(script, clock, 100)
        (folder,) = (tmp_path / "box").iterdir()
        assert len(list(folder.glob("*.mcap"))) <= ring_writer.PARTS + 2, "the past takes no more"
        feed.stopped = True
        pass_seconds(script, clock, 4)
        assert box.files == ()
        pass_seconds(script, clock, 2)
        (path,) = box.files
        assert repr(box) == f"black box: last 60 s, 1 file, in {tmp_path / 'box'}"
    with robowidgets.open(path) as recording:
        (mark,) = event_marks(recording)  # in its player
        assert mark[2] == "WARN: black box: Stop"
        assert 60 <= mark[0] <= 60 + ring_writer.LONGEST_PART
        assert 4 <= recording.duration - mark[0] <= 5
        assert len(recording.scans("/scan")) == pytest.approx(recording.duration + 1, abs=1)
    assert words(path) == ["Stop"]
    assert there(tmp_path / "box") == [path.name], "nothing else stays"
    assert not threads_named("robowidgets-recorder")


def test_a_bump_an_error_a_lost_connection_the_program_and_a_call_are_causes(
    tmp_path: Path, clock: ManualClock, caplog: pytest.LogCaptureFixture
) -> None:
    script = Scripted(SCAN, BUMPER, DIAGNOSTICS, CMD_VEL)
    caplog.set_level(logging.CRITICAL, "robowidgets")
    with Feed(script, clock=clock) as feed:
        box = feed.black_box("/scan", folder=tmp_path)
        say = script.listener.on_message
        status = {"name": "battery", "message": "too hot", "hardware_id": "", "values": []}
        say("/diagnostics", {"header": {}, "status": [{**status, "level": 0}]})
        say("/bumper", {"bumper": 1, "state": 1})
        clock.advance(0.5)
        say("/bumper", {"bumper": 1, "state": 0})
        say("/diagnostics", {"header": {}, "status": [{**status, "level": 2}]})
        clock.advance(0.5)
        script.lose()
        script.connect()
        script.listener.on_topics([SCAN, BUMPER, DIAGNOSTICS, CMD_VEL])
        say("/scan", scan())

        def breaks(scan: Any) -> Drive:
            raise RuntimeError("no plan")

        program = feed.program(breaks, on="/scan")
        wait_for(lambda: say("/scan", scan()) or program.mode == "failed", "the program has failed")
        clock.advance(0.5)
        box.save("smells of  smoke")
        clock.advance(5.0)
        (path,) = box.files
    first, *others = words(path)
    assert first.startswith("bump: ")
    assert first.endswith("touched (/bumper)")
    assert others[:2] == ["battery: too hot", "connection lost, trying again in 1 s: no route to host"]
    assert "no plan" in others[2]
    assert others[3:] == ["smells of smoke"]
    assert path.name.split("_", 2)[2].startswith("bump_")


def test_a_condition_that_becomes_true_is_a_cause_and_one_that_raises_is_reported(tmp_path: Path) -> None:
    script = Scripted(SCAN)

    def broken(scan: Any) -> bool:
        return bool(scan.nothing)

    with Feed(script) as feed:
        box = feed.black_box(when=[conditions.nearest_below(0.5), broken], after=0, folder=tmp_path)
        for distance in (1.0, 0.25, 0.3, 1.0):
            script.listener.on_message("/scan", scan(distance))
            wait_for(lambda d=distance: box._triggers[0].value is (d < 0.5), "it is judged")
        wait_for(lambda: len(box.files) == 1, "the file is there")
        wait_for(lambda: any("broken: switched off" in line for line in box.problems), "the error is reported")
        (path,) = box.files
    assert words(path) == ["nearest below 0.5 m: 0.25 < 0.50 m"]


def test_a_condition_that_is_never_judged_is_reported(tmp_path: Path, clock: ManualClock) -> None:
    script = Scripted(SCAN, ODOM)
    with Feed(script, clock=clock) as feed:
        view = feed.show("/odom")
        box = feed.black_box("/odom", when=conditions.nearest_below(0.5), folder=tmp_path)
        line = "nearest below 0.5 m: waiting for /scan"
        wait_for(lambda: any(one.startswith(line) for one in box.problems), "it is a problem")
        script.listener.on_message("/odom", {})
        clock.advance(2.0)
        wait_for(lambda: any(line in one for one in view.notes), "the screen shows it")
        box.close()
        assert not any(line in one for one in box.problems)


def test_a_trigger_that_flaps_shares_files_and_each_time_is_a_mark(tmp_path: Path, clock: ManualClock) -> None:
    script = Scripted(SCAN)
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(seconds=20, after=2, folder=tmp_path)
        for number in range(40):
            box.save(f"flap {number}")
            pass_seconds(script, clock, 1)
        pass_seconds(script, clock, 30)
        assert len(box.files) == 2, "each begins with a cause and ends 20 s later"
    found = dict.fromkeys(text for path in box.files for text in words(path))
    assert len(found) == 40
    with robowidgets.open(box.files[1]) as recording:
        (first,) = [event for event in recording.events(ring.CAUSES) if event.text == "flap 20"]
        assert first.seconds >= 19, "the time before its first cause stays, for as long as others follow"
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(seconds=2, after=0, folder=tmp_path / "often")
        for number in range(59):
            box.save(f"flap {number}")
            pass_seconds(script, clock, 1)
        assert len(box.files) == 60 // ring_writer.BETWEEN, "four files a minute"


def test_the_moment_of_a_cause_is_in_its_file_if_the_last_minute_has_too_many_bytes(
    tmp_path: Path, clock: ManualClock
) -> None:
    script = Scripted(SCAN)
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(after=60, megabytes=1, folder=tmp_path)
        for second in range(90):
            if second == 40:
                box.save("early")
            script.listener.on_message("/scan", scan(*os.urandom(4000)))
            clock.advance(1.0)
        (path,) = box.files
    with robowidgets.open(path) as recording:
        (mark,) = recording.events(ring.CAUSES)
        assert mark.seconds >= 2, "what was before it"
        assert recording.duration - mark.seconds >= 2, "and after it"
        times = [one.seconds for one in recording.scans("/scan")]
        assert min(abs(time - mark.seconds) for time in times) <= 1


def test_a_text_that_no_file_can_have_is_written_with_question_marks(tmp_path: Path, clock: ManualClock) -> None:
    script = Scripted(SCAN)
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(after=0, folder=tmp_path)
        pass_seconds(script, clock, 1)
        box.save("half \ud83d of a smile")
        clock.advance()
        (path,) = box.files
    assert words(path) == ["half ? of a smile"]


def test_a_file_that_fails_for_any_reason_is_tried_again_and_closing_always_ends(
    tmp_path: Path, clock: ManualClock, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def fail(*_: Any) -> None:
        raise ValueError("cannot be written")

    script = Scripted(SCAN)
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(after=0, folder=tmp_path)
        pass_seconds(script, clock, 1)
        with monkeypatch.context() as broken:
            broken.setattr(ring_writer, "join", fail)
            box.save("noise")
            clock.advance()
            assert box.problems[0].startswith("the file for “noise” waits: cannot be written")
        clock.advance(ring_writer.RETRY)
        assert [words(path) for path in box.files] == [["noise"]]
        assert box.problems == ()
        monkeypatch.setattr(ring_writer.RingWriter, "_trim", fail)
        box.close()
        assert not threads_named("robowidgets-recorder")
        assert "error while closing" in caplog.text


def test_a_file_is_written_while_messages_come_faster_than_they_are_written(
    tmp_path: Path, clock: ManualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    script, count = Scripted(SCAN), 0
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(after=0, folder=tmp_path)

        def send_two(*_: Any) -> list[Any]:
            nonlocal count
            for _ in range(2 if count < 4000 and not box.files else 0):
                count += 1
                script.listener.on_message("/scan", scan())
            return []

        feel(monkeypatch, box, send_two)
        box.save("noise")
        script.listener.on_message("/scan", scan())
        clock.advance()
        assert len(box.files) == 1
        assert count < 100


def test_an_error_that_comes_again_and_again_begins_one_file_and_each_time_is_a_mark(
    tmp_path: Path, clock: ManualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    script = Scripted(SCAN, DIAGNOSTICS)
    monkeypatch.setattr(ring_writer, "MOST_CAUSES", 30)
    flushed: list[float] = []
    with Feed(script, clock=clock) as feed:
        box = feed.black_box("/scan", after=10, folder=tmp_path)
        writer = box._writer
        flush = writer._flush_if_due

        def note_flush() -> None:
            due = writer._flush_at
            is_due = due is not None and clock.now() >= due
            flush()
            flushed.extend([clock.now()] * is_due)

        monkeypatch.setattr(writer, "_flush_if_due", note_flush)
        box.save("important")
        status = {"name": "battery", "message": "hot", "hardware_id": "", "values": []}
        for _ in range(300):
            for level in (0, 2) * 3:
                script.listener.on_message("/diagnostics", {"header": {}, "status": [{**status, "level": level}]})
            script.listener.on_message("/scan", scan())
            clock.advance(0.25)
        assert [path.name.split("_")[2] for path in box.files] == ["important"]
        assert words(box.files[0])[0] == "important", "later causes do not push it out"
        assert words(box.files[0]).count("battery: hot") >= 10
        assert len(flushed) <= 2 * 75 + 2, "each second, and for causes once a second"
        clock.advance(ring_writer.REPEATED)
        for level in (0, 2):
            script.listener.on_message("/diagnostics", {"header": {}, "status": [{**status, "level": level}]})
        clock.advance(10.0)
        assert len(box.files) == 2


def test_a_large_message_that_holds_does_not_shorten_what_is_kept(tmp_path: Path, clock: ManualClock) -> None:
    description = Advert("/robot_description", "std_msgs/msg/String", wanted=False)
    script = Scripted(SCAN, description)
    kept = []
    for size in (10, 30_000, 60_000):
        with Feed(script, clock=clock) as feed:
            box = feed.black_box("/scan", "/robot_description", megabytes=1, folder=tmp_path)
            script.listener.on_message("/robot_description", {"data": os.urandom(size // 2).hex()})
            for _ in range(60):
                script.listener.on_message("/scan", scan(*os.urandom(4000)))
                clock.advance(1.0)
            kept.append(box._writer.kept)
            box.save(f"s{size}")
            box.close()
            (path,) = [path for path in box.files if f"_s{size}_" in path.name]
            with robowidgets.open(path) as recording:
                counts = {topic.name: topic.count for topic in recording.topics}
        assert counts.get("/robot_description", 0) == (size < 1e6 / ring_writer.RING_SHARE / ring_writer.PARTS)
    assert kept[1] == pytest.approx(kept[0], rel=0.2)
    assert kept[2] == pytest.approx(kept[0], rel=0.2)


def test_a_folder_that_is_deleted_is_made_again(tmp_path: Path, clock: ManualClock) -> None:
    script = Scripted(SCAN)
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(after=0, folder=tmp_path / "box")
        pass_seconds(script, clock, 3)
        shutil.rmtree(tmp_path / "box")
        pass_seconds(script, clock, 3)
        box.save("after that")
        pass_seconds(script, clock, 1)
        (path,) = box.files
        assert box.problems == ()
    assert words(path) == ["after that"]
    assert there(tmp_path / "box") == [path.name]


def test_messages_that_wait_have_a_limit_in_bytes_over_all_topics(tmp_path: Path, clock: ManualClock) -> None:
    finder = ring_writer.Finder(lambda *_: (), lambda: None, lambda: None)
    writer = ring_writer.RingWriter(tmp_path, ring_writer.RingLimits(60, 5, 20, 10**9), finder, clock)
    pixels = np.zeros(1_000_000, np.uint8)  # one for all
    for number in range(100):
        writer.add(f"/image{number % 2}", "sensor_msgs/msg/Image", number, {"header": {}, "data": pixels})
    writer.add("/scan", "sensor_msgs/msg/LaserScan", 100, scan())
    dropped = sorted(line.partition(" message")[0] for line in writer.problems)
    writer.close()
    assert dropped == ["/image0: 17", "/image1: 18"]
    assert there(tmp_path) == []


def test_what_still_holds_is_in_each_file_once(tmp_path: Path, clock: ManualClock) -> None:
    script = Scripted(SCAN, TF_STATIC)
    pose = {"translation": {"x": 0.0, "y": 0.0, "z": 0.0}, "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(seconds=10, folder=tmp_path)
        for frame in ("laser", "camera"):
            header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base"}
            transforms = [{"header": header, "child_frame_id": frame, "transform": pose}]
            script.listener.on_message("/tf_static", {"transforms": transforms})
        feed.program(lambda: Drive(), rate=1).pause()
        pass_seconds(script, clock, 60)
        box.save()
        pass_seconds(script, clock, 6)
        (path,) = box.files
    with robowidgets.open(path) as recording:
        counts = {topic.name: topic.count for topic in recording.topics}
    assert counts["/tf_static"] == 2
    assert counts["/robowidgets/program"] == 1
    assert counts["/scan"] <= 20


def test_a_full_disk_is_reported_once_deletes_nothing_and_ends_when_there_is_room(
    tmp_path: Path, clock: ManualClock, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    script = Scripted(SCAN)
    caplog.set_level(logging.WARNING, "robowidgets")
    with Feed(script, clock=clock) as feed:
        view = feed.show()
        box = feed.black_box(seconds=10, after=1, folder=tmp_path)
        pass_seconds(script, clock, 5)
        box.save("before")
        pass_seconds(script, clock, 20)
        (old,) = box.files
        with monkeypatch.context() as full:
            full.setattr(ring_writer, "McapWriter", fill_disk)
            pass_seconds(script, clock, 15)
            box.save("meanwhile")
            pass_seconds(script, clock, 30)
            line = "black box: nothing is kept: No space left on device in " + str(tmp_path)
            assert feed.connection.black_box == "black box: in trouble"
            wait_for(lambda: view.notes and view.notes[-1].startswith(line), "the screen shows it")
            assert line in repr(feed)
            assert [record.levelname for record in caplog.records] == ["ERROR"]
            assert box.files == (old,)
            assert not list(tmp_path.glob("*.part"))
        pass_seconds(script, clock, 12)
        assert [record.levelname for record in caplog.records] == ["ERROR", "WARNING"]
        assert feed.connection.black_box == "black box: last 10 s, 2 files"
        wait_for(lambda: not view.notes, "the screen shows it")
    assert words(box.files[1]) == ["meanwhile"]


def test_a_full_disk_is_tried_again_without_a_message(
    tmp_path: Path, clock: ManualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    script = Scripted(SCAN)
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(after=0, folder=tmp_path)
        with monkeypatch.context() as full:
            full.setattr(ring_writer, "McapWriter", fill_disk)
            pass_seconds(script, clock, 2)
            clock.advance(30.0)
            assert feed.connection.black_box == "black box: in trouble"
        clock.advance(2 * ring_writer.RETRY)
        assert feed.connection.black_box == "black box: last 60 s, 0 files"
        assert box.problems == ()


def test_a_file_that_finds_no_room_waits_and_has_no_partial_copy(
    tmp_path: Path, clock: ManualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    script = Scripted(SCAN)
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(seconds=10, after=1, folder=tmp_path)
        pass_seconds(script, clock, 5)
        box.save("noise")
        with monkeypatch.context() as full:
            full.setattr(ring, "McapWriter", fill_disk)
            pass_seconds(script, clock, 4)
            line = f"black box: the file for “noise” waits: No space left on device in {tmp_path}; it tries again"
            assert feed.connection.black_box_troubles[0].startswith(line)
            assert [path.name for path in tmp_path.iterdir() if not path.name.startswith(".")] == []
        pass_seconds(script, clock, 6)
        assert feed.connection.black_box == "black box: last 10 s, 1 file"
    assert words(box.files[0]) == ["noise"]


def test_two_kernels_share_a_folder_and_neither_takes_what_the_other_keeps(tmp_path: Path, clock: ManualClock) -> None:
    scripts = Scripted(SCAN), Scripted(SCAN)
    with Feed(scripts[0], clock=clock) as one, Feed(scripts[1], clock=clock) as other:
        boxes = [feed.black_box(seconds=10, after=1, folder=tmp_path) for feed in (one, other)]
        for script in scripts:
            pass_seconds(script, clock, 3)
        boxes[0].save("same")
        boxes[1].save("same")
        for script in scripts:
            pass_seconds(script, clock, 3)
        files = ring.saved_files(tmp_path)
        assert len(files) == 2
        assert ring.recover(tmp_path) == ([], [])
    assert [words(path) for path in files] == [["same"], ["same"]]


def leave(folder: Path, clock: ManualClock, monkeypatch: pytest.MonkeyPatch, **options: Any) -> str:
    """Leave the last minute of a kernel that ended; return its name."""
    before = set(there(folder))
    script = Scripted(SCAN)
    with monkeypatch.context() as died, Feed(script, clock=clock) as feed:
        died.setattr(ring.Ring, "remove", ring.Ring.release)
        feed.black_box(folder=folder, **options)
        pass_seconds(script, clock, 3)
    (left,) = set(there(folder)) - before
    return left


def test_a_command_writes_what_a_kernel_has_left(
    tmp_path: Path, clock: ManualClock, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    leave(tmp_path, clock, monkeypatch)
    assert main(["repair", str(tmp_path), "-o", "x.mcap"]) == 2
    assert "the files of a black box have names of their own" in capsys.readouterr().err
    assert main(["repair", str(tmp_path)]) == 0
    (name,) = there(tmp_path)
    assert capsys.readouterr().out == f"Wrote {tmp_path / name}\n"
    with Feed(Scripted(SCAN), clock=clock) as feed:
        feed.black_box(folder=tmp_path)
        assert main(["repair", str(tmp_path)]) == 0
        assert capsys.readouterr().out.startswith("Nothing is left to write in ")
    assert main(["repair", str(tmp_path)]) == 0
    assert capsys.readouterr().out.startswith("Nothing is left to write in ")
    assert there(tmp_path) == [name]


def test_what_cannot_be_read_is_reported_and_stays(
    tmp_path: Path, clock: ManualClock, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    left = tmp_path / leave(tmp_path, clock, monkeypatch, seconds=6)
    damaged = sorted(left.glob("*.mcap"))[1]
    damaged.write_bytes(b"\0" * 100)
    (path,), (problem,) = ring.recover(tmp_path)
    assert problem.startswith(f"{left.name}, the last minute of an earlier kernel, stays: {damaged.name}: expected an ")
    assert there(left) == [damaged.name, "lock"]
    assert words(path) == [ring.DIED]
    assert ring.recover(tmp_path) == ([], [problem]), "it is not written again"

    script = Scripted(SCAN)
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(seconds=6, after=0, folder=tmp_path / "runs")
        pass_seconds(script, clock, 4)
        (runs,) = (tmp_path / "runs").iterdir()
        damaged = sorted(runs.glob("*.mcap"))[1]
        damaged.write_bytes(b"\0" * 100)
        box.save("noise")
        clock.advance()
        (path,) = box.files
        assert box.problems[0].startswith(f"{path.name} lacks a part: {damaged.name}: expected an MCAP file")
        assert "lacks a part" in caplog.text
    assert damaged.exists()


def test_a_file_of_another_program_stays_and_does_not_stop_the_rest(
    tmp_path: Path, clock: ManualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / ".ring_0000" / "lock").mkdir(parents=True)
    left = tmp_path / leave(tmp_path, clock, monkeypatch)
    (left / "1_notes.mcap").touch()
    (path,), problems = ring.recover(tmp_path)
    assert words(path) == [ring.DIED]
    assert "it is not known if that kernel runs (lock: Is a directory)" in problems[0]
    assert problems[1].endswith("stays: it has files of other programs: 1_notes.mcap")
    done = left.name.replace("ring", "done")
    assert there(tmp_path) == sorted([".ring_0000", done, path.name])
    written, again = ring.recover(tmp_path)
    assert written == []
    assert sorted(again)[0].startswith(done)
    (tmp_path / done / "1_notes.mcap").unlink()
    ring.recover(tmp_path)
    assert there(tmp_path) == [".ring_0000", path.name]


def test_without_locks_of_the_system_what_could_not_be_written_is_tried_again(
    tmp_path: Path, clock: ManualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ring, "fcntl", None)  # as on Windows
    left = tmp_path / leave(tmp_path, clock, monkeypatch)
    with monkeypatch.context() as full:
        full.setattr(ring, "McapWriter", fill_disk)
        written, (problem,) = ring.recover(tmp_path)
        assert written == []
        assert "No space left on device" in problem
    (left / "lock").rename(tmp_path / "lock")
    written, (problem,) = ring.recover(tmp_path)
    assert written == []
    assert "it is not known if that kernel runs (lock: No such file or directory)" in problem
    (tmp_path / "lock").rename(left / "lock")
    (path,), problems = ring.recover(tmp_path)
    assert problems == []
    assert there(tmp_path) == [path.name]


def test_what_a_kernel_has_left_stays_until_it_can_be_written(
    tmp_path: Path, clock: ManualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    left = leave(tmp_path, clock, monkeypatch)
    script = Scripted(SCAN)
    with monkeypatch.context() as full, Feed(script, clock=clock) as feed:
        full.setattr(ring, "McapWriter", fill_disk)
        box = feed.black_box(folder=tmp_path)
        clock.advance()
        assert box.problems == (f"{left}, the last minute of an earlier kernel, stays: No space left on device",)
    assert there(tmp_path) == [left]
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(folder=tmp_path)
        clock.advance()
        (path,) = box.files
    assert words(path) == ["the kernel ended without closing"]


def test_the_oldest_files_are_deleted_by_number_and_by_size_and_no_others(tmp_path: Path, clock: ManualClock) -> None:
    script = Scripted(SCAN)
    (tmp_path / "run.mcap").touch()
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(seconds=5, after=0, files=2, folder=tmp_path)
        for name in ("a", "b", "c"):
            box.save(name)
            pass_seconds(script, clock, 20)
        assert [path.name.split("_")[2] for path in box.files] == ["b", "c"]
        box = feed.black_box(seconds=60, after=0, megabytes=1, folder=tmp_path)
        for _ in range(60):
            script.listener.on_message("/scan", scan(*os.urandom(4000)))
            clock.advance(1.0)
        assert "of 60 s, which need more megabytes" in feed.connection.black_box
        size = sum(path.stat().st_size for path in tmp_path.rglob("*.mcap"))
        assert size < 1e6
        box.save("large")
        pass_seconds(script, clock, 2)
        assert box.files[-1].name.split("_")[2] == "large"
    assert (tmp_path / "run.mcap").exists()


def test_names_of_the_user_that_are_similar_are_left_alone(tmp_path: Path, clock: ManualClock) -> None:
    for name in ("drive_2", "drive_ab12", "drive-ab12"):
        (tmp_path / f"2026-11-29_13-02-24_{name}.mcap").touch()
    (tmp_path / "2026-11-29_13-02-24_link_blackbox-1-ab12.mcap").symlink_to(tmp_path)
    (tmp_path / "2026-11-29_13-02-24_folder_blackbox-2-ab12.mcap").mkdir()
    for name in (".ring_data", ".ring_ab12"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "lock").touch()
        (tmp_path / name / "drive.mcap").touch()
    before = {*tmp_path.rglob("*")}
    script = Scripted(SCAN)
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(after=0, files=1, folder=tmp_path)
        pass_seconds(script, clock, 1)
        assert box.problems == (
            ".ring_ab12, the last minute of an earlier kernel, stays: it has files of other programs: drive.mcap",
        )
        for _ in range(2):
            box.save()
            pass_seconds(script, clock, 20)
        (path,) = box.files
    assert {*tmp_path.rglob("*")} == {*before, path}


def test_the_newest_files_stay_after_the_clock_of_the_computer_went_back(tmp_path: Path, clock: ManualClock) -> None:
    (tmp_path / "2099-01-01_00-00-00_old_blackbox-9-ab12.mcap").touch()
    script = Scripted(SCAN)
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(after=0, files=2, folder=tmp_path)
        pass_seconds(script, clock, 1)
        for name in ("a", "b"):
            box.save(name)
            pass_seconds(script, clock, 20)
        assert [words(path) for path in box.files] == [["a"], ["a", "b"]]


def test_it_keeps_what_the_screen_shows_and_the_screen_shows_that_it_runs(tmp_path: Path, clock: ManualClock) -> None:
    script = Scripted(SCAN, ODOM, IMU, CMD_VEL)
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(folder=tmp_path)
        assert script.followed >= {"/scan", "/odom"}
        view = feed.show("/scan")
        assert synced(view.children[0], "_black_box") == "black box: last 60 s, 0 files"
        pass_seconds(script, clock, 2)
        assert script.followed == {"/scan", "/cmd_vel"}
        view.close()
        with pytest.raises(TypeError, match="condition: expected a function of one moment"):
            feed.black_box("/imu", when={"x": 3}, folder=tmp_path)
        assert not box.closed
        assert feed.connection.black_box == "black box: last 60 s, 0 files"
        assert len(there(tmp_path)) == 1, "the wrong one has left nothing"
        box.save("before")
        feed.black_box("/imu", folder=tmp_path)
        assert box.closed
        assert script.followed == {"/imu", "/cmd_vel"}, "speeds are always kept"
        assert feed.connection.black_box == "black box: last 60 s, 1 file"
        box.close()
        assert feed.connection.black_box == "black box: last 60 s, 1 file"
    assert feed.connection.black_box == ""


def test_closing_writes_the_file_that_is_due(tmp_path: Path, clock: ManualClock) -> None:
    script = Scripted(SCAN)
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(folder=tmp_path)
        pass_seconds(script, clock, 2)
        box.save("late")
        feed.close()
        assert there(tmp_path) == [box.files[0].name]
        with pytest.raises(FeedError, match="the black box is closed"):
            box.save()
    assert words(box.files[0]) == ["late"]


def test_closing_in_the_thread_that_writes_waits_for_nothing(
    tmp_path: Path, clock: ManualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    script = Scripted(SCAN)
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(folder=tmp_path)
        feel(monkeypatch, box, lambda *_: box.close() or [ring_writer.FoundCause("the last")])
        script.listener.on_message("/scan", scan())
        clock.advance()  # by no time
        (path,) = box.files
        assert there(tmp_path) == [path.name]


def test_a_forked_process_has_no_black_box(tmp_path: Path, clock: ManualClock) -> None:
    script = Scripted(SCAN)
    with Feed(script, clock=clock) as feed:
        box = feed.black_box(folder=tmp_path)
        feed.connection.is_forked = True
        with pytest.raises(FeedError, match="belongs to the parent of this forked process"):
            box.save()
        box.close()
        feed.connection.is_forked = False
        clock.advance()
        assert threads_named("robowidgets-recorder") == 1, "it did not wait for a thread"


def test_closing_again_completes_what_an_interrupt_cut_short(
    tmp_path: Path, clock: ManualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*_: Any) -> None:
        raise KeyboardInterrupt

    script = Scripted(SCAN)
    with Feed(script, clock=clock) as feed:
        box = feed.black_box("/scan", folder=tmp_path)
        with monkeypatch.context() as interrupted:
            interrupted.setattr(feed.connection, "detach", interrupt)
            with pytest.raises(KeyboardInterrupt):
                box.close()
        box.close()
        assert script.followed == set()
        assert there(tmp_path) == []
        assert feed.connection.black_box == ""


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        ({"seconds": 0}, "seconds: expected 1 to 3600 seconds, got 0"),
        ({"after": -1}, "after: expected 0 to 600 seconds, got -1"),
        ({"files": 0}, "files: expected 1 or more, got 0"),
        ({"files": 1.5}, "files: expected a whole number, got 1.5"),
        ({"megabytes": 0}, "megabytes: expected 1 or more, got 0"),
        ({"folder": ""}, "folder: expected the path of a folder, got an empty text"),
        ({"folder": 3}, "folder: expected the path of a folder, got 3"),
        ({"when": lambda scan: scan}, "when: a lambda has no name"),
        ({"when": {"x": 3}}, "condition: expected a function of one moment"),
        ({"when": [conditions.touched(), conditions.touched()]}, "two conditions have one name"),
    ],
)
def test_a_wrong_argument_is_named(tmp_path: Path, clock: ManualClock, arguments: dict[str, Any], error: str) -> None:
    with Feed(Scripted(SCAN), clock=clock) as feed:
        with pytest.raises((TypeError, ValueError), match=error):
            feed.black_box(**{"folder": tmp_path, **arguments})
        assert feed.connection.black_box == ""
    assert there(tmp_path) == []


@pytest.fixture
def killed(tmp_path: Path) -> Iterator[Path]:
    process = subprocess.Popen(
        [sys.executable, "-c", KILLED, tmp_path],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        assert ring.recover(tmp_path) == ([], []), "its kernel lives"
    finally:
        process.send_signal(signal.SIGKILL)
        process.communicate()
    return tmp_path


@pytest.mark.slow
def test_what_a_killed_kernel_had_is_in_a_file_after_the_next_start(
    killed: Path, clock: ManualClock, caplog: pytest.LogCaptureFixture
) -> None:
    assert all(name.startswith(".ring_") for name in there(killed))
    with Feed(Scripted(SCAN), clock=clock) as feed:
        box = feed.black_box(folder=killed)
        clock.advance()
        (path,) = box.files
        assert "written from what a kernel left that ended without closing" in caplog.text
    assert there(killed) == [path.name]
    assert words(path) == ["a strange noise", "the kernel ended without closing"]
    with robowidgets.open(path) as recording:
        assert len(recording.scans("/scan")) >= 19
        assert [one.name for one in recording.programs] == ["ahead"]
