"""Programs that drive a robot, and that may be rewritten while it moves."""

from .drive import Drive
from .program import Program
from .variables import Variables

__all__ = ["Drive", "Program", "Variables"]
