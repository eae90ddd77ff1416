"""A laser widget on show: the pixels of its picture, and where the rays of a known scan stand in them."""

from __future__ import annotations

import base64
import io
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import cos, hypot, radians, sin
from typing import Any

import numpy as np
from PIL import Image
from playwright.sync_api import Locator, Page

SETUP = """
import numpy as np
from robowidgets import LaserWidget
inf, nan = float("inf"), float("nan")

def fan(changed={}, **more):
    '''19 rays from right (-90 degrees, 2 m) to left (+90 degrees, 3 m), those between at 1.52 to 1.84 m.'''
    ranges = np.array([2.0, *(1.5 + 0.02 * np.arange(1, 18)), 3.0])
    for index, value in changed.items():
        ranges[index] = value
    return {"ranges": ranges, "angle_min": -np.pi / 2, "angle_increment": np.pi / 18, "range_min": 0.6,
            "range_max": 4.0, "header": {"frame_id": "laser"}, **more}

laser = LaserWidget(title="/scan")
"""
FAN = [(metres, 10.0 * i - 90) for i, metres in enumerate([2.0, *(1.5 + 0.02 * i for i in range(1, 18)), 3.0])]
"""The same rays: metres and degrees."""

LIGHT = {"area": (237, 240, 242), "line": (211, 217, 224), "reading": (217, 45, 32), "ink": (27, 31, 36)}
DARK = {"area": (31, 37, 43), "line": (57, 66, 76), "reading": (255, 107, 94), "ink": (240, 243, 246)}
"""Colours of the picture, as the style sheet has them."""

DOT = 3
"""Pixels."""

SECONDS = 60
_TURNS = {"up": 90, "left": 180, "down": -90, "right": 0}
_READ = """(card) => {
    const layers = [...card.querySelectorAll(".rw-picture .rw-layer")];
    const { width, height } = layers[0].getBoundingClientRect();
    const background = getComputedStyle(card).backgroundColor;
    return { width, height, background, urls: layers.map((layer) => layer.toDataURL()) };
}"""
_LISTEN = """() => {
    const { prototype } = CanvasRenderingContext2D;
    const { fillText, clearRect } = prototype;
    prototype.fillText = function (text, ...place) {
        this.canvas.words = [...(this.canvas.words ?? []), text];
        this.canvas.places = [...(this.canvas.places ?? []), [text, place[0], place[1]]];
        fillText.call(this, text, ...place);
    };
    prototype.clearRect = function (...box) {
        this.canvas.words = this.canvas.places = [];
        clearRect.apply(this, box);
    };
}"""


def eventually(look: Callable[[], Any], expected: Any) -> None:
    """Look again until the expected value is seen."""
    deadline = time.monotonic() + SECONDS
    while (seen := look()) != expected and time.monotonic() < deadline:
        time.sleep(0.01)
    assert seen == expected, f"expected {expected!r}, saw {seen!r}"


def layers(card: Locator) -> list[str]:
    """Return the pixels of both canvases, to compare them."""
    urls: list[str] = card.evaluate(_READ)["urls"]
    return urls


def listen(page: Page) -> None:
    """From now on, keep the texts that canvases of a page draw, for `words`."""
    page.evaluate(_LISTEN)


def words(card: Locator) -> set[str]:
    """Return the texts in the picture now, since `listen`."""
    return set(card.evaluate("(card) => [...card.querySelectorAll('.rw-layer')].flatMap((layer) => layer.words)"))


def placed_words(card: Locator) -> list[tuple[str, float, float]]:
    """Return the texts in the picture now, since `listen`, each with the position that it is aligned to."""
    return card.evaluate("(card) => [...card.querySelectorAll('.rw-layer')].flatMap((layer) => layer.places ?? [])")  # type: ignore[no-any-return]


