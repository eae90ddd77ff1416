"""The robot to scale: the arguments of a footprint, and its data for the page."""

from __future__ import annotations

from math import radians
from typing import Any

import pytest

from robowidgets import Footprint, LaserWidget, Sector, SpeedWidget, TouchWidget, screen

from ..pages import synced


def test_the_page_gets_the_outline_the_bumpers_and_the_widgets_of_the_view() -> None:
    laser, speed, touch = LaserWidget(), SpeedWidget(), TouchWidget()
    body = Footprint(radius=0.2, bumpers={"left": ("10deg", "80deg")}, scanner=(0.1, 0, "180deg"))
    laser.footprint = body
    assert laser.footprint is body
    assert (synced(laser, "_robot")["speed"], synced(laser, "_robot")["touch"]) == ("", "")
    screen(laser, speed, touch)
    laser.footprint = body
    assert synced(laser, "_robot") == {
        "radius": 0.2,
        "polygon": [],
        "bumpers": {"left": {"start": radians(10), "end": radians(80)}},
        "scanner": [0.1, 0.0, 0.0],
        "speed": speed.model_id,
        "touch": touch.model_id,
    }
    other = SpeedWidget()
    corners = [(0.3, 0.2), (-0.3, 0.2), (-0.3, -0.2), (0.3, -0.2)]
    laser.footprint = Footprint(polygon=corners, scanner=(0, 0), speed=other, bumpers={"front": Sector(-0.2, 0.2)})
    assert (synced(laser, "_robot")["speed"], synced(laser, "_robot")["polygon"][0]) == (other.model_id, [0.3, 0.2])
    laser.footprint = None
    assert synced(laser, "_robot") == {}


def test_a_footprint_takes_the_widgets_of_a_view_that_is_made_later() -> None:
    laser, speed, touch = LaserWidget(), SpeedWidget(), TouchWidget()
    laser.footprint = Footprint(radius=0.18, bumpers={"left": ("15deg", "80deg")})
    screen(laser, speed)
    assert (synced(laser, "_robot")["speed"], synced(laser, "_robot")["touch"]) == (speed.model_id, "")
    screen(laser, speed, touch)
    assert (synced(laser, "_robot")["speed"], synced(laser, "_robot")["touch"]) == (speed.model_id, touch.model_id)
    plain = LaserWidget()
    screen(plain, speed)
    assert synced(plain, "_robot") == {}


def test_a_closed_widget_is_not_a_widget_of_a_footprint() -> None:
    laser, speed, touch = LaserWidget(), SpeedWidget(), TouchWidget()
    screen(laser, speed, touch)
    speed.close()
    laser.footprint = Footprint(radius=0.2)
    assert (synced(laser, "_robot")["speed"], synced(laser, "_robot")["touch"]) == ("", touch.model_id)


@pytest.mark.parametrize(
    ("fields", "error", "text"),
    [
        ({}, ValueError, "a radius or a polygon, got None and 0 corners"),
        ({"radius": 1, "polygon": [(0, 1), (1, 0), (0, 0)]}, ValueError, "a radius or a polygon"),
        ({"radius": 0}, ValueError, "radius: expected metres above 0"),
        ({"radius": "wide"}, TypeError, "radius: expected a number"),
        ({"polygon": [(0, 1), (1, 0)]}, ValueError, "expected 3 to 200 corners, got 2"),
        ({"polygon": [(0, 1), (1, 0), 3]}, TypeError, r"polygon: expected \(x, y\) in metres, got 3"),
        ({"polygon": [(0, 1), (1, 0), (0, float("nan"))]}, ValueError, "polygon: expected a finite number"),
        ({"polygon": [(0, 1), (1, 0), (0, 400)]}, ValueError, "polygon: expected metres within ±100"),
        ({"radius": 1, "bumpers": ["left"]}, TypeError, "bumpers: expected sectors by the names"),
        ({"radius": 1, "bumpers": {"left": 3}}, TypeError, "expected two angles"),
        ({"radius": 1, "scanner": (1,)}, TypeError, r"scanner: expected \(x, y\) or \(x, y, yaw\)"),
        ({"radius": 1, "scanner": (1, 0, 90)}, ValueError, "yaw of the scanner: expected radians within"),
        ({"radius": 1, "speed": 0.5}, TypeError, "speed: expected a SpeedWidget, got 0.5"),
        ({"radius": 1, "touch": "left"}, TypeError, "touch: expected a TouchWidget, got 'left'"),
    ],
)
def test_what_is_not_a_footprint_is_refused(fields: dict[str, Any], error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        Footprint(**fields)


def test_something_else_leaves_the_footprint_as_it_is() -> None:
    laser = LaserWidget()
    laser.footprint = Footprint(radius=0.2)
    with pytest.raises(TypeError, match=r"footprint: expected a Footprint or None, got 0\.3"):
        laser.footprint = 0.3  # type: ignore[assignment]
    assert synced(laser, "_robot")["radius"] == 0.2
