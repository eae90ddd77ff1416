"""A page in a file, from a recording: its content, its size, and the refusals."""

from __future__ import annotations

import errno
import json
import os
import re
import sys
import zlib
from base64 import b85decode
from contextlib import closing
from pathlib import Path
from shutil import copy
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets.export import html
from robowidgets.export.segments import _pack_column, segment
from robowidgets.files import open_source
from robowidgets.recordings import UnknownTopicError
from robowidgets.repair import RecordingError, Source
from robowidgets.repair.write import write
from robowidgets.runtime import output_file
from robowidgets.screens import _to_html
from robowidgets.widget.timed_frame import FRAME_HEADER, TimedFrame

from ..pages import display, display_html
from ..recordings import robot, sweeps


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return robot.write(tmp_path_factory.mktemp("recordings") / "drive")


def parts(page: str, kind: str) -> list[bytes]:
    found = re.findall(rf'<script type="text/plain" data-part="{kind}">([^<]*)</script>', page)
    return [zlib.decompress(b85decode(part.replace(",", "<"))) for part in found]


def test_a_page_of_a_stretch_has_its_texts_and_segments_and_nothing_of_markup(path: Path, tmp_path: Path) -> None:
    hostile = "</script><img src=x onerror=alert(1)><!-- "
    with robowidgets.open(path) as recording:
        written = recording.to_html(
            tmp_path / "bump.html", start=0.5, end=1.5, title=hostile, note=hostile, marks=[(0.6, 0.7, hostile)]
        )
        size = recording.html_size(start=0.5, end=1.5)
    text = written.read_text(encoding="utf-8")
    assert "<img" not in text
    assert "<!--" not in text
    assert text.count("&lt;/script&gt;&lt;img") == 3
    assert "0.50 to 1.50 s of" in text
    # A program, the page and a segment, and the script that loads them.
    assert len(re.findall("<script", text)) == 4
    assert size == pytest.approx(len(text), abs=2000)
    (page,) = parts(text, "page")
    assert hostile.encode() in page


def test_the_axes_that_no_speed_uses_are_left_out_if_there_is_a_scanogram(path: Path, tmp_path: Path) -> None:
    def planar(**more: bool) -> list[bytes]:
        with robowidgets.open(path) as recording:
            text = recording.to_html(tmp_path / "a.html", **more).read_text(encoding="utf-8")
        (page,) = parts(text, "page")
        return re.findall(rb'"planar":\s*(\w+)', page)

    assert planar() == [b"true"]
    assert planar(scanogram=False) == [b"false"]


def test_its_policy_allows_no_request_and_only_the_scripts_in_it(path: Path, tmp_path: Path) -> None:
    with robowidgets.open(path) as recording:
        text = recording.to_html(tmp_path / "a.html").read_text(encoding="utf-8")
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', text)
    assert policy
    rules = dict(rule.split(" ", 1) for rule in policy[1].split("; "))
    assert rules["default-src"] == rules["connect-src"] == rules["base-uri"] == rules["form-action"] == "'none'"
    assert re.fullmatch(r"('sha256-[\w+/]+=*' ?)+", rules["script-src"])
    assert re.fullmatch(r"('sha256-[\w+/]+=*' ?)+", rules["style-src"])
    assert rules["img-src"] == "data: blob:"
    assert not re.search(r'(?:src|href)="(?!data:)', text)


class Part:
    """The messages of some topics of a source."""

    def __init__(self, source: Source, topics: list[str]) -> None:
        self.channels = tuple(channel for channel in source.channels if channel.topic in topics)
        self.problems = ()
        self.start_ns, self.end_ns = source.start_ns, source.end_ns
        self.messages, self.span_ns, self.close = source.messages, source.span_ns, source.close


