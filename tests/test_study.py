"""The study: its steps and its files, and a dry run in which simulated participants have an effect that is found."""

from __future__ import annotations

import json
import math
import random
import re
import sys
import threading
from collections import Counter
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from .conftest import ROOT
from .unit.waiting import threads_named, wait_for

sys.path.insert(0, str(ROOT / "studies"))
import compare
import study

from .unit.pages import display_html

CODE = {
    "wall_ahead": 'def wall_ahead(scan):\n    return scan.distance(("-20deg", "20deg"))',
    "nearest_on_the_left": 'def nearest_on_the_left(scan):\n    return scan.distance("left")',
}


class Participant:
    """A simulated participant with an opinion, and some seconds for each task."""

    def __init__(self, number: int, folder: Path) -> None:
        self.time = 0.0
        self.study = study.Study(number, folder, clock=lambda: self.time, now=self.now)

    def now(self) -> datetime:
        return datetime.fromtimestamp(self.time, timezone.utc)

    def right(self, task: Any) -> str:
        """An answer that is right."""
        if task.is_code:
            return next(text for name, text in CODE.items() if f"def {name}(" in task.given)
        step = 1.0 if task.name == "index" else 0.05
        return next(f"{n * step:g}" for n in range(1000) if not task.wrong(f"{n * step:g}"))

    def take_part(self, seconds: dict[str, float], like: dict[str, int], steps: int = 100) -> None:
        for _ in range(steps):
            if self.study.step is None:
                return
            kind, _, form, _, task = self.study.step
            if kind == "consent":
                self.study.agree()
            elif kind == "task":
                self.time += seconds[form]
                assert self.study.answer(self.right(task)) == ""
            elif kind == "tlx":
                self.study.rate(dict.fromkeys(study.TLX, 100 - 20 * like[form]))
            else:
                self.study.rate({str(n): like[form] if n % 2 else 6 - like[form] for n in range(1, 11)})


@pytest.fixture(autouse=True)
def quick_code(monkeypatch: pytest.MonkeyPatch) -> None:
    """Answers in code are checked once each: the check itself has its own tests."""
    known: dict[tuple[str, str], str] = {}
    check = study.code_wrong

    def once(name: str, text: str) -> str:
        if (name, text) not in known:
            known[name, text] = check(name, text)
        return known[name, text]

    monkeypatch.setattr(study, "code_wrong", once)


def test_a_known_effect_of_simulated_participants_is_found_and_no_false_one(tmp_path: Path) -> None:
    chance = random.Random(3)
    for name, effect in (("faster", 0.7), ("same", 1.0)):
        (tmp_path / name).mkdir()
        for number in range(1, 13):
            skill = chance.lognormvariate(3.5, 0.4)
            seconds = {study.WITH: skill * effect * chance.lognormvariate(0, 0.1), study.WITHOUT: skill}
            like = {study.WITH: chance.choice([4, 5]) if effect < 1 else 3, study.WITHOUT: 3}
            Participant(number, tmp_path / name).take_part(seconds, like)
    faster, same = (compare.compare(tmp_path / name) for name in ("faster", "same"))
    times, solved, tlx, sus = faster.measures
    assert times.low < 0.7 < times.high < 0.85
    assert times.low > 0.6
    assert solved.effect == 0
    assert solved.values.tolist() == [[4, 4]] * 12
    assert tlx.high < 0
    assert 20 < sus.low <= sus.effect <= 50
    assert same.measures[0].low < 1 < same.measures[0].high
    assert "12 participants" in repr(faster)
    assert "<svg" in display_html(faster)


def test_forms_sets_and_their_order_are_balanced_over_four_participants(tmp_path: Path) -> None:
    firsts = []
    for number in range(1, 9):
        steps = study.Study(number, tmp_path)._steps
        blocks = {block: (form, which) for _, block, form, which, _ in steps if block}
        assert {form for form, _ in blocks.values()} == {study.WITH, study.WITHOUT}
        assert {which for _, which in blocks.values()} == {"A", "B"}
        firsts.append(blocks[1])
    assert set(Counter(firsts).values()) == {2}
    assert len(Counter(firsts)) == 4


