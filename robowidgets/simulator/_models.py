"""Models of real robots, with their messages. Sizes and limits are typical values, accelerations are estimates."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from math import pi, radians
from types import MappingProxyType
from typing import Any, NamedTuple

from ..samples import Touch
from ._contact import PlacesOnBody
from ._scanners import SCANNERS
from .motors import Motors
from .scanner import Scanner
from .sonars import Sonars

Bumpers = Mapping[str, tuple[float, float]]
"""The part of the rim that each bumper covers, by name: from and to, in radians counter-clockwise from forward."""


class Model(NamedTuple):
    """A model of a robot.

    Attributes:
        radius: the radius of the body, metres.
        motors: the limits of its motors.
        scanner: its usual scanner, with its mount.
        bumpers: its bumpers from left to right; empty without bumpers.
        touch_type: the type of the messages of its touch sensors; empty without touch sensors.
        to_message: converts the states of its touch sensors to a message.
        drop_sensors: the places where its cliff sensors and wheel drops look for the floor. They follow the bumpers.
        sonars: its ring of sonars, without poses if it has no sonars.
    """

    radius: float
    motors: Motors
    scanner: Scanner
    bumpers: Bumpers
    touch_type: str
    to_message: Callable[[Touch], Any]
    drop_sensors: PlacesOnBody = MappingProxyType({})
    sonars: Sonars = Sonars()


def _degrees(**bumpers: tuple[float, float]) -> Bumpers:
    return {name.replace("_", " "): (radians(low), radians(high)) for name, (low, high) in bumpers.items()}


_KOBUKI_BITS = {
    "bumper": {"left": 4, "center": 2, "right": 1},
    "cliff": {"cliff left": 4, "cliff center": 2, "cliff right": 1},
    "wheel_drop": {"wheel left": 2, "wheel right": 1},
}


def _kobuki(touch: Touch) -> Any:
    return {
        field: sum(bit for name, bit in bits.items() if touch.touched[name]) for field, bits in _KOBUKI_BITS.items()
    }


def _turtlebot3(touch: Touch) -> Any:
    return {"bumper": touch.touched["front"] + 2 * touch.touched["back"], "cliff": 0.0}  # type: ignore[operator]


def _hazards(touch: Touch) -> Any:
    return {"detections": [_hazard(name) for name, is_touched in touch.touched.items() if is_touched]}


def _hazard(name: str) -> Any:
    # The types are BUMP 1, CLIFF 2 and WHEEL_DROP 4.
    kind = name.split()[0]
    code, frame = {"cliff": (2, name), "wheel": (4, name.replace("wheel", "wheel drop"))}.get(kind, (1, f"bump {name}"))
    return {"header": {"frame_id": frame.replace(" ", "_")}, "type": code}


# Neighbours overlap: a contact between 15 and 30 degrees presses two bumpers. Sides and back have no bumper.
_THREE = _degrees(left=(15, 80), center=(-30, 30), right=(-80, -15))

# The front ring of a Pioneer 3-DX from left to right, in metres and degrees. The rear ring mirrors it from right to
# left, at a larger distance from the middle.
_PIONEER = ((0.069, 0.136, 90), (0.114, 0.119, 50), (0.148, 0.078, 30), (0.166, 0.027, 10))
_FRONT = (*_PIONEER, *((x, -y, -degrees) for x, y, degrees in reversed(_PIONEER)))
_REAR = tuple((-0.088 - x, y, (180 - degrees + 180) % 360 - 180) for x, y, degrees in reversed(_FRONT))
_RING = {
    f"{end}_{i}": (x, y, radians(degrees))
    for end, ring in (("front", _FRONT), ("rear", _REAR))
    for i, (x, y, degrees) in enumerate(ring)
}

WHEELS = {"wheel left": (pi / 2, 0.67), "wheel right": (-pi / 2, 0.67)}

MODELS: dict[str, Model] = {
    "plain": Model(0.18, Motors(), Scanner(), _THREE, "robowidgets/msg/Touch", lambda touch: touch),
    "turtlebot3": Model(
        0.105,
        Motors(0.22, 2.84, 2.5, 3.2),
        replace(SCANNERS["lds01"], mount=(-0.032, 0.0, 0.0)),
        _degrees(front=(-60, 60), back=(120, 240)),
        "turtlebot3_msgs/msg/SensorState",
        _turtlebot3,
    ),
    "kobuki": Model(
        0.176,
        Motors(0.7, radians(180), 0.8, 3.5),
        SCANNERS["urg04lx"],
        _THREE,
        "kobuki_msgs/msg/SensorState",
        _kobuki,
        {"cliff left": (1.0, 0.92), "cliff center": (0.0, 0.89), "cliff right": (-1.0, 0.92), **WHEELS},
    ),
    "create3": Model(
        0.171,
        Motors(0.306, 1.9, 0.9, 7.7),
        SCANNERS["rplidar_a1"],
        _degrees(left=(50, 90), front_left=(18, 54), front_center=(-20, 20), front_right=(-54, -18), right=(-90, -50)),
        "irobot_create_msgs/msg/HazardDetectionVector",
        _hazards,
        {"cliff side left": (1.18, 0.92), "cliff front left": (0.27, 0.97)}
        | {"cliff front right": (-0.27, 0.97), "cliff side right": (-1.18, 0.92)}
        | WHEELS,
    ),
    # With a SICK LMS 200. The simulated body is round, and large enough for the rear ring.
    "pioneer": Model(
        0.26,
        Motors(1.2, radians(300), 0.5, radians(200)),
        Scanner(181, pi, 0.05, 8.0, 0.005, 0.001, 0.0, mount=(0.05, 0.0, 0.0)),
        {},
        "",
        lambda touch: touch,
        sonars=Sonars(_RING),
    ),
    "pr2": Model(
        0.334,
        Motors(1.0, 1.0, 1.0, 2.0, max_lateral=1.0),
        replace(SCANNERS["utm30lx"], mount=(0.275, 0.0, 0.0)),
        {},
        "",
        lambda touch: touch,
    ),
}


def model_of(name: str) -> Model:
    """Return the model with this name; ValueError if it does not exist."""
    if name not in MODELS:
        raise ValueError(f"model: expected {', '.join(MODELS)}, got {name!r}")
    return MODELS[name]
