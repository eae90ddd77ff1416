"""Drawing of named shapes on a widget."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Mapping, Sequence
from math import isfinite
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar

from ..runtime.error_routing import called_from_cell
from ..runtime.user_function import error_in
from ..samples.checks import number
from ..widget.pacer import pacer
from ..widget.robot_widget import RobotWidget
from .forms import MOST_PLACES, Shape, short_text

MOST_NAMES = 100

COLORS = (
    "black",
    "blue",
    "brown",
    "cyan",
    "gray",
    "green",
    "magenta",
    "orange",
    "pink",
    "purple",
    "red",
    "teal",
    "white",
)
"""Names of colours."""

_HEX = re.compile(r"#(?:[0-9a-fA-F]{3}){1,2}")

Drawable = Shape | Sequence[Shape]
Drawer = Callable[[Any], "Drawable | None"]


S = TypeVar("S")


class Drawn(NamedTuple):
    """The drawing under a name."""

    shapes: tuple[Shape, ...]
    """Empty if a function makes them."""
    function: Drawer | None
    color: str | None
    ends: float | None
    """Time of the monotonic clock at which it is removed, or None."""

    @property
    def places(self) -> int:
        """The number of places of its shapes."""
        return sum(len(shape.form["at"]) for shape in self.shapes)

    def forms(self, name: str, shapes: tuple[Shape, ...], now: float) -> list[dict[str, Any]]:
        """Return the shapes for the page, with the seconds that are left."""
        left = {} if self.ends is None else {"left": self.ends - now}
        color = {"color": self.color} if self.color else {}
        return [{"name": name, **shape.form, **color, **left} for shape in shapes]


class DrawsShapes(RobotWidget[S]):
    """A widget that a program draws on, of scans or of a map."""

    def __init__(self, **kwargs: Any) -> None:
        self._drawn: dict[str, Drawn] = {}
        self._places = 0
        self._expiry = _Expiry(self._drop_expired)
        super().__init__(**kwargs)

    def draw(
        self,
        name: str,
        shape: Drawable | Drawer | None,
        *,
        color: str | None = None,
        lifetime: float | None = None,
    ) -> None:
        """Draw a shape over the readings under a name; it replaces the drawing with this name.

        This only stores the shape, and may be called from any thread at any rate: the page gets the newest shapes with
        the newest scan. Freezing, stepping back, saving and taking a picture keep shapes with their scan.

        Args:
            name: 1 to 60 characters, shown next to the shape.
            shape: a shape, several shapes, or None to remove the drawing with this name. On a widget in a player also a
                function that is called with each scan of the recording, in another thread, and returns any of these.
            color: a colour like "#12854a" or "green", or None for the default of drawings.
            lifetime: seconds after which the shape is removed, unless it is drawn again, or None to keep it.

        Raises:
            TypeError: the shape is not a shape, or a value is not text or a number.
            ValueError: the name, the colour or the lifetime is invalid, or there are too many shapes. In a callback
                (another thread; a task, timer or button of a notebook) nothing is raised; the widget and the log show
                the error.

        Examples:
            >>> from robowidgets import LaserWidget, Line
            >>> laser = LaserWidget()
            >>> laser.draw("wall", Line((1, -1), (1, 1)), lifetime=0.5)
        """
        try:
            drawn = self._to_draw(name, shape, color, lifetime)
            with self._newest.lock:
                self._keep(name, drawn)
        except (TypeError, ValueError) as error:
            if called_from_cell():
                raise
            self._refuse(error)
            return
        self._renew_frames()
        self._mark()

    @property
    def drawn(self) -> Mapping[str, Any]:
        """The current drawings by name: a tuple of shapes, or a function."""
        with self._newest.lock:
            self._drop(time.monotonic())
            return MappingProxyType({name: one.function or one.shapes for name, one in self._drawn.items()})

    def forms(self) -> list[dict[str, Any]]:
        """Return the current drawings for the page, without the seconds that are left."""
        with self._newest.lock:
            forms = self._forms(time.monotonic())
        return [{key: value for key, value in form.items() if key != "left"} for form in forms]

    # -- for the base --------------------------------------------------------------------------------------------------

    def _texts_now(self) -> dict[str, Any]:
        """Return the shapes, as texts on the newest sample. Called with the lock of the samples."""
        forms = self._forms(time.monotonic())
        return {"shapes": forms} if forms else {}

    def _drawn_on(self, scan: Any) -> dict[str, Any]:
        """Return the texts on a scan of a recording: the shapes, and the errors of functions that make shapes."""
        forms: list[dict[str, Any]] = []
        notes: list[str] = []
        with self._newest.lock:
            now = time.monotonic()
            self._drop(now)
            drawn = dict(self._drawn)
        for name, one in drawn.items():
            shapes = one.shapes
            if one.function is not None and len(scan):
                try:
                    shapes = _shapes(name, one.function(scan))
                except Exception as error:
                    notes.append(f"{name}: {error_in(error)}")
                    continue
            forms += one.forms(name, shapes, now)
        return {**({"shapes": forms} if forms else {}), **({"notes": notes} if notes else {})}

    def _to_draw(self, name: Any, shape: Any, color: Any, lifetime: Any) -> Drawn | None:
        short_text("name", name)
        if shape is None:
            return None
        function = shape if callable(shape) else None
        if function is not None and not self.driven_by_player:
            raise TypeError(
                f"draw({name!r}): a function of a scan is for widgets in the player of a recording; "
                "here draw the shape again for each scan"
            )
        if color is not None and not (isinstance(color, str) and (_HEX.fullmatch(color) or color in COLORS)):
            raise ValueError(f'color: expected one like "#12854a", or one of {", ".join(COLORS)}; got {color!r}')
        ends = None
        if lifetime is not None:
            seconds = number("lifetime", lifetime)
            if not (isfinite(seconds) and seconds > 0):
                raise ValueError(f"lifetime: expected seconds above 0, or None to stay, got {lifetime!r}")
            ends = time.monotonic() + seconds
        return Drawn(() if function else _shapes(name, shape), function, color, ends)

    def _keep(self, name: str, drawn: Drawn | None) -> None:
        """Store a drawing under its name, or remove the name for None."""
        before = self._drawn.get(name)
        if drawn is not None:
            if before is None and len(self._drawn) >= MOST_NAMES:
                raise ValueError(f"draw({name!r}): expected at most {MOST_NAMES} names; draw(name, None) removes one")
            places = self._places + drawn.places - (before.places if before else 0)
            if places > MOST_PLACES:
                raise ValueError(
                    f"draw({name!r}): expected at most {MOST_PLACES:,} places in all shapes, got {places:,}"
                )
            self._drawn[name], self._places = drawn, places
        elif before is not None:
            self._forget(name)
        self._newest.changed = True
        if (drawn and drawn.ends) or (before and before.ends):
            self._expiry.plan(one.ends for one in self._drawn.values())

    def _forms(self, now: float) -> list[dict[str, Any]]:
        self._drop(now)
        return [form for name, one in self._drawn.items() for form in one.forms(name, one.shapes, now)]

    def _drop(self, now: float) -> None:
        """Remove shapes whose lifetime is over."""
        for name in [name for name, one in self._drawn.items() if one.ends is not None and one.ends <= now]:
            self._forget(name)
            self._newest.changed = True

    def _drop_expired(self) -> None:
        """Remove the shapes whose lifetime is over, and send the widget without them."""
        with self._newest.lock:
            self._drop(time.monotonic())
            self._expiry.plan(one.ends for one in self._drawn.values())
        pacer.mark(self)

    def _forget(self, name: str) -> None:
        self._places -= self._drawn.pop(name).places

    def close(self) -> None:
        """Remove the widget from the page."""
        super().close()
        pacer.forget(self._expiry)


class _Expiry:
    """Calls a function when the lifetime of the next shape is over."""

    def __init__(self, drop: Callable[[], None]) -> None:
        self._drop = drop

    def plan(self, ends: Any) -> None:
        pacer.mark_at(self, min((end for end in ends if end is not None), default=None))

    def send_newest(self) -> int:
        """Drop expired shapes; called by the pacer."""
        self._drop()
        return 0


def _shapes(name: str, given: Any) -> tuple[Shape, ...]:
    """Return the shapes in a shape, a sequence of shapes, or None."""
    if given is None:
        return ()
    shapes = (given,) if isinstance(given, Shape) else given
    if (
        isinstance(shapes, (str, bytes))
        or not isinstance(shapes, Sequence)
        or not all(isinstance(s, Shape) for s in shapes)
    ):
        raise TypeError(
            f"draw({name!r}): expected a Line, Points, Polygon, Arc, Arrow or Text, several of them, "
            f"or None to remove it; got {given!r}"
        )
    return tuple(shapes)
