"""Tasks for who learns to program a robot, each with a check that says what is still wrong. See the lesson notebooks.

The simulator is all they need.
"""

from ._check import Result, check, example

__all__ = ["Result", "check", "example"]
