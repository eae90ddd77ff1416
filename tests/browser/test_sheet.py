"""The contact sheet of a search: its pictures, its clicks and keys, and thousands of moments."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from shutil import copy

import pytest
from playwright.sync_api import Page, expect

import robowidgets
from robowidgets import conditions

from .chromium import shoot
from .notebook import Notebook
from .plain_page import PlainPage

Open = Callable[..., PlainPage]

FOUND = """
import robowidgets
from concurrent.futures import ThreadPoolExecutor
from robowidgets import conditions

with ThreadPoolExecutor(1) as here:
    hits = robowidgets.find(conditions.nearest_below(0.3), {folder!r}, executor=here, keep=False)
"""

MANY = """
from robowidgets.fleet import Hits

some = [hit for hit in hits for _ in range(250)]
many = Hits(conditions.nearest_below(0.3), some, files=hits.files, chosen={}, problems={})
"""

SLOWLY = """
import os
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import robowidgets
from robowidgets import conditions

os.environ["ROBOWIDGETS_CACHE"] = {cache!r}
asked = []


class Slowly(ThreadPoolExecutor):
    \"\"\"Reads a recording once a file of its name is there.\"\"\"

    def submit(self, function, task, path, longest):
        asked.append(Path(path).name)
        return super().submit(self._read, function, task, path, longest)

    def _read(self, function, task, path, longest):
        while not (Path({may!r}) / Path(path).name).exists():
            threading.Event().wait(0.02)
        return function(task, path, longest)


