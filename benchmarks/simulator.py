"""The speed of the simulated robot, in rooms with few and with thousands of walls."""

from __future__ import annotations

import time
from statistics import median
from typing import NamedTuple

import numpy as np

from robowidgets.simulator import Robot, Scanner, World, room, wander

SECONDS = 20.0
SCANNER = Scanner(ray_count=1040, field_of_view="260deg", range_max=30.0, rate=40.0)


class Room(NamedTuple):
    """The number of its walls, and simulated seconds per second of CPU time."""

    walls: int
    speed: float


def compare(repeats: int) -> dict[str, Room]:
    """Return the speed in each room, by name."""
    worlds = {name: room(name) for name in ("house", "corridor", "office", "maze")} | {"map": large_map()}
    return {
        name: Room(len(world.walls), median(speed_in(world) for _ in range(repeats))) for name, world in worlds.items()
    }


def large_map() -> World:
    cells = np.where(np.random.default_rng(1).random((300, 300)) < 0.03, 100, 0)
    cells[140:160, 140:160] = 0
    return World.from_map({"info": {"width": 300, "height": 300, "resolution": 0.1}, "data": cells.ravel()})


def speed_in(world: World) -> float:
    robot = Robot(world, scanner=SCANNER)
    began = time.process_time()
    for _ in wander(robot):
        robot.step(1 / SCANNER.rate)
        robot.scan()
        if robot.time >= SECONDS:
            break
    return SECONDS / (time.process_time() - began)