def test_no_answer_of_either_set_is_the_first_index_or_nothing() -> None:
    for which in "AB":
        for task in study.tasks_of(which)[:3]:
            assert {task.wrong(text) for text in ("-1", "0", "0,0")} == {"Not yet."}


def test_a_file_is_continued_after_its_last_step_and_a_damaged_one_is_reported(tmp_path: Path) -> None:
    seconds, like = {study.WITH: 10.0, study.WITHOUT: 20.0}, {study.WITH: 5, study.WITHOUT: 2}
    first = Participant(7, tmp_path)
    first.take_part(seconds, like, steps=4)
    again = Participant(7, tmp_path)
    assert again.study.step is not None
    assert first.study.step is not None
    assert again.study.step[:4] == first.study.step[:4]
    again.take_part(seconds, like)
    rows = study.read_rows(tmp_path / "P07.csv")
    assert Counter(row.kind for row in rows) == {"consent": 1, "try": 8, "task": 8, "tlx": 12, "sus": 20}
    assert {row.seconds for row in rows if row.kind == "task"} == {10.0, 20.0}
    assert Participant(7, tmp_path).study.step is None
    Participant(8, tmp_path).take_part(seconds, like, steps=3)
    text = (tmp_path / "P07.csv").read_text("utf-8")
    (tmp_path / "P09.csv").write_text(text[:-30], "utf-8")
    (tmp_path / "P10.csv").write_text("a,b\n1,2\n", "utf-8")
    with pytest.raises(ValueError, match=r"two complete files or more .*P08.csv is not comp.*P09.csv is not a file of"):
        compare.compare(tmp_path)
    with pytest.raises(ValueError, match="expected a number from 1 to 9999, got 0"):
        study.Study(0, tmp_path)


def test_a_file_twice_and_one_without_some_rows_are_left_out_with_the_reason(tmp_path: Path) -> None:
    seconds, like = {study.WITH: 10.0, study.WITHOUT: 20.0}, {study.WITH: 5, study.WITHOUT: 2}
    for number in range(1, 6):
        Participant(number, tmp_path).take_part(seconds, like)
    (tmp_path / "P02 (1).csv").write_bytes((tmp_path / "P02.csv").read_bytes())
    for name, is_lost in (
        ("P03.csv", lambda line: ",tlx,1," in line and ",effort," in line),
        ("P04.csv", lambda line: ",task,2," in line and ",gap," in line),
        ("P05.csv", lambda line: ",sus,1," in line and ",7," in line),
    ):
        lines = (tmp_path / name).read_text("utf-8").splitlines(keepends=True)
        (tmp_path / name).write_text("".join(line for line in lines if not is_lost(line)), "utf-8")
    found = compare.compare(tmp_path)
    assert found.participants == (1, 2)
    assert [re.split("[,:;] ", problem)[:2] for problem in found.problems] == [
        ["P02.csv and P02 (1).csv are both of participant 2", "keep one of them"],
        ["P03.csv is not complete", "expected a row for each tlx with widgets"],
        ["P04.csv is not complete", "expected a row for each task with widgets"],
        ["P05.csv is not complete", "expected a row for each sus with widgets"],
    ]
    assert found.problems[2].endswith(": index, distance, gap, code; got index, distance, code")
    assert found.measures[0].effect == pytest.approx(0.5)


