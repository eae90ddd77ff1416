"""The shapes that a program can draw, checked when they are created."""

from __future__ import annotations

import reprlib
from collections.abc import Iterable
from math import hypot, isfinite
from numbers import Real
from typing import Any, ClassVar

import numpy as np

from ..samples import Ray
from ..samples.checks import finite, in_radians
from ..samples.scan import MAX_RAYS

FARTHEST = 100_000.0
"""The largest distance of a shape in metres."""

MOST_PLACES = 2000
"""The most places of one shape, and of all shapes of a widget."""

LONGEST_TEXT = 60
"""The most characters of a text or a name."""


class Shape:
    """A shape around the scanner: x forward and y to the left in metres, angles counter-clockwise (REP-103).

    Shapes are immutable, and equal if they look the same.
    """

    kind: ClassVar[str] = ""
    _form: dict[str, Any]

    def _set(self, **form: Any) -> None:
        object.__setattr__(self, "_form", {"kind": self.kind, **form})

    @property
    def form(self) -> dict[str, Any]:
        """The shape as plain values for the page: see `Shape` in js/shared/traits.ts."""
        return self._form

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"a {type(self).__name__} does not change; draw another one under the same name")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Shape) and self._form == other._form

    def __hash__(self) -> int:
        return hash(repr(self._form))

    def __repr__(self) -> str:
        given = ", ".join(f"{name}={reprlib.repr(value)}" for name, value in self._form.items() if name != "kind")
        return f"{type(self).__name__}({given})"


class Line(Shape):
    """A line through two or more places.

    Args:
        *places: each (x, y) in metres; a `Ray`; or the index of a ray, which stands for its reading in the scan on
            show. The line is not drawn while that ray has no reading. A single argument may be a sequence of places.

    Raises:
        TypeError: a value is not a place. ValueError: there are fewer than two places, or one is not finite.

    Examples:
        >>> wall = Line((1, -1), (1, 1))
        >>> gap = Line(240, 300)
    """

    kind = "line"

    def __init__(self, *places: Any) -> None:
        given = places[0] if len(places) == 1 and not _is_place(places[0]) else places
        self._set(at=_places("Line", given, least=2))


class Points(Shape):
    """Places, each marked with a ring.

    Args:
        places: a sequence of places as `Line` takes them, or an array of shape (N, 2).

    Examples:
        >>> corner = Points([(1.2, 0.4), (2.0, -0.3)])
        >>> cluster = Points(range(240, 300))
    """

    kind = "points"

    def __init__(self, places: Any) -> None:
        self._set(at=_places("Points", [places] if _is_place(places) else places, least=1))


class Polygon(Shape):
    """A closed outline through three or more places, given as to `Points`.

    Examples:
        >>> box = Polygon([(0.5, -0.5), (1.5, -0.5), (1.5, 0.5), (0.5, 0.5)])
    """

    kind = "polygon"

    def __init__(self, places: Any) -> None:
        self._set(at=_places("Polygon", places, least=3))


class Text(Shape):
    """A text at a place.

    Args:
        place: as `Line` takes it.
        text: 1 to 60 characters, plain text.

    Examples:
        >>> door = Text((2.0, 0.5), "door")
    """

    kind = "text"

    def __init__(self, place: Any, text: str) -> None:
        self._set(at=_places("Text", [place], least=1), text=short_text("Text.text", text))


class Arc(Shape):
    """A part of a circle, or the whole circle without angles.

    Args:
        radius: metres above 0.
        start, end: angles in radians or text like "20deg", from the first counter-clockwise to the second.
        center: a place, as `Line` takes it; the scanner by default.

    Examples:
        >>> stop_zone = Arc(0.4, "-60deg", "60deg")
    """

    kind = "arc"

    def __init__(
        self, radius: float, start: float | str = 0.0, end: float | str = "360deg", center: Any = (0.0, 0.0)
    ) -> None:
        metres = finite("Arc.radius", radius, "metres")
        if not 0 < metres <= FARTHEST:
            raise ValueError(f"Arc.radius: expected metres above 0, {FARTHEST:,.0f} at most, got {radius!r}")
        ends = {"start": in_radians("Arc.start", start), "end": in_radians("Arc.end", end)}
        self._set(at=_places("Arc", [center], least=1), radius=metres, **ends)


class Arrow(Shape):
    """An arrow: a place and a direction, for a target, for example.

    Args:
        place: as `Line` takes it.
        yaw: direction, radians or text like "20deg", counter-clockwise from forward.

    Examples:
        >>> target = Arrow((2.0, 0.5), "30deg")
    """

    kind = "arrow"

    def __init__(self, place: Any, yaw: float | str = 0.0) -> None:
        self._set(at=_places("Arrow", [place], least=1), yaw=in_radians("Arrow.yaw", yaw))


def short_text(name: str, text: Any) -> str:
    """Return a text of 1 to 60 characters; raise TypeError or ValueError for anything else."""
    if not isinstance(text, str):
        raise TypeError(f"{name}: expected text, got {text!r}")
    if not 0 < len(text.strip()) <= LONGEST_TEXT:
        raise ValueError(f"{name}: expected 1 to {LONGEST_TEXT} characters, got {reprlib.repr(text)}")
    return text


def _is_place(given: Any) -> bool:
    """Return True for one place, False for a sequence of places."""
    if isinstance(given, (Ray, Real)):
        return True
    return isinstance(given, tuple) and len(given) == 2 and all(isinstance(value, Real) for value in given)


def _places(shape: str, given: Any, least: int) -> list[Any]:
    """Return the places for the page: [x, y], or the index of a ray."""
    if isinstance(given, (str, bytes)) or not isinstance(given, Iterable):
        raise TypeError(f"{shape}: expected places, like (1.0, -0.5) in metres or the index of a ray; got {given!r}")
    places = [_place(shape, one) for one in given]
    if not least <= len(places) <= MOST_PLACES:
        raise ValueError(f"{shape}: expected {least} to {MOST_PLACES:,} places, got {len(places):,}")
    return places


def _place(shape: str, given: Any) -> Any:
    if isinstance(given, Ray):
        if given.x is None or given.y is None:
            raise ValueError(f"{shape}: ray {given.index} has no reading; leave it out, or draw it as an index")
        return [given.x, given.y]
    if isinstance(given, (int, np.integer)) and not isinstance(given, bool):
        if not 0 <= given < MAX_RAYS:
            raise ValueError(f"{shape}: expected the index of a ray, 0 or more, got {given}")
        return int(given)
    try:
        x, y = given
        metres = [float(x), float(y)]
    except (TypeError, ValueError):
        raise TypeError(
            f"{shape}: expected (x, y) in metres, a ray or the index of one; got {reprlib.repr(given)}"
        ) from None
    if not all(isfinite(value) for value in metres) or hypot(*metres) > FARTHEST:
        raise ValueError(f"{shape}: expected finite metres, at most {FARTHEST:,.0f} away; got {reprlib.repr(given)}")
    return metres
