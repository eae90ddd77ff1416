"""A study that measures whether the widgets help: tasks with and without them, times, right answers, TLX and SUS.

`Study` contains the steps and saves them; `Study.show` shows them on the page. See docs/teach.md.
"""

from __future__ import annotations

import csv
import math
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import datetime, timezone
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from robowidgets import LaserWidget, Scan, lessons
from robowidgets.simulator import Robot, World

CONSENT = """You solve eight short tasks with scans of a robot's laser: four with a picture that reacts to the pointer,
and four with a plain picture. After each four tasks you rate them. This takes about 40 minutes. We test the pictures,
not you.

We save a number instead of your name, the times, your answers to the tasks, and your ratings. You may stop at any time,
without a reason, and have your file deleted by its number. If you have questions, ask the person who invited you."""

WITH, WITHOUT = "with", "without"
LIMIT = 300.0
"""Seconds after which a task counts as not solved."""

ORDERS = (
    ((WITH, "A"), (WITHOUT, "B")),
    ((WITHOUT, "A"), (WITH, "B")),
    ((WITH, "B"), (WITHOUT, "A")),
    ((WITHOUT, "B"), (WITH, "A")),
)
"""The orders of the two forms and the two sets of tasks. Of four participants, each has a different order."""

TASKS = ("index", "distance", "gap", "code")
"""The four tasks of each form, by name."""

TLX = {
    "mental demand": ("How mentally demanding were the tasks?", "very low", "very high"),
    "physical demand": ("How physically demanding were the tasks?", "very low", "very high"),
    "temporal demand": ("How hurried or rushed was the pace of the tasks?", "very low", "very high"),
    "performance": ("How successful were you in accomplishing what you were asked to do?", "perfect", "failure"),
    "effort": ("How hard did you have to work to accomplish your level of performance?", "very low", "very high"),
    "frustration": ("How insecure, discouraged, irritated, stressed, and annoyed were you?", "very low", "very high"),
}
"""The six scales of the raw NASA-TLX, from 0 to 100."""

SUS = (
    "I think that I would like to use this system frequently.",
    "I found the system unnecessarily complex.",
    "I thought the system was easy to use.",
    "I think that I would need the support of a technical person to be able to use this system.",
    "I found the various functions in this system were well integrated.",
    "I thought there was too much inconsistency in this system.",
    "I would imagine that most people would learn to use this system very quickly.",
    "I found the system very cumbersome to use.",
    "I felt very confident using the system.",
    "I needed to learn a lot of things before I could get going with this system.",
)
"""The ten statements of the System Usability Scale, from 1, strongly disagree, to 5, strongly agree."""


@dataclass(frozen=True)
class Task:
    """A task: a question about a scan, and a function that returns what is wrong with an answer."""

    name: str
    question: str
    scan: Scan
    wrong: Callable[[str], str]
    is_code: bool = False
    given: str = ""


def tasks_of(which: str) -> list[Task]:
    """Return the four tasks of set A or B. The sets differ only in their scans and numbers."""
    is_a = which == "A"
    room = Robot(World.rooms(), (0.6, -0.2, 0.0) if is_a else (-3.0, -0.8, 0.3), seed=21 if is_a else 22).scan()
    side, angle = ("left", "-30deg") if is_a else ("right", "30deg")
    width, centre = (0.9, -0.2) if is_a else (0.7, 0.3)
    posts = [(1.0, -2.0, 1.0, centre - width / 2), (1.0, centre + width / 2, 1.0, 2.0), (3.0, -4.0, 3.0, 4.0)]
    gap = Robot(World(posts), seed=23).scan()
    nearest, ray = room.nearest(side), room.at(angle)
    if nearest is None or ray is None:
        raise RuntimeError(f"set {which}: the scan has nothing there")
    code = "wall_ahead" if is_a else "nearest_on_the_left"
    area = "within 20 degrees of forward" if is_a else "in the quarter of the circle on the left"
    return [
        Task("index", f"At which index of ranges is the nearest thing on the {side}?", room, within(nearest.index, 3)),
        Task(
            "distance",
            f"How far away, in metres, is the thing that the ray at {angle} meets?",
            room,
            within(ray.range, 0.05),
        ),
        Task("gap", "How many metres wide is the gap in the wall one metre ahead?", gap, within(width, 0.1)),
        Task(
            "code",
            f"Write a function that returns the distance in metres of the nearest thing {area}.",
            room,
            lambda text: code_wrong(code, text),
            is_code=True,
            given=f"def {code}(scan):\n    return ...",
        ),
    ]