def test_wrong_answers_are_reported_counted_and_end_with_the_time_limit(tmp_path: Path) -> None:
    someone = Participant(1, tmp_path)
    someone.study.agree()
    assert someone.study.answer("many") == "Type a number, such as 1.5."
    assert someone.study.answer("-1") == "Not yet."
    someone.time += study.LIMIT + 1
    assert someone.study.answer("-1") == ""
    someone.study.give_up()
    rows = [row for row in study.read_rows(someone.study.file) if row.kind == "task"]
    assert [(row.tries, row.right, row.seconds) for row in rows] == [(3, False, study.LIMIT), (0, False, study.LIMIT)]
    assert study.code_wrong("wall_ahead", "def other(scan): ...") == "Keep the name wall_ahead."
    assert "SyntaxError" in study.code_wrong("wall_ahead", "def (")
    assert study.code_wrong("wall_ahead", "exit()").startswith("SystemExit")
    assert "right in 0 of 8" in study.code_wrong("wall_ahead", "def wall_ahead(scan):\n    return -1")


def test_the_clock_and_the_tries_of_a_task_survive_a_reload(tmp_path: Path) -> None:
    someone = Participant(1, tmp_path)
    someone.study.agree()
    someone.study.show()
    someone.time += 40
    assert someone.study.answer("-1") == "Not yet."
    later = Participant(1, tmp_path)  # another kernel, with a clock that begins at 0
    later.time = someone.time + 20
    later.study = study.Study(1, tmp_path, clock=lambda: later.time - 60, now=later.now)
    later.study.show()
    assert later.study.answer(later.right(later.study.step[4])) == ""
    (row,) = [row for row in study.read_rows(later.study.file) if row.kind == "task"]
    assert (row.seconds, row.tries, row.right) == (60.0, 2, True)
    assert row.started == datetime.fromtimestamp(0, timezone.utc).isoformat(timespec="milliseconds")
    next_one = study.Study(1, tmp_path, clock=lambda: later.time, now=later.now)
    assert next_one._since == later.time  # which was not shown yet


def test_untouched_sliders_and_statements_without_an_answer_are_named_and_do_not_count(tmp_path: Path) -> None:
    someone = Participant(1, tmp_path)
    someone.study.agree()
    while someone.study.step[0] == "task":
        someone.study.give_up()
    box = someone.study.show()
    sliders = [row.children[1] for row in box.children if type(row).__name__ == "HBox"]
    for slider in sliders[:5]:
        slider.value = 10
    box.children[-1].click()
    assert someone.study.step[0] == "tlx"
    assert box.children[-2].value.endswith("the middle: frustration")
    sliders[5].value = 55
    sliders[5].value = 50
    box.children[-1].click()
    rows = [row for row in study.read_rows(someone.study.file) if row.kind == "tlx"]
    assert [row.value for row in rows] == ["10"] * 5 + ["50"]
    choices = [child for child in box.children if type(child).__name__ == "RadioButtons"]
    for choice in choices[:-2]:
        choice.value = 3
    box.children[-1].click()
    assert someone.study.step[0] == "sus"
    assert box.children[-2].value == "Answer these, too: 9, 10"


def test_the_notebook_shows_no_answer_and_a_plain_scan_has_no_method_that_gives_one(tmp_path: Path) -> None:
    someone = Participant(1, tmp_path)
    someone.study.agree()
    for which in "AB":
        for task in study.tasks_of(which)[:3]:
            shown = repr(study.PlainScan(task.scan))
            assert not [word for word in shown.replace(",", " ").split() if not task.wrong(word)]
    assert not {"nearest", "distance", "at", "indices", "xy"} & set(dir(someone.study.scan))
    cells = json.loads((ROOT / "studies" / "take_part.ipynb").read_text("utf-8"))["cells"]
    assert "".join(cells[-1]["source"]) == "study.scan.ranges[:10]"
    for which in "AB":
        index = study.tasks_of(which)[0]
        assert all(index.wrong(str(number)) for number in range(10))


