"""Time limits for functions of the user, and the treatment of functions that do not return.

These terms have one meaning for all kinds of functions, in the code, in messages and in the documentation:

- A function is *late* when it has not returned for some seconds. Messages show this, with the line it is at.
- It is *detached* when nothing waits for it any more: it was *replaced*, removed or closed, or it was late in a
  program. It may finish, but its thread is abandoned, so it may not drive, and its result is dropped.
- It is *ended* when it has not returned some seconds after it was detached: SystemExit is raised in its thread, and
  again if a ``try`` catches it.
- An error that it *raised*, even SystemExit, is shown with its line, and ends no thread of this package.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple


class Policy(NamedTuple):
    """Time limits of one kind of function, in seconds.

    Attributes:
        late: the time after which a function that has not returned is late.
        look: the time between two checks of a function.
        max_gap: the longest gap between two checks that counts as run time; a longer one means the process was
            suspended.
        grace: the time after which a detached function is ended. If infinite, it is never ended.
    """

    late: float
    look: float
    max_gap: float = inf
    grace: float = inf


CONDITION = Policy(late=0.1, look=0.1, grace=0.1)
"""A condition of a watch. If it is late, the picture of a sample is shown without its verdict."""

RECORDED = Policy(late=1.0, look=0.1, max_gap=0.1, grace=0.1)
"""A condition that is judged on the samples of a recording. If it is late, it is detached and switched off."""

FUNCTION = Policy(late=1.0, look=1.0)
"""A function that is connected to a topic. If it is late, the widgets of the topic name it. It is never ended."""

STEP = Policy(late=0.45, look=0.025, max_gap=0.1, grace=0.5)
"""A step of a program. If it is late, it is detached, the robot gets zero, and the program has failed."""

TRIAL = Policy(late=1.5, look=0.1, max_gap=0.1, grace=0.1)
"""Steps of another version on inputs of the past. If one is late, it is detached, and the trial is over."""

ANSWER = STEP
"""An answer to a task of a lesson, for a robot. If it is late, it is ended, and the answer is wrong."""

NO_RETURN = "a step has not returned for half a second, and was abandoned"
"""The error of a step, or of an answer, that was late."""