def within(expected: float, tolerance: float) -> Callable[[str], str]:
    """Return a function that judges a number given as text."""

    def wrong(text: str) -> str:
        try:
            given = float(text.strip().replace(",", "."))
        except ValueError:
            return "Type a number, such as 1.5."
        return "" if math.isfinite(given) and abs(given - expected) <= tolerance else "Not yet."

    return wrong


def code_wrong(name: str, text: str) -> str:
    """Return the faults of a function in the words of the lessons' check, or an empty text."""
    names: dict[str, Any] = {}
    try:
        exec(compile(text, "<answer>", "exec"), names)  # not "<string>", which counts as code of a library
        result = lessons.check(names[name])
    except KeyError:
        return f"Keep the name {name}."
    except (Exception, SystemExit) as error:
        return f"{type(error).__name__}: {error}"
    return "" if result else repr(result)


@dataclass(frozen=True)
class Row:
    """One line of the file of a participant."""

    participant: int
    kind: str
    block: int = 0
    condition: str = ""
    tasks: str = ""
    item: str = ""
    started: str = ""
    ended: str = ""
    seconds: float = 0.0
    tries: int = 0
    value: str = ""
    right: bool = True


Step = tuple[str, int, str, str, Any]


class Study:
    """The steps of one participant, each written to ``P07.csv`` as soon as it is done.

    An existing file is continued after its last step.

    Args:
        participant: a number from 1, which determines the order.
        folder: the folder for the file.
        clock: returns seconds from any start.
        now: returns the time of day.

    Raises:
        ValueError: not a number from 1 to 9999, or the file is damaged.
    """

    def __init__(
        self,
        participant: int,
        folder: str | Path = ".",
        *,
        clock: Callable[[], float] = time.monotonic,
        now: Callable[[], datetime] = lambda: datetime.now(timezone.utc),
    ) -> None:
        if not isinstance(participant, int) or not 1 <= participant <= 9999:
            raise ValueError(f"participant: expected a number from 1 to 9999, got {participant!r}")
        self.participant = participant
        self.file = Path(folder) / f"P{participant:02}.csv"
        self._clock, self._now = clock, now
        steps: list[Step] = [("consent", 0, "", "", None)]
        for block, (condition, which) in enumerate(ORDERS[(participant - 1) % len(ORDERS)], 1):
            steps += [("task", block, condition, which, task) for task in tasks_of(which)]
            steps += [("tlx", block, condition, which, None), ("sus", block, condition, which, None)]
        rows = read_rows(self.file) if self.file.exists() else []
        self._steps = steps[_done(rows) :]
        self._shown: Task | None = None
        self._begin()
        self._go_on(rows)

    @property
    def step(self) -> Step | None:
        """The present step: kind, block, condition, set and task; None at the end."""
        return self._steps[0] if self._steps else None

    @property
    def scan(self) -> PlainScan | None:
        """The numbers of the scan of the task, for other cells. They are the same in both forms."""
        task = self.step[4] if self.step else None
        return PlainScan(task.scan) if task else None

    def agree(self) -> None:
        """Record the consent of the participant."""
        self._end("consent", [("", "yes")])

    def answer(self, text: str) -> str:
        """Answer the task. Return what is wrong, or an empty text if it is right or the time is over."""
        if self.step is None or self.step[0] != "task":
            raise ValueError("answer: the present step is not a task")
        step = self.step
        self._tries += 1
        self._write("try", [(step[4].name, text)], right=False)
        late = self._clock() - self._since > LIMIT
        wrong = str(step[4].wrong(text))
        if self.step is not step:  # the participant gave up while the answer was judged
            return ""
        if not wrong or late:
            self._end("task", [(step[4].name, text)], right=not late)
            return ""
        return wrong

    def give_up(self) -> None:
        """Leave the task unsolved."""
        task = self.step[4] if self.step else None
        self._end("task", [(task.name if task else "", "")], right=False)

    def rate(self, values: Mapping[str, float]) -> None:
        """Rate the last four tasks: all scales of TLX, or all statements of SUS by their number from 1."""
        kind = self.step[0] if self.step else ""
        wanted = {"tlx": list(TLX), "sus": [str(number) for number in range(1, len(SUS) + 1)]}.get(kind, [])
        if not wanted or set(values) != set(wanted):
            raise ValueError(f"rate: expected a value for each of {wanted}, got {dict(values)}")
        self._end(kind, [(item, f"{values[item]:g}") for item in wanted])

    def _go_on(self, rows: Sequence[Row]) -> None:
        """Continue the time and the tries of a task that was shown before the page was closed or reloaded."""
        if self.step is None or self.step[0] != "task":
            return
        of_task = [row for row in rows if (row.block, row.item) == (self.step[1], self.step[4].name)]
        shown = next((row for row in of_task if row.kind == "shown"), None)
        if shown is not None:
            self._shown, self._began = self.step[4], datetime.fromisoformat(shown.started)
            self._since = self._clock() - max(0.0, (self._now() - self._began).total_seconds())
            self._tries = sum(row.kind == "try" for row in of_task)

    def _begin(self) -> None:
        self._since, self._began, self._tries = self._clock(), self._now(), 0

    def _end(self, kind: str, items: list[tuple[str, str]], right: bool = True) -> None:
        if self.step is None or self.step[0] != kind:
            raise ValueError(f"the present step is not {kind!r}")
        self._write(kind, items, right)
        self._steps.pop(0)
        self._begin()

    def _write(self, kind: str, items: list[tuple[str, str]], right: bool = True) -> None:
        """Append rows to the file."""
        assert self.step is not None
        _, block, condition, which, _ = self.step
        seconds = self._clock() - self._since
        rows = [
            Row(
                self.participant,
                kind,
                block,
                condition,
                which,
                item,
                self._began.isoformat(timespec="milliseconds"),
                self._now().isoformat(timespec="milliseconds"),
                round(seconds if kind != "task" or right else LIMIT, 3),
                self._tries,
                value,
                right,
            )
            for item, value in items
        ]
        is_new = not self.file.exists()
        with self.file.open("a", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, list(Row.__dataclass_fields__))
            if is_new:
                writer.writeheader()
            writer.writerows(map(asdict, rows))

    # -- on the page ---------------------------------------------------------------------------------------------------

    def show(self) -> Any:
        """Return the study as a widget."""
        from ipywidgets import VBox

        box = VBox()
        self._draw(box)
        return box

    def _draw(self, box: Any) -> None:
        from ipywidgets import HTML, Button, HBox, IntSlider, Layout, RadioButtons, Text, Textarea

        def then(do: Callable[[], object]) -> Callable[[object], None]:
            def clicked(_button: object) -> None:
                do()
                self._draw(box)

            return clicked

        if self.step is None:
            box.children = [HTML(f"<h3>Thank you!</h3>Your answers are in {escape(self.file.name)}.")]
            return
        kind, block, condition, _, task = self.step
        next_button = Button(description="Next", button_style="primary")
        if kind == "consent":
            next_button.description = "I agree"
            next_button.on_click(then(self.agree))
            box.children = [HTML(f"<p>{CONSENT.replace(chr(10) * 2, '<p>')}"), next_button]
        elif kind == "task":
            head = HTML(f"<h3>Part {block} of 2: {escape(task.question)}</h3>")
            field = Textarea(task.given, layout=Layout(width="100%", height="7em")) if task.is_code else Text()
            reply = HTML()

            def judge() -> None:
                before = self.step
                try:
                    wrong = self.answer(field.value)
                except Exception as error:
                    wrong = f"{type(error).__name__}: {error}"
                if self.step is before:
                    reply.value = f"<pre>{escape(wrong)}</pre>"
                    next_button.disabled = False
                elif box.children[-1] is reply:
                    self._draw(box)

            def check(_button: object) -> None:
                next_button.disabled = True
                # In a thread, because a button's callback must not wait for the answer in a browser.
                threading.Thread(target=judge, name="study", daemon=True).start()

            next_button.description = "Check"
            next_button.on_click(check)
            leave = Button(description="I cannot solve it")
            leave.on_click(then(self.give_up))
            box.children = [head, picture(task.scan, condition), field, HBox([next_button, leave]), reply]
            if self._shown is not task:  # running the cell again does not reset the time
                self._shown = task
                self._begin()
                self._write("shown", [(task.name, "")])
        elif kind == "tlx":
            sliders = {name: IntSlider(50, 0, 100, 5, readout=False) for name in TLX}
            moved: set[str] = set()
            for name, slider in sliders.items():
                slider.observe(lambda _change, name=name: moved.add(name), "value")
            missing = HTML()

            def send_tlx(_button: object) -> None:
                left = [name for name in TLX if name not in moved]
                if left:
                    missing.value = f"Move each slider first, even if it belongs in the middle: {', '.join(left)}"
                else:
                    self.rate({name: slider.value for name, slider in sliders.items()})
                    self._draw(box)

            next_button.on_click(send_tlx)
            rows = [
                HTML(f"<b>{name.capitalize()}</b>: {escape(question)}") if part == 0
                else HBox([HTML(low), sliders[name], HTML(high)])
                for name, (question, low, high) in TLX.items()
                for part in (0, 1)
            ]  # fmt: skip
            box.children = [HTML(f"<h3>How were the tasks of part {block}?</h3>"), *rows, missing, next_button]
        else:
            missing = HTML()
            choices = [RadioButtons(options=[1, 2, 3, 4, 5], value=None, layout=Layout(width="auto")) for _ in SUS]
            for choice in choices:
                choice.add_class("rw-study-row")

            def send(_button: object) -> None:
                left = [str(number) for number, choice in enumerate(choices, 1) if choice.value is None]
                if left:
                    missing.value = f"Answer these, too: {', '.join(left)}"
                else:
                    self.rate({str(number): choice.value for number, choice in enumerate(choices, 1)})
                    self._draw(box)

            next_button.on_click(send)
            style = (
                "<style>.rw-study-row .widget-radio-box { flex-direction: row; gap: 1em }"
                ".rw-study-row label { flex: none; white-space: nowrap }</style>"
            )
            legend = HTML(
                f"{style}<h3>The pictures of part {block}</h3>1: strongly disagree, 5: strongly agree. Answer all."
            )
            rows = [
                part
                for number, (text, choice) in enumerate(zip(SUS, choices, strict=True), 1)
                for part in (HTML(f"{number}. {escape(text)}"), choice)
            ]
            box.children = [legend, *rows, missing, next_button]