def test_without_has_a_grid_with_a_scale_and_the_place_of_each_point() -> None:
    scan = study.tasks_of("A")[0].scan
    page = study.picture(scan, study.WITHOUT).value
    assert all(f">{metres} m</text>" in page for metres in (1, 2, 3, -1, -2, -3))
    assert page.count("<circle") > 100
    index = next(i for i, ray in enumerate(scan.ranges) if math.isfinite(ray) and ray < 4)
    x, y = (scan.ranges[index] * f(scan.angles[index]) for f in (math.cos, math.sin))
    assert f"<title>point {index}: x {x:.2f} m, y {y:.2f} m</title>" in page
    assert "nan" not in page.split("<div>angle_min")[0]
    assert "inf" not in page.split("<div>angle_min")[0]


@pytest.mark.parametrize("people", [2, 4, 8, 12, 40])
def test_the_interval_covers_the_effect_in_95_of_100_studies(people: int) -> None:
    chance = np.random.default_rng(people)
    studies = np.log(0.7) + chance.normal(0, 0.4, (4000, people))
    covered = [low <= np.log(0.7) <= high for low, high in map(compare.interval_of, studies)]
    assert 0.94 < np.mean(covered) < 0.96


def test_if_no_difference_varies_there_is_no_interval_and_no_false_certainty() -> None:
    assert all(map(math.isnan, compare.interval_of(np.zeros(4))))
    assert all(map(math.isnan, compare.interval_of(np.full(4, 0.1))))
    quantiles = {1: 12.706, 30: 2.042, 31: 2.0395, 60: 2.0003, 1000: 1.9623}  # of published tables
    assert {n: compare._t_975(n) for n in quantiles} == pytest.approx(quantiles, abs=1e-4)


def test_a_task_that_is_left_while_its_answer_is_judged_ends_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    someone = Participant(1, tmp_path)
    someone.study.agree()
    while not someone.study.step[4].is_code:
        someone.study.give_up()
    box = someone.study.show()
    judged, goes_on = threading.Event(), threading.Event()

    def wrong(_name: str, _text: str) -> str:
        judged.set()
        goes_on.wait(240)
        return ""

    monkeypatch.setattr(study, "code_wrong", wrong)
    check, leave = box.children[3].children
    check.click()
    check.click()
    assert judged.wait(240)
    assert check.disabled
    leave.click()
    shown = box.children
    goes_on.set()
    wait_for(lambda: not threads_named("study"), "both answers are judged")
    assert someone.study.step[0] == "tlx"
    assert box.children is shown
    assert [row.right for row in study.read_rows(someone.study.file) if row.kind == "task"] == [False] * 4


def test_a_participant_goes_through_the_page_by_its_buttons(tmp_path: Path) -> None:
    someone = Participant(1, tmp_path)
    box = someone.study.show()
    seen = []
    while someone.study.step is not None:
        kind, _, form, _, task = someone.study.step
        seen.append(kind)
        if kind == "task":
            view, field, buttons = box.children[1:4]
            assert type(view).__name__ == ("LaserWidget" if form == study.WITH else "HTML")
            check, said = buttons.children[0], box.children[4]
            field.value = "never" if not task.is_code else "1/0"
            check.click()
            wait_for(lambda check=check: not check.disabled, "the answer is judged")
            assert someone.study.step[4] is task
            assert said.value.startswith("<pre>")
            someone.time += 5
            someone.study.show()  # run again: its time goes on
            field.value = someone.right(task)
            check.click()
            wait_for(lambda said=said: said not in box.children, "the next step is shown")
        else:
            for child in box.children:
                if type(child).__name__ == "RadioButtons":
                    child.value = 4
                elif type(child).__name__ == "HBox":
                    child.children[1].value = 40
            box.children[-1].click()
    assert seen == ["consent", *(["task"] * 4 + ["tlx", "sus"]) * 2]
    assert {row.seconds for row in study.read_rows(someone.study.file) if row.kind == "task"} == {5.0}
    assert "Thank you!" in box.children[0].value
