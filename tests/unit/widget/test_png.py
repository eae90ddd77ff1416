"""`save_png`: its questions to a page, the use of the answers, and immediate refusals."""

from __future__ import annotations

import asyncio
import base64
import logging
import os
from collections.abc import Coroutine, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, TypeVar

import pytest

from robowidgets import LaserWidget, ScanogramWidget
from robowidgets.widget import png as _png

from ..pages import from_page

T = TypeVar("T")
Drawn = LaserWidget | ScanogramWidget

PICTURE = b"\x89PNG\r\n\x1a\n and so on"
URL = "data:image/png;base64," + base64.b64encode(PICTURE).decode()


class Page:
    """Stands in for the comm of a widget: keeps the questions, and answers on demand."""

    comm_id = "page"

    def __init__(self, widget: Drawn) -> None:
        self.asked: list[int] = []
        self.told: list[str] = []
        self._widget = widget
        self.handle_msg = widget.comm.handle_msg
        widget.comm.close()
        widget.comm = self

    def send(self, data: dict[str, Any], buffers: object = None) -> None:  # noqa: ARG002
        if data["method"] == "custom":
            self.asked.append(data["content"]["png"])
            self.told.append("the question")
        else:
            self.told += [*data["state"], *(path[0] for path in data["buffer_paths"])]

    def answer(self, number: int | None = None, url: str = URL) -> None:
        """Answer a question, by default the last one."""
        from_page(self._widget, {"png": self.asked[-1] if number is None else number, "url": url})

    def fail(self, error: str) -> None:
        """Answer that the picture of the last question could not be drawn."""
        from_page(self._widget, {"png": self.asked[-1], "error": error})

    def on_msg(self, callback: object) -> None:
        pass

    def close(self) -> None:
        pass


@pytest.fixture(params=[LaserWidget, ScanogramWidget])
def widget(request: pytest.FixtureRequest) -> Iterator[Drawn]:
    made = request.param(title="/scan")
    yield made
    made.close()


@pytest.fixture
def page(widget: Drawn) -> Page:
    return Page(widget)


def run(coroutine: Coroutine[Any, Any, T]) -> T:
    """Run to the end in a separate thread: if browsers are tested too, the main thread has a loop already."""
    with ThreadPoolExecutor(1) as thread:
        return thread.submit(asyncio.run, coroutine).result()


def notes(widget: Drawn) -> list[str]:
    found: list[str] = widget.get_state()["_about"].get("notes", [])
    return found