def picture(scan: Scan, condition: str) -> Any:
    """Return a scan as the widget, or as other tools show it: a plain picture, and the array as text."""
    if condition == WITH:
        laser = LaserWidget(title="/scan", view_range=4)
        laser.update(scan)
        return laser
    from ipywidgets import HTML

    # Like RViz: a grid of 1 m, the axes of the scanner, and the place and the number of the point under the pointer.
    dots = "".join(
        f'<circle cx="{-y:.3f}" cy="{-x:.3f}" r=".025"><title>point {index}: x {x:.2f} m, y {y:.2f} m</title></circle>'
        for index, (x, y) in enumerate(_points(scan))
        if math.hypot(x, y) <= 4
    )
    lines = "".join(f'<path d="M-4 {at}H4M{at} -4V1"/>' for at in range(-4, 5) if at <= 1)
    lines += "".join(f'<path d="M{at} -4V1"/>' for at in (2, 3, 4))
    labels = "".join(f'<text x=".05" y="{-x - 0.05:.2f}">{x} m</text>' for x in (1, 2, 3))
    labels += "".join(f'<text x="{-y + 0.05:.2f}" y=".2">{y} m</text>' for y in (-3, -2, -1, 1, 2, 3))
    numbers = " ".join(f"{value:.3f}" for value in scan.ranges.tolist())
    return HTML(
        '<svg viewBox="-4 -4 8 5" style="width:100%;max-width:620px" fill="#c33">'
        f'<g stroke="currentColor" stroke-width=".01" opacity=".35">{lines}</g>'
        f'<g fill="currentColor" font-size=".2">{labels}</g>'
        '<path d="M0 0V-.5" stroke="#c00" stroke-width=".04"/><path d="M0 0H-.5" stroke="#080" stroke-width=".04"/>'
        f"{dots}</svg><div>x forward (red), y to the left (green); point at a dot for its place and its number</div>"
        f"<div>angle_min {scan.angle_min:.4f}, angle_increment {scan.angle_increment:.6f}, {len(scan)} ranges:</div>"
        f'<div style="max-height:9em;overflow:auto;font-family:monospace">[{numbers}]</div>'
    )


