"""A small robot in a small world, without a middleware, for lessons, demos and tests.

It has two driven wheels, a laser scanner and three bumpers, and returns the samples that the widgets show.
Simulated time passes only in `Robot.step`, and the same seed gives the same bytes.

Examples:
    >>> from robowidgets.simulator import Robot, World
    >>> robot = Robot(World.rooms(), seed=1)
    >>> robot.drive(0.5, 0.0)
    >>> for _ in range(20):
    ...     robot.step(0.05)
    >>> robot.time, len(robot.scan())
    (1.0, 541)
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from ..samples import Pose
from .camera import Camera, picture
from .motors import Motors
from .robot import Robot
from .rooms import room
from .scanner import Scanner
from .sonars import Sonars
from .wander import wander
from .world import World

__all__ = ["Camera", "Motors", "Pose", "Robot", "Scanner", "Sonars", "View", "World", "picture", "room", "wander"]

if TYPE_CHECKING:
    from .view import View as View
else:

    def __getattr__(name: str) -> Any:
        if name == "View":  # simulated programs, and searches for their stops, need no widgets
            return import_module(".view", __name__).View
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

    def __dir__() -> list[str]:
        return sorted({*globals(), *__all__})
