"""Programs that drive a robot, and that may be rewritten while it moves."""

from .drive import Drive
from .machine import Machine
from .program import Program
from .simulation import simulate
from .variables import Variables

__all__ = ["Drive", "Machine", "Program", "Variables", "simulate"]
