"""A widget as a page in a file: with its history, and in its present state."""

from __future__ import annotations

import re
import zlib
from base64 import b85decode
from pathlib import Path

import pytest

from robowidgets import LaserWidget, Scan, TouchWidget
from robowidgets.widget import sent_frames
from robowidgets.widget.pacer import pacer
from robowidgets.widget.sent_frames import SentFrames
from robowidgets.widget.timed_frame import TimedFrame


def parts(path: Path, kind: str) -> list[bytes]:
    found = re.findall(rf'data-part="{kind}">([^<]*)<', path.read_text(encoding="utf-8"))
    return [zlib.decompress(b85decode(part.replace(",", "<"))) for part in found]


def test_a_page_of_a_widget_has_its_settings_and_its_history(tmp_path: Path) -> None:
    laser = LaserWidget(title="/scan", pinned=1)
    for i in range(3):
        laser.update(Scan([1.0 + i, 2.0, 3.0], 0, 0.1, 0, 9))
        pacer.flush()
    path = laser.to_html(tmp_path / "wall.html", note="<b>near</b>")
    assert "&lt;b&gt;near&lt;/b&gt;" in path.read_text(encoding="utf-8")
    assert "<h1>/scan</h1>" in path.read_text(encoding="utf-8")
    (page,) = parts(path, "page")
    assert b'"pinned":1' in page
    (segment,) = parts(path, "segment")
    # The frame at the start, and the three.
    assert b'"count":4' in segment
    laser.close()


def test_without_a_history_a_page_has_the_newest_sample(tmp_path: Path) -> None:
    touch = TouchWidget(history=0)
    touch.update({"left": True})
    pacer.flush()
    touch.update({"left": False})
    path = touch.to_html(tmp_path / "a.html")
    assert parts(path, "segment") == []
    (page,) = parts(path, "page")
    assert b'["left", "free", 1, ' in page
    assert LaserWidget(title="/scan").to_html(tmp_path / "empty.html").is_file()
    with pytest.raises(ValueError, match=r"to_html\(\): expected a name that ends in .html"):
        touch.to_html(tmp_path / "a.png")


def test_a_closed_widget_and_a_title_that_is_not_a_text_are_refused(tmp_path: Path) -> None:
    laser = LaserWidget()
    with pytest.raises(TypeError, match=r"to_html\(\): expected title as a text, got 5"):
        laser.to_html(tmp_path / "a.html", title=5)
    laser.close()
    with pytest.raises(RuntimeError, match=r"to_html\(\): this widget is closed; show a new one"):
        laser.to_html(tmp_path / "a.html")


def test_the_kept_history_matches_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    frames = SentFrames()
    for i in range(100):
        frames.add(TimedFrame(i / 10, {}, b"1234"), 2)
    assert next(at for at, _, _ in frames) == pytest.approx(7.9)
    for i in range(100):
        frames.add(TimedFrame(10 + i / 100, {}, b"1234"), 2)
    assert len(list(frames)) == 40
    monkeypatch.setattr(sent_frames, "MOST_BYTES", 10)
    frames.add(TimedFrame(11, {}, b"1234"), 2)
    assert len(list(frames)) == 2
    frames.add(TimedFrame(11, {}, b"1234"), 0)
    assert list(frames) == []
