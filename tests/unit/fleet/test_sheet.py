"""The contact sheet: its pictures, their order, and the effect of a click."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import conditions
from robowidgets.fleet import Hits, find
from robowidgets.fleet._live import LiveTable
from robowidgets.fleet._picture_sender import PictureSender
from robowidgets.fleet._pictures import LINE, RAYS, WORDS, Thumbnail, pictures
from robowidgets.fleet._sheet import Sheet
from robowidgets.recordings.search.base import condition
from robowidgets.sheet_widget import SheetWidget

from ..pages import display_html, from_page, synced
from ..recordings import recorded, sweeps
from .executors import Here

JS = Path(__file__).parents[2] / "js" / "sheet.test.ts"
NEAR = conditions.nearest_below(0.3)


class Scheduler:
    """Does turns on demand."""

    class clock:  # noqa: N801
        now = staticmethod(lambda: 0.0)

    def __init__(self) -> None:
        self.turn: Callable[[], float | None] | None = None
        self.is_detached = False

    def start(self, turn: Any, *_: Any, **__: Any) -> Scheduler:
        self.turn = turn
        return self

    def wake(self) -> None:
        pass

    def detach(self) -> None:
        self.is_detached = True


@pytest.fixture
def hits(runs: Path) -> Hits:
    return find(NEAR, runs, executor=Here())


@pytest.fixture
def sheet(hits: Hits) -> Iterator[Sheet]:
    shown = hits.show()
    yield shown
    shown.close()


def of(wanted: Any) -> list[Thumbnail]:
    """The first pictures of a search in the sample."""
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        found = find(wanted, robowidgets.SAMPLE, executor=Here())
        return list(made(recording, found, wanted))


def made(recording: Any, found: Hits, wanted: Any) -> Iterator[Thumbnail]:
    for packed in pictures(recording, dict(enumerate(found[:3])), condition(wanted)):
        form, count = packed[4], int.from_bytes(packed[6:8], "little")
        size = count * {RAYS: 2, LINE: 4, WORDS: 1}[form]
        words = int.from_bytes(packed[20:22], "little")
        values = np.frombuffer(packed[24 : 24 + size], {RAYS: "<u2", LINE: "<f4", WORDS: "u1"}[form])
        yield Thumbnail(form, values, words=packed[24 + size : 24 + size + words].decode())


def test_a_picture_is_the_scan_that_met_the_nearest_thing_and_lights_each_ray_below_the_limit() -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        found = find(NEAR, robowidgets.SAMPLE, executor=Here())
        hit = found[2]
        scan = recording.at("/scan", hit.moment).sample
        assert scan.nearest().index == hit.index
        picture = list(made(recording, found, NEAR))[2]
    is_near = np.pad(scan.ranges < np.float32(0.3), (0, -len(scan) % 2)).reshape(-1, 2).any(axis=1)
    assert np.array_equal((picture.values & 0x8000) != 0, is_near)
    shown = (picture.values & 0x7FFF) * 0.002
    assert shown[hit.index // 2] == pytest.approx(hit.nearest, abs=0.001)
    assert picture.words == "0.15 < 0.30 m"


@pytest.mark.parametrize(
    ("wanted", "form", "words"),
    [
        (conditions.touched(), RAYS, "right"),
        (conditions.event(), RAYS, "right touched"),
        (conditions.speed_above(0.2), LINE, "0.60 > 0.20 m/s"),
        (conditions.field("/odom.twist.twist.linear.x") < 0, LINE, "−0.30 < 0.00 m/s"),
        (conditions.gap(0.05), RAYS, "nothing on /scan"),
        (conditions.touched() & conditions.nearest_below(0.5), RAYS, "right · 0.15 < 0.50 m"),
        (lambda moment: moment.scan.distance("front") < 0.4, RAYS, "0.15 < 0.40 m"),
    ],
    ids=["touched", "event", "speed", "field", "gap", "joined", "function"],
)
def test_a_hit_shows_what_its_condition_looked_at(wanted: Any, form: int, words: str) -> None:
    first = of(wanted)[0]
    assert (first.form, first.words) == (form, words)


def test_the_page_unpacks_packed_content() -> None:
    rays = Thumbnail(RAYS, np.array([100, 0x8004, 0], "<u2"), (0.5, 0.125), 0.002, "facts").pack(5)
    line = Thumbnail(LINE, np.array([1.0, 0.1], "<f4"), (-1.0, 10.0)).pack(7)
    known = "".join(re.findall(r'"([0-9a-f]+)"', JS.read_text(encoding="utf-8").split("PACKED =")[1].split(";")[0]))
    assert (rays + line).hex() == known


def test_what_a_page_looks_at_comes_first_by_its_newest_word_and_then_all_others(hits: Hits) -> None:
    sent: list[list[int]] = []
    held: list[bytes] = []

    def numbers(packed: bytes) -> list[int]:
        found, at = [], 0
        while at < len(packed):
            found.append(int.from_bytes(packed[at : at + 4], "little"))
            size = int.from_bytes(packed[at + 6 : at + 8], "little") * 2 + int.from_bytes(
                packed[at + 20 : at + 22], "little"
            )
            at += 24 + size + -size % 4
        return found

    scheduler = Scheduler()
    sender = PictureSender(lambda packed: sent.append(numbers(packed)), held.append, NEAR, scheduler)  # type: ignore[arg-type]
    sender.set_hits(hits)
    assert scheduler.turn is None  # no page looks
    sender.look([20, 0])
    assert scheduler.turn
    scheduler.turn()
    sender.look([9, 10])  # it scrolled on
    scheduler.turn()
    assert sent == [[20], [9, 10]]
    while scheduler.turn() is not None:
        pass
    assert sorted(number for one in sent for number in one) == list(range(len(hits)))
    assert [numbers(one) for one in held] == [[20, 9, 10]]
    sender.look([20])  # a page that has lost it
    scheduler.turn()
    assert sent[-1] == [20]
    sender.close()
    scheduler.turn()
    assert scheduler.is_detached


def test_a_file_that_is_gone_has_the_reason_in_the_place_of_its_pictures(hits: Hits, runs: Path) -> None:
    sent: list[bytes] = []
    (runs / "run_2.mcap").unlink()
    scheduler = Scheduler()
    sender = PictureSender(sent.append, lambda _: None, NEAR, scheduler)  # type: ignore[arg-type]
    sender.set_hits(hits)
    sender.look([next(i for i, hit in enumerate(hits) if hit.file.endswith("run_2.mcap"))])
    assert scheduler.turn
    scheduler.turn()
    assert b"run_2.mcap" in sent[0]


def test_the_sheet_holds_the_hits_by_column_and_the_files_that_were_not_read(sheet: Sheet, hits: Hits) -> None:
    state = sheet.widget.get_state()
    assert [state["_files"][i][0] for i in state["_columns"]["file"]] == [hit.file for hit in hits]
    assert state["_columns"]["nearest"] == [hit.nearest for hit in hits]
    assert [one["name"] for one in state["_unread"]] == ["broken.bag"]
    assert (state["_total"], state["_done"], state["condition"]) == (4, None, "nearest below 0.3 m")


def test_a_click_opens_the_player_at_the_moment_with_all_moments_of_the_file_marked(sheet: Sheet, hits: Hits) -> None:
    from_page(sheet.widget, {"open": 12})
    player = sheet.player
    assert player is not None
    assert str(player.recording.path) == hits[12].file
    assert player.time == pytest.approx(hits[12].moment)
    assert len(player.marks) == sum(hit.file == hits[12].file for hit in hits)
    assert sheet.children == (sheet.widget, player)
    other = next(i for i, hit in enumerate(hits) if hit.file == hits[12].file and i != 12)
    from_page(sheet.widget, {"open": other})
    assert sheet.player is player  # it is open already
    from_page(sheet.widget, {"open": 0})
    assert sheet.player is not player
    assert synced(sheet.widget, "_opened") == 0


def test_a_moment_whose_file_is_gone_is_reported_and_the_open_one_stays(sheet: Sheet, hits: Hits) -> None:
    sheet.open_hit(0)
    player = sheet.player
    last = len(hits) - 1
    Path(hits[last].file).unlink()
    from_page(sheet.widget, {"open": last})
    assert Path(hits[last].file).name in synced(sheet.widget, "_status")
    assert sheet.player is player


def test_the_program_gets_picked_and_marked_moments(sheet: Sheet, hits: Hits) -> None:
    assert sheet.picked is None
    sheet.widget.picked = 3
    sheet.widget.false_finds = [1, 3]
    assert sheet.picked == hits[3]
    assert sheet.false_finds == [hits[1], hits[3]]


def test_a_label_that_the_user_gives_a_moment_is_saved_next_to_its_recording(sheet: Sheet, hits: Hits) -> None:
    from_page(sheet.widget, {"label": [2, " door "]})
    assert sheet.widget.labels == {"2": "door"}
    with robowidgets.open(hits[2].file) as recording:
        assert [one[:3] for one in recording.labels] == [("door", hits[2].start, hits[2].end)]
        from_page(sheet.widget, {"label": [3, " "]})
        assert "expected a name" in synced(sheet.widget, "_status")
        # Another name replaces it, and an empty one removes it.
        from_page(sheet.widget, {"label": [2, "wall"]})
        assert [one.label for one in recording.labels] == ["wall"]
        assert synced(sheet.widget, "_status") == ""
        from_page(sheet.widget, {"label": [2, ""]})
        assert recording.labels == ()
    assert sheet.widget.labels == {}


def test_a_sheet_has_the_earlier_labels_of_spans_and_the_labels_of_its_player(sheet: Sheet, hits: Hits) -> None:
    with robowidgets.open(hits[1].file) as recording:
        recording.label("door", hits[1].start, hits[1].end)
        recording.label("elsewhere", hits[1].start, hits[1].end + 1)
    again = hits.show()
    assert again.widget.labels == {"1": "door"}
    again.open_hit(1)
    assert again.player is not None
    bar = again.player.bar
    assert [name for _, _, name in bar.labels] == ["door", "elsewhere"]
    door = [hits[1].start, hits[1].end, "door"]
    from_page(bar, {"label": [[*door[:2], "wall"], door]})
    assert again.widget.labels == {"1": "wall"}
    again.label_hit(1, "")
    assert [name for _, _, name in bar.labels] == ["elsewhere"]
    again.close()


def test_a_page_of_hits_that_is_too_large_is_not_written_and_the_error_has_a_remedy(hits: Hits, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"would take about .* take fewer hits .* or less around each"):
        hits[:2].to_html(tmp_path / "hits.html", max_size=10_000)
    with pytest.raises(ValueError, match="nothing was found"):
        hits[:0].to_html(tmp_path / "hits.html")
    assert not (tmp_path / "hits.html").exists()


def test_the_table_that_grows_waits_as_long_as_it_costs_but_for_what_loading_the_widget_does(
    hits: Hits, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("robowidgets.fleet._live.running_cell", lambda: ("cell", "run"))
    shown: list[int] = []
    now, spent = [10.0], [0.0]

    def to_hits(results: Any, _unread: Any, _files: Any) -> Hits:
        spent[0] += 1.0
        shown.append(len(results))
        return hits[: len(results)]

    def at(seconds: float, count: int) -> list[int]:
        now[0] = seconds
        live.grow({str(i): {} for i in range(count)}, (), hits.files)
        return shown

    monkeypatch.setattr("IPython.display.display", lambda _sheet: None)
    live = LiveTable(to_hits, lambda: now[0], lambda: spent[0])
    assert at(10.9, 1) == []
    assert at(11.0, 1) == [1]
    assert at(11.4, 2) == [1]
    assert at(11.5, 2) == [1, 2]
    assert at(31.4, 3) == [1, 2]
    assert at(31.5, 3) == [1, 2, 3]
    assert at(90.0, 3) == [1, 2, 3]


def test_a_table_grows_below_the_cell_while_a_search_runs_and_stands_for_the_result(
    runs: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown: list[Sheet] = []
    grown: list[tuple[int, int | None]] = []
    run = ("cell", "first run")
    for module in ("_live", "hits"):
        monkeypatch.setattr(f"robowidgets.fleet.{module}.running_cell", lambda: run)
    monkeypatch.setattr("robowidgets.fleet._live.SHOWN_AFTER", -1)
    monkeypatch.setattr("robowidgets.fleet._live._LEAST", 0.0)
    monkeypatch.setattr("robowidgets.fleet._live._SHARE", 0)
    monkeypatch.setattr("IPython.display.display", shown.append)
    show = SheetWidget.show

    def noted(widget: Any, columns: Any, *given: Any, **named: Any) -> None:
        grown.append((len(columns["file"]), named["done"]))
        show(widget, columns, *given, **named)

    monkeypatch.setattr(SheetWidget, "show", noted)
    found = find(NEAR, runs, executor=Here(), keep=False)
    (sheet,) = shown
    assert sheet.widget.rows
    assert [count for count, _ in grown] == sorted(count for count, _ in grown)
    assert [done for _, done in grown[-2:]] == [4, None]
    assert grown[-1][0] == len(found) == 24
    assert "<td" not in display_html(found)
    other = found.show()
    assert sheet.comm is None, "the sheet takes the place of the table"
    other.close()
    run = ("cell", "second run")
    assert "<td" in display_html(found)
    sheet.close()


def test_a_picture_lights_the_rays_of_a_scan_that_came_before_its_span(tmp_path: Path) -> None:
    seen = {0.0: [2.0, 0.2, 0.25, 3.0], 1.0: [2.0, 0.28, 3.0, 3.0], 2.0: [2.0, 3.0, 3.0, 3.0]}
    rows = [
        *((at, "/scan", sweeps.scan(sweeps.START_NS, ranges)) for at, ranges in seen.items()),
        *((at, "/on", {"data": at == 0.5}) for at in (0.0, 0.5, 1.5)),
    ]
    topics = {"/scan": sweeps.TYPE, "/on": "std_msgs/msg/Bool"}
    path = recorded.write(tmp_path / "drive", topics, sorted(rows, key=lambda row: row[0]))
    wanted = NEAR & (conditions.field("/on.data") == True)  # noqa: E712  # a condition
    found = find(wanted, path, executor=Here())
    (hit,) = found
    assert (hit.start, hit.end, hit.index, hit.moment) == (0.5, 1.5, 1, 0.5)
    with robowidgets.open(path) as recording:
        (picture,) = made(recording, found, wanted)
    assert ((picture.values & 0x8000) != 0).tolist() == [False, True, True, False]
    assert picture.words == "0.20 < 0.30 m · True = True"