class TestTheFile:
    def test_it_is_there_when_the_page_has_answered(self, widget: Drawn, page: Page, tmp_path: Path) -> None:
        path = tmp_path / "a.png"
        saving = widget.save_png(path)
        assert repr(saving) == f"<{path}: asked for, not written yet>"
        assert not path.exists()
        page.answer()
        assert path.read_bytes() == PICTURE
        assert repr(saving) == f"<{path}: written>"
        assert os.listdir(tmp_path) == ["a.png"]

    def test_a_second_answer_writes_nothing(self, widget: Drawn, page: Page, tmp_path: Path) -> None:
        widget.save_png(tmp_path / "a.png")
        page.answer()
        (tmp_path / "a.png").unlink()
        page.answer()
        page.answer(99)
        assert not os.listdir(tmp_path)

    def test_each_answer_goes_where_its_question_said(
        self, widget: Drawn, page: Page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.chdir(tmp_path)
        widget.save_png("a.png")
        widget.save_png("b.PNG")
        monkeypatch.chdir("/")
        page.answer(page.asked[1])
        assert os.listdir(tmp_path) == ["b.PNG"]
        page.answer(page.asked[0])
        assert sorted(os.listdir(tmp_path)) == ["a.png", "b.PNG"]

    def test_the_page_shows_the_newest_before_it_is_asked(self, tmp_path: Path) -> None:
        laser = LaserWidget()
        page = Page(laser)
        laser.update(ranges=[1, 2], angle_min=0, angle_increment=0.1, range_min=0.1, range_max=9)
        laser.pinned = 1
        laser.save_png(tmp_path / "a.png")
        assert page.told.index("_frame") < page.told.index("the question")
        assert page.told.index("pinned") < page.told.index("the question")
        page.answer()
        laser.close()


class TestAwaiting:
    def test_it_gives_the_path(self, widget: Drawn, page: Page, tmp_path: Path) -> None:
        async def save() -> Path:
            saving = widget.save_png(tmp_path / "a.png")
            asyncio.get_running_loop().call_soon(page.answer)
            return await saving

        assert run(save()) == tmp_path / "a.png"

    def test_it_raises_what_kept_the_file_from_being_written(self, widget: Drawn, page: Page, tmp_path: Path) -> None:
        async def save() -> None:
            saving = widget.save_png(tmp_path / "a.png")
            page.answer(url="data:,")
            await saving

        with pytest.raises(OSError, match=r"a\.png was not written: the page could not draw the picture; it answered"):
            run(save())

    def test_it_raises_the_error_of_the_page(self, widget: Drawn, page: Page, tmp_path: Path) -> None:
        async def save() -> None:
            saving = widget.save_png(tmp_path / "a.png")
            page.fail("EncodingError: too large")
            await saving

        with pytest.raises(OSError, match=r"could not draw the picture: EncodingError: too large"):
            run(save())

    def test_a_page_that_cannot_draw_hinders_no_other_and_was_no_silence(
        self, widget: Drawn, page: Page, tmp_path: Path
    ) -> None:
        saving = widget.save_png(tmp_path / "a.png")
        page.fail("EncodingError: too large")
        widget._png._on_silence()
        assert repr(saving) == f"<{tmp_path / 'a.png'} was not written: the page could not draw the picture: " + (
            "EncodingError: too large>"
        )
        page.answer()
        assert (tmp_path / "a.png").read_bytes() == PICTURE

    def test_a_caller_that_gives_up_waiting_still_gets_the_file(
        self, widget: Drawn, page: Page, tmp_path: Path
    ) -> None:
        async def save() -> None:
            with pytest.raises(asyncio.TimeoutError):
                await asyncio.wait_for(widget.save_png(tmp_path / "a.png"), 0.01)

        run(save())
        page.answer()
        assert (tmp_path / "a.png").read_bytes() == PICTURE


class TestWhatGoesWrongLater:
    def test_a_folder_that_has_gone_is_reported_until_it_works(
        self, widget: Drawn, page: Page, tmp_path: Path, caplog: pytest.LogCaptureFixture
    ) -> None:
        folder = tmp_path / "gone"
        folder.mkdir()
        saving = widget.save_png(folder / "a.png")
        folder.rmdir()
        page.answer()
        words = f"{folder}/a.png was not written: [Errno 2] No such file or directory"
        assert repr(saving).startswith(f"<{words}")
        assert notes(widget)[-1].startswith(words)
        assert words in caplog.text
        widget.save_png(tmp_path / "a.png")
        assert not notes(widget)
        page.answer()  # an unanswered question is logged ten seconds later, in another test

    def test_silence_is_reported_and_a_late_answer_taken(
        self, widget: Drawn, page: Page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(_png, "PATIENCE", 0.01)

        async def save() -> None:
            await widget.save_png(tmp_path / "a.png")

        with pytest.raises(TimeoutError, match=r"a\.png was not written: no page that shows this widget has answered"):
            run(save())
        assert "have it in view and call save_png() again" in notes(widget)[-1]
        page.answer()
        assert (tmp_path / "a.png").exists()
        assert not notes(widget)

    def test_while_a_cell_runs_no_answer_is_expected(
        self,
        widget: Drawn,
        page: Page,
        tmp_path: Path,
        monkeypatch: pytest.MonkeyPatch,
        caplog: pytest.LogCaptureFixture,
    ) -> None:
        assert not page.asked
        runs = iter([True, True, False])
        monkeypatch.setattr(_png, "PATIENCE", 0.01)
        monkeypatch.setattr(_png, "cell_is_running", lambda: next(runs))

        async def save() -> None:
            await widget.save_png(tmp_path / "a.png")

        with caplog.at_level(logging.ERROR), pytest.raises(TimeoutError):
            run(save())
        assert next(runs, None) is None
        assert len(caplog.records) == 1


class TestRefusals:
    @pytest.mark.parametrize(
        ("name", "error", "words"),
        [
            ("a.jpg", ValueError, "save_png(): expected a name that ends in .png, got "),
            ("missing/a.png", FileNotFoundError, "save_png(): there is no folder "),
            ("folder.png", IsADirectoryError, "folder.png' is a folder; expected the name of a file"),
        ],
    )
    def test_a_path_that_cannot_be_is_refused_at_the_call(
        self, widget: Drawn, page: Page, tmp_path: Path, name: str, error: type[Exception], words: str
    ) -> None:
        (tmp_path / "folder.png").mkdir()
        with pytest.raises(error) as refusal:
            widget.save_png(tmp_path / name)
        assert words in str(refusal.value)
        assert not page.asked

    def test_what_may_not_be_written_is_refused_at_the_call(
        self, widget: Drawn, page: Page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(os, "access", lambda _path, _mode: False)
        with pytest.raises(PermissionError, match=r"a\.png' may not be written; choose another folder or name"):
            widget.save_png(tmp_path / "a.png")
        assert not page.asked

    def test_no_path_is_refused(self, widget: Drawn) -> None:
        with pytest.raises(TypeError, match=r"^save_png\(\): expected the path of a file, got 3$"):
            widget.save_png(3)  # type: ignore[arg-type]

    def test_without_a_notebook_there_is_no_picture(self, widget: Drawn, tmp_path: Path) -> None:
        with pytest.raises(RuntimeError, match=r"^save_png\(\) needs a notebook: a page that shows the widget draws"):
            widget.save_png(tmp_path / "a.png")

    def test_a_closed_widget_has_no_picture(self, widget: Drawn, tmp_path: Path) -> None:
        widget.close()
        with pytest.raises(RuntimeError, match=r"^save_png\(\): this widget is closed; show a new one$"):
            widget.save_png(tmp_path / "a.png")