here = Slowly(1)
"""

FIND = "hits = robowidgets.find(conditions.nearest_below(0.3), {folder!r}, executor=here)\nhits"

PAINTED = "(count) => document.querySelectorAll('[data-painted=\"rays\"]').length >= count"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    runs = tmp_path / "runs"
    runs.mkdir()
    for number in (2, 10):
        copy(robowidgets.SAMPLE, runs / f"drive_{number}.mcap")
    (runs / "empty.bag").touch()
    return runs


@pytest.mark.core
def test_a_sheet_draws_sorts_filters_walks_and_opens(plain_page: Open, folder: Path) -> None:
    nb = plain_page([FOUND.format(folder=str(folder)) + "sheet = hits.show()\nsheet"], width=1280, height=1500)
    nb.run_all()
    sheet = nb.widget(0).locator(".rw-sheet")
    tiles = sheet.locator(".rw-sheet-tile")
    nb.page.wait_for_function(PAINTED, arg=16)
    expect(tiles).to_have_count(16)
    expect(sheet.locator(".rw-facts")).to_contain_text("16 in 2 of 2 files · 1 not searched")
    expect(sheet.locator(".rw-sheet-odd")).to_contain_text("empty.bag")
    shoot(sheet, "sheet")

    def shown() -> list[str]:
        """File and time of the moments, in their order."""
        texts: list[str] = sheet.evaluate(
            """(sheet) => {
              const place = (tile) => new DOMMatrix(getComputedStyle(tile).transform);
              const at = (tile) => 1e4 * place(tile).m42 + place(tile).m41;
              return [...sheet.querySelectorAll(".rw-sheet-tile")].sort((a, b) => at(a) - at(b)).map(
                (tile) => [".rw-sheet-file", ".rw-sheet-time"].map((of) => tile.querySelector(of).textContent).join(" ")
              );
            }"""
        )
        return texts

    values = nb.python(
        "[f'drive_{10 if \"_10\" in h.file else 2} {h.moment:.1f} s' for h in sorted(hits, key=lambda h: h.nearest)]"
    )
    assert repr(shown()) == values.strip()
    sheet.get_by_role("button", name="One per file").click()
    expect(tiles).to_have_count(2)
    sheet.get_by_role("button", name="One per file").click()
    sheet.locator(".rw-sheet-scroll").focus()
    nb.page.keyboard.press("/")
    nb.page.keyboard.type("_10")
    expect(tiles).to_have_count(8)
    assert all(text.startswith("drive_10") for text in shown())
    nb.page.keyboard.press("Escape")
    expect(tiles).to_have_count(16)
    # Keys walk and mark, and Enter opens, below.
    nb.page.keyboard.press("Home")
    nb.page.keyboard.press("ArrowRight")
    nb.page.keyboard.press("x")
    expect(sheet.locator(".rw-false")).to_have_count(1)
    expect(sheet.locator(".rw-facts")).to_contain_text("1 false")
    expect(sheet.locator(".rw-sheet-code")).to_contain_text('.mcap").at("/scan"')
    nb.page.keyboard.press("Enter")
    expect(nb.widget(0).locator(".rw-player")).to_be_visible(timeout=60_000)  # the player reads the whole drive
    code = sheet.locator(".rw-sheet-code").text_content() or ""
    assert nb.python(f"{code}.sample.nearest().index == sheet.picked.index").strip() == "True"
    assert nb.python("sheet.player.time == sheet.picked.moment").strip() == "True"
    # A click opens another one; a table shows the same moment.
    tiles.nth(5).click()
    expect(sheet.locator(".rw-open")).to_have_count(1, timeout=60_000)
    sheet.get_by_role("button", name="Table").click()
    expect(sheet.locator(".rw-sheet-row.rw-sheet-item").first).to_contain_text("drive_2.mcap")
    sheet.locator(".rw-sheet-heads").get_by_role("button", name="held").click()
    assert nb.python("sheet.widget.sort, sheet.widget.rows").strip() == "('held', True)"
    shoot(sheet, "sheet_table")


def test_of_thousands_only_the_visible_rows_are_on_the_page_and_scroll_while_a_cell_runs(
    plain_page: Open, folder: Path
) -> None:
    nb = plain_page([FOUND.format(folder=str(folder)) + MANY + "sheet = many.show(sort='file')\nsheet"], width=1280)
    nb.run_all()
    sheet = nb.widget(0).locator(".rw-sheet")
    nb.page.wait_for_function(PAINTED, arg=21)
    expect(sheet.locator(".rw-facts")).to_contain_text("4,000 in 2")
    # The kernel sends all of them without being asked: the last ones are on the page when the user scrolls to them.
    sheet.evaluate("(sheet) => { sheet.scrolls = sheet.querySelector('.rw-sheet-scroll'); }")
    last = nb.python("len(many) - 1").strip()
    while nb.python(f"{last} in sheet._sender._sent").strip() != "True":
        pass
    with nb.busy():
        sheet.evaluate("(sheet) => { sheet.scrolls.scrollTop = sheet.scrolls.scrollHeight; }")
        expect(sheet.locator(f'[data-number="{last}"]')).to_have_attribute("data-painted", "rays")
        assert sheet.locator(".rw-sheet-tile").count() <= 7 * 7
        sheet.get_by_role("button", name="Every").click()
        expect(sheet.locator(".rw-sheet-tile")).to_have_count(21)


def test_in_a_notebook_a_table_grows_a_click_opens_a_hit_and_after_an_interrupt_the_same_call_goes_on(
    notebook: Callable[..., Notebook], folder: Path, tmp_path: Path
) -> None:
    copy(robowidgets.SAMPLE, folder / "drive_11.mcap")
    may = tmp_path / "may"
    may.mkdir()
    nb = notebook(
        [SLOWLY.format(cache=str(tmp_path / "cache"), may=str(may)), FIND.format(folder=str(folder))], run=False
    )
    nb.run(0)
    nb.start(1)
    sheet = nb.output(1).locator(".rw-sheet")
    rows = sheet.locator(".rw-sheet-row.rw-sheet-item")
    facts = sheet.locator(".rw-facts")
    (may / "drive_2.mcap").touch()
    expect(rows).to_have_count(8)
    expect(facts).to_contain_text("8 so far, 1 of 4 files")
    # It also grows while the next recording takes long.
    (may / "drive_10.mcap").touch()
    expect(facts).to_contain_text("16 so far, 2 of 4 files")
    rows.nth(9).click()
    expect(nb.output(1).locator(".rw-player")).to_be_visible()
    shown = rows.nth(9).locator(".rw-sheet-of-time").text_content()
    expect(nb.output(1).locator(".rw-play-now")).to_contain_text(str(shown))
    shoot(nb.output(1), "sheet_grows")
    nb.interrupt()
    nb.wait(1)
    expect(nb.output(1)).to_contain_text("stopped after 2 of 4 files: the same call continues")
    expect(facts).to_contain_text("16 so far, 2 of 4 files")
    expect(nb.output(1).locator(".rw-player")).to_be_visible()
    for name in ("drive_11.mcap", "empty.bag"):
        (may / name).touch()
    assert nb.python("asked.clear(), len(hits), hits.until, hits.is_complete").strip() == "(None, 16, 2, False)"
    nb.run(1)
    assert nb.python("asked, len(hits), hits.is_complete").strip() == "(['drive_11.mcap', 'empty.bag'], 24, True)"


def test_a_page_of_hits_plays_each_moment_without_a_kernel(
    static_page: Callable[[Path], Page], folder: Path, tmp_path: Path
) -> None:
    with ThreadPoolExecutor(1) as here:
        hits = robowidgets.find(conditions.nearest_below(0.3), folder, executor=here, keep=False)
    file = hits[:10].to_html(tmp_path / "near_misses.html", around=1.0)
    page = static_page(file)
    expect(page.locator(".rw-sheet-tile")).to_have_count(10)
    page.wait_for_function(PAINTED, arg=10)
    for number in (9, 2):
        page.locator(f'[data-number="{number}"]').click()
        expect(page.locator(".rw-open")).to_have_attribute("data-number", str(number))
        expect(page.locator(".rw-player")).to_have_count(1)
        expect(page.locator(".rw-play-now")).to_have_text(f"{hits[number].moment:.2f}")
        expect(page.locator(".rw-laser .rw-nearest")).to_contain_text(f"{hits[number].nearest:.2f} m")
    shoot(page.locator("body"), "sheet_page")