@pytest.mark.slow
def test_real_recordings_take_what_was_promised(tmp_path: Path, data: Path) -> None:
    """At most 0.6 times the size of its topics as MCAP with zstd and 195 kB, except for noisy readings."""
    for name in ("hokuyo_people.bag", "tilt_laser.bag", "urg_681.bag", "neato_fsm_zstd.mcap", "edmonton.log.gz"):
        file = data / "good" / name
        with robowidgets.open(file) as recording:
            topics = [topic.name for topic in recording.topics if topic.widget]
            size = recording.to_html(tmp_path / "a.html").stat().st_size
        with closing(open_source(file)) as source:
            mcap = write(Part(source, topics), tmp_path / "a.mcap").size
        assert size <= 0.6 * mcap + 195_000, name


def test_a_page_that_shows_widgets_does_not_say_that_there_is_none(tmp_path: Path, data: Path) -> None:
    with robowidgets.open(data / "odd" / "jazzy_mcap_no_laser") as recording:
        page = recording.to_html(tmp_path / "a.html", start=39, end=40).read_text(encoding="utf-8")
    assert "rw-page-problems" not in page[page.index("<body") :]


def test_numbers_keep_the_sign_of_zero() -> None:
    assert _pack_column(np.array([0.0, 0.5]))[0] == 10**6
    assert _pack_column(np.array([-0.0, 0.5]))[0] == 0, "the bits are packed unchanged"


def test_a_scanner_whose_number_of_rays_changes_takes_no_more(tmp_path: Path) -> None:
    noise = np.random.default_rng(0)
    scans = []
    for i in range(100):
        rays = int(noise.integers(926, 938))
        angles = np.linspace(0, 2 * np.pi, rays, endpoint=False)
        walls = 2 / np.maximum(np.abs(np.cos(angles + i / 50)), np.abs(np.sin(angles + i / 50)))
        ranges = np.round((walls + noise.normal(0, 0.004, rays)) / 0.00025) * 0.00025
        scans.append((i / 10, sweeps.scan(sweeps.START_NS, ranges, increment=2 * np.pi / rays)))
    path = sweeps.write(tmp_path / "scans", scans)
    with closing(open_source(path)) as source:
        mcap = write(source, tmp_path / "a.mcap").size
    with robowidgets.open(path) as recording:
        size = recording.to_html(tmp_path / "a.html", scanogram=True).stat().st_size
    assert size <= 0.6 * mcap + 176_000


def test_every_second_scan_makes_it_smaller_and_is_noted(tmp_path: Path) -> None:
    scans = [(i / 10, sweeps.scan(sweeps.START_NS, np.random.default_rng(i).random(500))) for i in range(40)]
    with robowidgets.open(sweeps.write(tmp_path / "scans", scans)) as recording:
        assert recording.html_size(every=2) < recording.html_size() - 20_000
        text = recording.to_html(tmp_path / "a.html", every=2).read_text(encoding="utf-8")
    assert "one of every 2 scans" in text


