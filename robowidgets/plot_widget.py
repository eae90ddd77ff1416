"""The plot widget: any numbers over time, with the values at a moment."""

from __future__ import annotations

import os
import threading
import time as clock
from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from math import inf, isfinite, nan
from numbers import Real
from pathlib import Path
from typing import Any, ClassVar

import traitlets
from numpy.typing import ArrayLike

from .kinds import is_command
from .messages.units import unit_of
from .plots.card import PlotCard
from .plots.frame import Lines, ends, pack
from .plots.line import GrowingLine, checked
from .runtime.error_routing import called_from_cell
from .runtime.output_file import checked_output
from .runtime.text import many
from .samples.checks import finite
from .widget.base_widget import refuse_unnamed
from .widget.front_end import bundle
from .widget.pacer import pacer
from .widget.png import Png, Saving
from .widget.robot_widget import PAGES
from .widget.time_traits import Marks, States, TimeSpan
from .widget.traits import Flag, bytes_trait

MOST_LINES = 8

COLUMNS = 1000
"""Columns of pixels of a whole plot. A part in view has as many as the page requests."""

_MOST_COLUMNS = 4000
_EXACT = 4 * COLUMNS
"""The most values of a line that are all sent."""

_OVERVIEW = 1.0
"""The shortest time in seconds between two sends of all of a long, live plot. The part in view is sent with each."""

_SHARE = 20.0
"""The pause between two sends of a long, live plot, as a multiple of the time that a send takes."""

_FIELD = '"/odom.twist.twist.linear.x"'
_BY_NAME = 'update(v=0.3, time=1.2), or update({"/odom.v": 0.3}, time=1.2)'


