"""The topics of the simulated robot with a camera, as messages of ROS 2 and as a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from robowidgets.laser.row import LASER
from robowidgets.messages.standard import LASER_SCAN, RANGE, range_message, scan_message
from robowidgets.simulator import Robot, World
from robowidgets.simulator.offers import Offer, cameras
from robowidgets.sonar.row import SONAR

from .unit.recordings import recorded

NEAR = (0.3, -1.6, 0.15)
"""A pose with a round obstacle 0.4 m ahead."""


def robot() -> Robot:
    return Robot(World.rooms(), NEAR, model="pioneer", camera=True, seed=1)


def offers(of: Robot) -> list[Offer]:
    return [*cameras(of), *LASER.simulated(of), *[one for one in SONAR.simulated(of) if one.topic == "/sonar/front_3"]]


def types(of: Robot) -> dict[str, str]:
    """The type of each topic."""
    return {one.topic: one.type for one in offers(of)}


def fields(offer: Offer) -> Any:
    """The fields of the newest message of a topic, with the stamp of its sample."""
    sample = offer.read()
    if offer.type in (LASER_SCAN, RANGE):
        make = scan_message if offer.type == LASER_SCAN else range_message
        return make(sample, sample.stamp_ns, offer.type)[1]
    return offer.message(sample)


def write(folder: Path, seconds: float = 1.5) -> Path:
    """A recording of a robot that turns, of its camera, its laser and one of its sonars."""
    driven = robot()
    driven.drive(0.0, 0.3)
    before: dict[str, Any] = {}
    messages: list[tuple[float, str, Any]] = []
    while driven.time < seconds:
        driven.step(0.05)
        for offer in offers(driven):
            sample = offer.read()
            if sample is not before.get(offer.topic):
                before[offer.topic] = sample
                messages.append((driven.time, offer.topic, fields(offer)))
    return recorded.write(folder, types(driven), messages)