def _points(scan: Scan) -> list[tuple[float, float]]:
    """Return the place of each ray of a scan in order; not finite for a ray without a reading."""
    with np.errstate(invalid="ignore"):
        places = np.column_stack([scan.ranges * np.cos(scan.angles), scan.ranges * np.sin(scan.angles)])
    return [(x, y) for x, y in np.nan_to_num(places, nan=math.inf, posinf=math.inf, neginf=math.inf).tolist()]


class PlainScan:
    """The numbers of a scan as in a message, without methods or a text that would solve a task."""

    def __init__(self, scan: Scan) -> None:
        self.ranges = scan.ranges
        self.angle_min, self.angle_increment = scan.angle_min, scan.angle_increment
        self.range_min, self.range_max = scan.range_min, scan.range_max

    def __repr__(self) -> str:
        return (
            f"a scan of {len(self.ranges)} ranges in metres, from angle_min {self.angle_min:.4f} rad on, "
            f"by angle_increment {self.angle_increment:.6f} rad"
        )


def _done(rows: Sequence[Row]) -> int:
    """Return the number of steps that the rows of a file complete."""
    kinds = ("consent", "task", "tlx", "sus")
    return len({(row.kind, row.block, row.item if row.kind == "task" else "") for row in rows if row.kind in kinds})


def read_rows(file: Path) -> list[Row]:
    """Return the rows of a file.

    Raises:
        ValueError: it is not a file of this study, or it is damaged.
    """
    try:
        with file.open(encoding="utf-8", newline="") as opened:
            reader = csv.DictReader(opened)
            if reader.fieldnames != list(Row.__dataclass_fields__):
                raise ValueError("it has other columns")
            rows = []
            for row in reader:
                if None in row.values() or None in row or row["right"] not in ("True", "False"):
                    raise ValueError(f"line {reader.line_num} is cut off")
                numbers = {
                    "participant": int(row["participant"]),
                    "block": int(row["block"]),
                    "tries": int(row["tries"]),
                }
                seconds = float(row["seconds"])
                if not math.isfinite(seconds) or seconds < 0:
                    raise ValueError(f"line {reader.line_num} took {seconds} s")
                rows.append(Row(**{**row, **numbers, "seconds": seconds, "right": row["right"] == "True"}))
    except (ValueError, csv.Error) as error:
        raise ValueError(f"{file.name} is not a file of this study, or it is damaged: {error}") from None
    return rows