def test_a_large_page_is_written_only_when_asked_and_the_text_says_what_makes_it_smaller(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scans = [(i / 2, sweeps.scan(sweeps.START_NS, np.random.default_rng(i).random(500))) for i in range(40)]
    with robowidgets.open(sweeps.write(tmp_path / "scans", scans)) as recording:
        for sampled in (1, 40):
            monkeypatch.setattr(html, "_SAMPLED", sampled)
            with pytest.raises(
                ValueError, match=r"a.html would take .* at most 100 kB are allowed: select a span"
            ) as e:
                recording.to_html(tmp_path / "a.html", max_size=100_000)
            assert "every=2" in str(e.value)
            assert "max_size=1_000_000" in str(e.value)
            assert list(tmp_path.glob("a.html*")) == []
        assert recording.to_html(tmp_path / "a.html", max_size=None).stat().st_size > 100_000


@pytest.mark.parametrize(
    ("wanted", "error", "text"),
    [
        ({"start": 99}, ValueError, r"start: expected seconds from 0 to \d+\.\d\d, got 99"),
        ({"end": 99}, ValueError, r"end: expected seconds from 0 to \d+\.\d\d, got 99"),
        ({"start": 1, "end": 1}, ValueError, "expected a start before the end, got start=1 and end=1"),
        ({"start": "1"}, TypeError, "start: expected seconds from the start of the recording, got '1'"),
        ({"every": 0}, ValueError, "every: expected 1 for all scans"),
        ({"topics": ["/sacn"]}, UnknownTopicError, "no topic '/sacn'"),
        ({"title": 5}, TypeError, r"to_html\(\): expected title as a text, got 5"),
        ({"note": ["x"]}, TypeError, r"to_html\(\): expected note as a text, got \['x'\]"),
        (
            {"max_size": "a"},
            TypeError,
            r"to_html\(\): expected max_size in bytes, such as 50_000_000, or None, got 'a'",
        ),
        ({"topics": "/scan"}, TypeError, r"topics: expected a list of names, got '/scan'"),
    ],
)
def test_what_makes_no_sense_is_refused_in_a_line(
    path: Path, tmp_path: Path, wanted: dict[str, Any], error: type[Exception], text: str
) -> None:
    with robowidgets.open(path) as recording, pytest.raises(error, match=text) as raised:
        recording.to_html(tmp_path / "a.html", **wanted)
    assert "\n" not in str(raised.value)
    assert list(tmp_path.iterdir()) == []


def test_a_closed_player_says_so(path: Path, tmp_path: Path) -> None:
    with robowidgets.open(path) as recording:
        player = recording.show(scanogram=False)
    player.close()
    with pytest.raises(RecordingError, match="this player is closed; show the recording again"):
        player.to_html(tmp_path / "a.html")


@pytest.mark.skipif(sys.platform != "linux", reason="names of files are texts there")
def test_a_recording_whose_name_is_not_utf_8_is_written_and_labelled(tmp_path: Path) -> None:
    odd = tmp_path / os.fsdecode(b"Fahrt_\xfcber.mcap")
    copy(robowidgets.SAMPLE, odd)
    with robowidgets.open(odd) as recording:
        page = recording.to_html(tmp_path / "a.html", start=1, end=2).read_text(encoding="utf-8")
        recording.label("door", 1, 2)
        assert [label[:3] for label in recording.labels] == [("door", 1.0, 2.0)]
    assert "<h1>Fahrt_?ber.mcap</h1>" in page


def test_a_file_that_cannot_be_written_is_refused_before_any_work(path: Path, tmp_path: Path) -> None:
    with robowidgets.open(path) as recording:
        with pytest.raises(ValueError, match=r"to_html\(\): expected a name that ends in .html or .htm, got"):
            recording.to_html(tmp_path / "a.txt")
        with pytest.raises(FileNotFoundError, match="there is no folder"):
            recording.to_html(tmp_path / "none" / "a.html")


def test_a_full_disk_leaves_nothing_and_keeps_what_was_there(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "a.html"
    target.write_text("before")

    def full(_number: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(output_file.os, "fsync", full)
    with robowidgets.open(path) as recording, pytest.raises(OSError, match=r"a\.html was not written: No space left"):
        recording.to_html(target)
    assert target.read_text() == "before"
    assert list(tmp_path.iterdir()) == [target]


def test_a_page_of_a_players_view_has_its_settings(path: Path, tmp_path: Path) -> None:
    with robowidgets.open(path) as recording:
        player = recording.show()
        try:
            laser = player.views[0].widget
            laser.pinned, player.selection, player.time = 3, (0.25, 1.25), 1.0
            player.marks = [(0.1, 0.2, "before"), (0.9, 1.1, "within")]
            (page,) = parts(player.to_html(tmp_path / "a.html", start=0.5).read_text(encoding="utf-8"), "page")
        finally:
            player.close()
    assert b'"pinned":3' in page
    assert b'"selection":[0.5,1.25]' in page
    assert b"within" in page
    assert b"before" not in page
    assert b'"time":1.0' in page
    assert b'"_begin":0.5' in page


def test_a_recording_without_a_message_makes_no_page(data: Path, tmp_path: Path) -> None:
    text = "empty_bag: no topic for a page: no widget shows any"
    with robowidgets.open(data / "odd" / "empty_bag") as recording, pytest.raises(RecordingError, match=text):
        recording.to_html(tmp_path / "a.html")
    assert list(tmp_path.iterdir()) == []


def test_the_path_and_the_picture_match_the_stretch(tmp_path: Path) -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        text = recording.to_html(tmp_path / "a.html", start=10, end=14).read_text(encoding="utf-8")
    facts, rest = split(parts(text, "page")[0])
    buffers = {}
    for model, trait, size in facts["buffers"]:
        buffers[model, trait], rest = rest[:size], rest[size:]
    path = next(value for (_, trait), value in buffers.items() if trait == "_path")
    times = np.frombuffer(path).reshape(-1, 5)[:, 0]
    assert len(times) > 5
    assert times[0] <= 10 < times[1] < times[-1] <= 14
    picture, _ = split(buffers[facts["scanogram"]["model"], "_frame"])
    assert (picture["begin"], picture["duration"]) == (10, 14)


@pytest.mark.slow
def test_touches_are_the_marks_of_a_page_unless_it_has_others(path: Path, tmp_path: Path) -> None:
    def marks(**more: Any) -> list[str]:
        with robowidgets.open(path) as recording:
            text = recording.to_html(tmp_path / "a.html", **more).read_text(encoding="utf-8")
        models = split(parts(text, "page")[0])[0]["models"]
        (found,) = [model["state"]["marks"] for model in models if model["widget"] == "player_widget"]
        return [label for _, _, label in found]

    assert marks() == ["left", "left"]
    assert marks(start=0, end=0.5) == []
    assert marks(marks=[(1, 2, "seen")]) == ["seen"]
    assert marks(marks=()) == []


def split(part: bytes) -> tuple[dict[str, Any], bytes]:
    """The facts of a part, and the bytes after them."""
    end = 4 + int.from_bytes(part[:4], "little")
    return json.loads(part[4:end]), part[end:]


def test_a_page_has_no_picture_of_scans_that_it_has(tmp_path: Path) -> None:
    scans = [(i / 10, sweeps.scan(sweeps.START_NS, [1.0] * (20 + i % 3), increment=3 / (20 + i % 3))) for i in range(9)]
    with robowidgets.open(sweeps.write(tmp_path / "scans", scans)) as recording:
        (page,) = parts(recording.to_html(tmp_path / "a.html").read_text(encoding="utf-8"), "page")
    assert b'"scanogram":{"model":' in page
    assert b'"cells"' not in page


def test_a_message_in_a_page_has_its_own_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    packed: list[TimedFrame] = []

    def spy(number: int, tracks: Any) -> bytes:
        packed.extend(timed for frames, _ in tracks for timed in frames)
        return segment(number, tracks)

    monkeypatch.setattr(_to_html, "segment", spy)
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        recording.to_html(tmp_path / "x.html", topics=["/odom as message"], start=20, end=30)
        times = recording.fields("/odom").seconds
    arrivals = [FRAME_HEADER.unpack_from(timed.frame)[3] for timed in packed]
    assert 200 <= len(set(arrivals)) <= len(times)
    assert set(arrivals) <= {*times}
    assert min(arrivals) == pytest.approx(20.0, abs=0.1)


def test_a_written_page_is_a_path_that_a_notebook_shows_as_a_link_with_its_size(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        page = recording.to_html("a b.html", start=10, end=11)
    assert isinstance(page, Path)
    assert page == tmp_path / "a b.html"
    assert page.read_bytes()
    shown = display_html(page)
    assert shown is not None
    assert 'href="a%20b.html"' in shown
    assert f"{page.stat().st_size / 1e3:.0f} kB" in shown
    assert "mail" not in shown
    with page.open("ab") as file:
        file.truncate(20_000_001)
    assert "most mail refuses more than 20.0 MB" in display_html(page)
    page.unlink()
    assert "text/html" not in display(page)