class Picture:
    """The pixels of a laser view at one moment. Places are in CSS pixels from its upper left corner."""

    def __init__(self, card: Locator) -> None:
        read = card.evaluate(_READ)
        self.width, self.height = read["width"], read["height"]
        base, self._top = (Image.open(io.BytesIO(base64.b64decode(url.partition(",")[2]))) for url in read["urls"])
        self.ratio = base.width / self.width
        paper = Image.new("RGBA", base.size, read["background"])
        seen = Image.alpha_composite(Image.alpha_composite(paper, base.convert("RGBA")), self._top.convert("RGBA"))
        self._seen = np.asarray(seen)[..., :3].astype(int)
        self.paper = tuple(np.asarray(paper)[0, 0, :3].tolist())

    def colour(self, x: float, y: float) -> tuple[int, ...]:
        """The colour at a position."""
        return tuple(self._seen[int(y * self.ratio), int(x * self.ratio)].tolist())

    def around(self, x: float, y: float) -> set[tuple[int, ...]]:
        """The colours within a pixel of a place."""
        row, column = int(y * self.ratio), int(x * self.ratio)
        return {tuple(c) for c in self._seen[row - 1 : row + 2, column - 1 : column + 2].reshape(-1, 3).tolist()}

    def count(self, colour: tuple[int, ...]) -> int:
        """Count the pixels of a colour."""
        return int((self._seen == colour).all(axis=-1).sum())

    def circle(self, metres: float) -> Place:
        """Return the position of a scanner with equal readings all round, forward up: the middle of its dots."""
        rows, columns = np.nonzero(np.abs(self._seen - LIGHT["reading"]).max(axis=-1) <= 12)
        (left, right), (top, bottom) = ((axis.min(), axis.max() + 1) for axis in (columns, rows))
        x, y = (left + right) / 2 / self.ratio, (top + bottom) / 2 / self.ratio
        return Place(x, y, (right - left - DOT) / 2 / self.ratio / metres, _TURNS["up"])

    def dots(self, colour: tuple[int, ...] = LIGHT["reading"]) -> list[tuple[float, float]]:
        """The middles of the dots of a colour on the upper canvas."""
        top = np.asarray(self._top.convert("RGBA")).astype(int)
        painted = (np.abs(top[..., :3] - colour).max(axis=-1) <= 12) & (top[..., 3] > 24)
        left = set(zip(*(axis.tolist() for axis in np.nonzero(painted)), strict=True))
        found = []
        while left:
            island, edge = [], [left.pop()]
            while edge:
                row, column = edge.pop()
                island.append((column + 0.5, row + 0.5, top[row, column, 3]))
                around = {(row + i, column + j) for i in (-1, 0, 1) for j in (-1, 0, 1)} & left
                left -= around
                edge += around
            x, y, weight = np.array(island, float).T
            found.append((float(np.average(x, weights=weight)), float(np.average(y, weights=weight))))
        return [(x / self.ratio, y / self.ratio) for x, y in found]


@dataclass(frozen=True)
class Place:
    """The position of the scanner in a picture, and the CSS pixels per metre and degree."""

    x: float
    y: float
    scale: float
    turn: float

    def at(self, metres: float, degrees: float) -> tuple[float, float]:
        direction = radians(degrees + self.turn)
        return self.x + metres * self.scale * cos(direction), self.y - metres * self.scale * sin(direction)


def locate(
    card: Locator,
    rays: Sequence[tuple[float, float]] = FAN,
    forward: str = "up",
    colour: tuple[int, ...] = LIGHT["reading"],
) -> Place:
    """Locate a known scan: the outermost dots give the position, and every other dot must match it.

    Args:
        rays: metres and degrees of all readings.
    """
    turn = _TURNS[forward]
    place: Place | None = None

    def look() -> str:
        nonlocal place
        dots = Picture(card).dots(colour)
        if len(dots) != len(rays):
            return f"{len(dots)} dots for {len(rays)} rays"
        place = _fit(dots, rays, turn)
        return ", ".join(f"no dot at {ray}" for ray in rays if _distance(place.at(*ray), dots) >= 0.75)

    # Try repeatedly: a cell may end before the page has painted what it sent.
    eventually(look, "")
    assert place is not None
    return place


def _fit(dots: Sequence[tuple[float, float]], rays: Sequence[tuple[float, float]], turn: float) -> Place:
    """Locate a scan by its outermost dots, along the axis on which its rays lie farther apart."""
    metric = [Place(0, 0, 1, turn).at(*ray) for ray in rays]
    axis = int(np.argmax(np.ptp(metric, axis=0)))
    low, high = min(metric, key=lambda point: point[axis]), max(metric, key=lambda point: point[axis])
    first, last = min(dots, key=lambda dot: dot[axis]), max(dots, key=lambda dot: dot[axis])
    scale = (last[axis] - first[axis]) / (high[axis] - low[axis])
    return Place(first[0] - low[0] * scale, first[1] - low[1] * scale, scale, turn)


def _distance(place: tuple[float, float], dots: Sequence[tuple[float, float]]) -> float:
    return min(hypot(place[0] - x, place[1] - y) for x, y in dots)