class PlotWidget(PlotCard):
    """Numbers over time: up to eight lines, in a graph for each unit, on one time axis.

    The widget shows lines in ink with different dashes. Next to them it shows the value at the pointer or the
    time cursor, with its time, and the minimum, the mean and the maximum of the span on show. A value is never
    interpolated: it is the last one up to that time. NaN and infinities are gaps, and so is a long time without values.
    Dragging selects a span to show, the wheel zooms, space freezes. All this works without the kernel, but finer detail
    comes when it is free: of many values, the page has the first, last, least and greatest of each column of pixels.

    Args:
        *fields: up to eight fields of topics, such as ``"/odom.twist.twist.linear.x"``, whose numbers `update` takes
            from messages of `Feed.connect`. Their units follow from their names.
        title: title in the header.
        units: units of lines by name, such as "m/s". Lines of one unit share a graph.
        view: the span on show, (start, end) in seconds; by default all, or the last `window` of live values. The view
            writes it, too.
        window: seconds on show while values come, or None for all. The view writes it, too.
        time: the time cursor in seconds, or None. The view writes it, too.
        marks: marks behind the lines, (start, end, text) in seconds, or the result of `Recording.find`.
        states: rows of (start, end, path), the states of a program below the lines, outer machines first. A path looks
            like "Walker.avoid.turn".
        steps: names of lines that hold each value until the next, such as commands. They are drawn as steps, and
            include fields of topics with names of commands.
        off: names of lines that are not drawn. The view writes it, too.
        ghosts: names of lines that are drawn in gray, for comparison.
        shift: seconds by which ghosts are moved. The view writes it, too.
        x_over_y: names of two lines, to draw one over the other instead of over time. The view writes it, too.
        paused: True while the picture is frozen. Values are still taken.
        header, footer: False to hide them.

    Raises:
        TypeError: an unknown keyword.
        traitlets.TraitError: a value out of its range.

    Examples:
        >>> plot = PlotWidget(title="run", units={"set": "m/s", "measured": "m/s"})
        >>> plot.set_line("set", [0.0, 1.0, 2.0], [0.2, 0.2, 0.0])
        >>> for i in range(20):
        ...     plot.update(measured=0.01 * i, time=0.1 * i)
        >>> plot.names
        ('set', 'measured')
    """

    _esm, _css = bundle("plot_widget")
    _meant: ClassVar = {"freeze": "paused", "frozen": "paused", "unit": "units", "span": "view", "bands": "marks"}
    _instead: ClassVar = {
        "add": "plot.set_line(name, seconds, values)",
        "append": "plot.update(v=0.3)",
        "lines": "plot.names",
    }

    fields: tuple[str, ...] = ()
    """The fields of topics whose numbers it takes from messages."""

    _unnamed = 1000
    send_interval = 0.05

    units = traitlets.Dict(
        key_trait=traitlets.Unicode(), value_trait=traitlets.Unicode(), help="Units of lines by name."
    ).tag(sync=True)
    view = TimeSpan(help="Seconds on show; by default all, or the newest live ones. Python and the view write it.").tag(
        sync=True
    )
    window = traitlets.Float(
        30.0,
        allow_none=True,
        help="Seconds on show while values come, above 0, or None for all. The view writes it, too.",
    ).tag(sync=True)
    time = traitlets.Float(None, allow_none=True, help="The time cursor in seconds. The view writes it too.").tag(
        sync=True
    )
    marks = Marks(help="Marks behind the lines: (start, end, text), in seconds.").tag(sync=True)
    states = States(help="Rows of states below the lines, outer machines first: (start, end, path), in seconds.").tag(
        sync=True
    )
    steps = traitlets.List(traitlets.Unicode(), help="Names of lines that hold each value until the next.").tag(
        sync=True
    )
    off = traitlets.List(traitlets.Unicode(), help="Names of lines that are not drawn; the view writes it too.").tag(
        sync=True
    )
    ghosts = traitlets.List(traitlets.Unicode(), help="Names of lines that are drawn in gray.").tag(sync=True)
    shift = traitlets.Float(0.0, help="Seconds by which ghosts are moved; the view writes it too.").tag(sync=True)
    x_over_y = traitlets.Tuple(
        traitlets.Unicode(),
        traitlets.Unicode(),
        default_value=None,
        allow_none=True,
        help="Two lines, to draw the second over the first, or None for all over time. The view writes it, too.",
    ).tag(sync=True)
    paused = Flag(False, help="True while the picture is frozen. Python and the view write it.").tag(sync=True)
    footer = Flag(True, help="True to show facts below the picture.").tag(sync=True)

    _frozen_at = traitlets.Float(None, allow_none=True, help="The last time on show while frozen.").tag(sync=True)
    _lines = bytes_trait(echo_update=False)
    _detail = bytes_trait(echo_update=False)
    _facts = traitlets.Dict().tag(sync=True, echo_update=False)
    _choices = traitlets.List(traitlets.Unicode(), help="Fields that can become lines.").tag(
        sync=True, echo_update=False
    )
    _wanted = traitlets.List(traitlets.Float(), help="Start, end and columns of the part that the page shows.").tag(
        sync=True, echo_update=False
    )

    def __init__(self, *fields: str, **kwargs: Any) -> None:
        self._add_line: Callable[[str], object] | None = None
        self._by_name: dict[str, GrowingLine] = {}
        self._lock = threading.Lock()
        self._send_lock = threading.RLock()
        self._began: float | None = None
        self._is_live = self._is_new = False
        self._edition = 0
        self._due = self._detail_due = 0.0
        """The times of the next sends of all of a long plot, and of the part in view."""
        self._error = self._png_error = ""
        self._refused: set[Any] = set()
        """The names of the lines that the error is about."""
        self._png = Png(self, self._set_png_error)
        for name in fields:
            if not isinstance(name, str) or "." not in name.strip("."):
                raise TypeError(f"PlotWidget(): expected a topic with a field, as {_FIELD}, got {name!r}")
        self.fields = tuple(dict.fromkeys(fields))
        units = {name: unit for name in fields if (unit := unit_of("", name))}
        kwargs = {"steps": list(filter(is_command, fields)), **kwargs, "units": units | kwargs.get("units", {})}
        super().__init__(**kwargs)
        self._room_for(fields)
        self.on_msg(self._on_page)

    def set_line(self, name: str, seconds: ArrayLike, values: ArrayLike) -> None:
        """Show an array as a line, which replaces a line of the same name.

        Args:
            name: the name of the line. `units` has its unit.
            seconds: times of N values in order, from 0 on.
            values: N numbers or flags; NaN, infinities and masked values are gaps.

        Raises:
            TypeError: not numbers. ValueError: shapes that do not fit, times that go back, or more than eight lines.
        """
        line = GrowingLine(*checked(_name(name), seconds, values))
        with self._lock:
            self._room_for((name,))
            self._by_name[name] = line
            self._edition += 1
            self._is_new = True
        pacer.mark(self)

    def update(
        self, values: Mapping[str, float] | str | None = None, *unnamed: Any, time: float | None = None, **named: float
    ) -> None:
        """Add a value to each of some lines, all at one time.

        It only stores the values, and may be called from any thread at any rate.

        Args:
            values: numbers or flags by the names of lines; NaN and infinities are gaps. Or the name of a topic,
                followed by one of its messages, to add its `fields`.
            *unnamed: a message; else raises an error with the call that takes numbers by name.
            time: seconds, not before the last value of these lines; by default the time since the first value.
            **named: instead, numbers by the names of their lines.

        Raises:
            TypeError: not a number. ValueError: a time before the last one, or more than eight lines. Then nothing is
                added. A callback (another thread; a task, timer or button of a notebook) raises nothing; the widget and
                the log show the error.
        """
        own: Iterable[str] = ()
        try:
            if isinstance(values, str) and len(unnamed) == 1:
                own = [name for name in self.fields if name.startswith(f"{values}.")]
                if unnamed[0] is not None and own and self.comm is not None:
                    self._add(self._numbers_in(values, unnamed[0], own), time)
                return
            refuse_unnamed("update", unnamed, _BY_NAME)
            own = {**(values if isinstance(values, Mapping) else {}), **named}
            self._add({**_mapping(values), **named}, time)
        except (TypeError, ValueError) as error:
            self.refuse(error, own)

    def refuse(self, error: Exception, names: Iterable[Any] = ()) -> None:
        """Show why a value could not be shown, until one of these lines, or any line without names, gets another value.

        In a cell the error is raised, in a callback it is logged.
        """
        with self._lock:
            self._error, self._refused = f"{error}.", set(names)
        pacer.mark(self)
        if called_from_cell():
            raise error from None
        self._log_once(f"a value could not be shown: {error}")

    def clear(self, *names: str) -> None:
        """Remove lines by their names, or all of them.

        Raises:
            KeyError: no line has that name.
        """
        with self._lock:
            for name in names or tuple(self._by_name):
                if name not in self._by_name:
                    raise KeyError(f"clear({name!r}): the lines are {', '.join(self._by_name) or 'none'}")
                del self._by_name[name]
            self._edition += 1
            self._is_new = True
            if not self._by_name:
                self._began, self._is_live = None, False
                self._error, self._refused = "", set()
        pacer.mark(self)

    def offer(self, fields: Iterable[str], add: Callable[[str], object]) -> None:
        """Offer fields on the page that the user can add as lines.

        Args:
            fields: names of fields that can become lines.
            add: called with the chosen name; its errors are shown.
        """
        self._add_line, self._choices = add, list(fields)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the lines, in the order in which they came."""
        with self._lock:
            return tuple(self._by_name)

    def __getitem__(self, name: str) -> Any:
        """Return the times and the values of a line: arrays of shape (N,), float64."""
        with self._lock:
            line = self._by_name[name]
            return line.times.copy(), line.values.copy()

    def save_png(self, path: str | os.PathLike[str]) -> Saving:
        """Save the picture of the widget as a PNG file; see `LaserWidget.save_png`."""
        return self._png.save(path)

    def to_html(self, path: str | os.PathLike[str], *, title: str = "", note: str = "") -> Path:
        """Write a page with the plot, to zoom and to read without a kernel or a network; see `LaserWidget.to_html`.

        For a line of more than 16,000 values, the page has the first, last, least and greatest of each of 4,000
        columns.
        """
        target = checked_output("to_html", path, (".html", ".htm"))
        with self._send_lock:
            self._is_new, self._due, self._detail_due = True, 0.0, 0.0
            self._compose(columns=_MOST_COLUMNS)
            written: Path = import_module(PAGES).write(self, target, title, note)
            self._is_new = True
        return written

    def close(self) -> None:
        """Remove the widget from the page."""
        with self._send_lock:
            super().close()
            pacer.forget(self)

    # -- called by the pacer and the host ------------------------------------------------------------------------------

    def send_newest(self) -> int:
        """Send new values to the page, and return the number of bytes. The pacer calls this."""
        with self._send_lock:
            if self.comm is None:
                return 0
            names = self._compose()
            if names:
                super().send_state(names)
            return sum(len(self._trait_values[name]) for name in names if name != "_facts")

    def get_state(self, key: str | Iterable[str] | None = None, drop_defaults: bool = False) -> dict[str, Any]:
        """Return the synced traits with the newest values, for a new view, a reload and a saved notebook."""
        if key is None:
            with self._send_lock:
                self._due = self._detail_due = 0.0
                self._compose()
        state: dict[str, Any] = super().get_state(key, drop_defaults)
        return state

    def _compose(self, columns: int = COLUMNS) -> list[str]:
        """Update the traits for the page without sending them, and return the names of changed ones."""
        now = clock.monotonic()
        with self._lock:
            lines: Lines = [
                (line.times + self.shift if name in self.ghosts else line.times, line.values)
                for name, line in self._by_name.items()
            ]
            is_long = any(len(times) > _EXACT for times, _ in lines)
            is_new, is_due = self._is_new, not is_long or now >= self._due
            self._is_new = is_new and not is_due  # before the frame is made, because another value may come meanwhile
            edition = self._edition
            error = self._png_error or self._error or self._status
            missed = f"{many(self._missed, 'message')} did not come" if self._missed else ""
            facts = {"names": list(self._by_name), "live": self._is_live, "error": error, "missed": missed}
        values: dict[str, Any] = {"_facts": facts}
        first, last = ends(lines)
        if is_new and is_due:
            values["_lines"] = pack(edition, lines, (first, last), columns)
            if is_long:
                self._due = clock.monotonic() + max(_OVERVIEW, _SHARE * (clock.monotonic() - now))
        span, columns = self._looked_at(first, last)
        again = [self._due] if is_new and not is_due else []
        if not (is_long and span):
            values["_detail"] = b""
        elif now >= self._detail_due:
            began = clock.monotonic()
            values["_detail"] = pack(edition, lines, span, columns)
            self._detail_due = clock.monotonic() + _SHARE * (clock.monotonic() - began)
        else:
            again.append(self._detail_due)
        if again:
            pacer.mark_at(self, min(again))
        changed = [name for name, value in values.items() if self._trait_values.get(name) != value]
        for name in changed:
            self._trait_values[name] = values[name]
        return changed

    def _looked_at(self, first: float, last: float) -> tuple[tuple[float, float] | None, int]:
        """Return the span to send in detail, or None if all of the plot is on show, and the number of columns."""
        wanted = self._wanted
        if len(wanted) == 3 and all(map(isfinite, wanted)) and wanted[0] < wanted[1]:
            return (wanted[0], wanted[1]), int(min(max(1, wanted[2]), _MOST_COLUMNS))
        if not self._is_live or self.paused or self.view is not None or self.window is None:
            return None, COLUMNS
        return (max(first, last - self.window), last), COLUMNS

    # -- inner ---------------------------------------------------------------------------------------------------------

    def _add(self, values: Mapping[str, float], time: float | None) -> None:
        if not values:
            raise TypeError(f"update() needs numbers by name: {_BY_NAME}")
        numbers = {_name(name): _number(name, value) for name, value in values.items()}
        now = clock.monotonic()
        given = None if time is None else finite("time", time, "seconds")
        if given is not None and given < 0:
            raise ValueError(f"time: expected seconds from 0 on, got {time!r}")
        with self._lock:
            self._room_for(numbers)
            if self._began is None:
                self._began = now
            seconds = now - self._began if given is None else given
            for name in numbers:
                times = self._by_name.get(name, GrowingLine()).times
                if times.size and times[-1] > seconds:
                    raise ValueError(
                        f"time: {seconds:g} s is before the last value of {name!r}, at {times[-1]:g} s; "
                        "clear() starts again"
                    )
            for name, number in numbers.items():
                self._by_name.setdefault(name, GrowingLine()).append(seconds, number)
            self._is_live = self._is_new = True
            if not self._refused or self._refused & numbers.keys():
                self._error, self._refused = "", set()
        pacer.mark(self)

    def _room_for(self, names: Iterable[str]) -> None:
        count = len({*self._by_name, *names})
        if count > MOST_LINES:
            raise ValueError(f"expected at most {MOST_LINES} lines, got {count}; clear(name) removes one")

    def _set_png_error(self, error: str) -> None:
        self._png_error = error
        pacer.mark(self)

    def _summary(self) -> str:
        with self._lock:
            counts = [f"{name} ({len(line.times):,})" for name, line in self._by_name.items()]
        return ", ".join(counts) or "nothing yet"

    def _on_page(self, _widget: Any, content: dict[str, Any], _buffers: Any) -> None:
        """Add or remove a line at the request of the user."""
        if (name := content.get("take_out")) in self.names:
            self.clear(name)
        elif (name := content.get("add")) and self._add_line is not None and name not in self.names:
            try:
                self._add_line(str(name))
            except Exception as error:  # the source of the line may raise anything for a typed name
                self.refuse(error)

    @traitlets.observe("ghosts", "shift")
    def _on_ghosts(self, _change: Any) -> None:
        with self._lock:
            self._edition += 1
            self._is_new = True
        pacer.mark(self)

    @traitlets.observe("_wanted", "view", "window")
    def _on_look(self, _change: Any) -> None:
        self._detail_due = 0.0
        pacer.mark(self)

    @traitlets.observe("paused")
    def _on_paused(self, _change: Any) -> None:
        if not self.paused:
            self._frozen_at = None
        elif self._frozen_at is None:  # else the page has frozen it, at its time on show
            with self._lock:
                self._frozen_at = ends([(line.times, line.values) for line in self._by_name.values()])[1]

    @traitlets.validate("window")
    def _is_span(self, proposal: Any) -> Any:
        value = proposal["value"]
        if value is not None and not 0 < value < inf:
            raise traitlets.TraitError(f"window: expected seconds above 0, or None for all, got {value!r}")
        return value

    @traitlets.validate("time")
    def _is_time(self, proposal: Any) -> Any:
        value = proposal["value"]
        if value is not None and not isfinite(value):
            raise traitlets.TraitError(f"time: expected seconds, or None for no cursor, got {value!r}")
        return value


def _name(name: Any) -> str:
    if not isinstance(name, str) or not name:
        raise TypeError(f"expected the name of a line, got {name!r}")
    return name


def _mapping(values: Any) -> Mapping[str, float]:
    if values is None:
        return {}
    if not isinstance(values, Mapping):
        raise TypeError(f"update() takes numbers by name: {_BY_NAME}; got {values!r}")
    return values


def _number(name: str, value: Any) -> float:
    """Return the number as a float, or NaN if it is not finite or None."""
    if value is None:
        return nan
    if not isinstance(value, Real) and not (hasattr(value, "dtype") and getattr(value, "shape", None) == ()):
        raise TypeError(f"{name}: expected a number, got {value!r}")
    number = float(value)
    return number if isfinite(number) else nan
