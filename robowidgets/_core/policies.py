"""How long functions of a user may take, and what becomes of one that does not return: of all kinds, in one place.

The words mean the same for all of them, here, in messages and in the documentation:

- It is *late* when it has not returned for some seconds. That is shown, with the line at which it is.
- It is *left* when nobody waits for it any more: it was *replaced*, removed or closed, or, of a program, it was late.
  It may finish, but its thread is abandoned, so it may not drive, and what it returns is not taken.
- It is *ended* when it has not returned some seconds after it was left: SystemExit is raised in its thread, and again
  where a ``try`` takes it.
- What it *raised*, be it SystemExit, is shown with its line, and ends no thread of ours.
"""

from __future__ import annotations

from math import inf
from typing import NamedTuple


class Policy(NamedTuple):
    """Limits of time of one kind of function, in seconds.

    Attributes:
        late: after which a function that has not returned is late.
        look: between two looks at it.
        most: that count between two looks: where one comes later, the whole process may have stood still.
        grace: after which one that was left is ended; infinite: never.
    """

    late: float
    look: float
    most: float = inf
    grace: float = inf


CONDITION = Policy(late=0.1, look=0.1, grace=0.1)
"""A condition of a watch. The picture of a sample is shown without its verdict when it is late."""

RECORDED = Policy(late=1.0, look=0.1, most=0.1, grace=0.1)
"""A condition that is judged on the samples of a recording. When it is late it is left and switched off."""

FUNCTION = Policy(late=1.0, look=1.0)
"""A function that is connected to a topic. The widgets of the topic name it when it is late. It is never ended."""

STEP = Policy(late=0.45, look=0.025, most=0.1, grace=0.5)
"""A step of a program. When it is late it is left, the robot gets zero, and the program has failed."""

ANSWER = STEP
"""An answer to a task of a lesson, for a robot. When it is late it is ended, and the answer is wrong."""

NO_RETURN = "a step has not returned for half a second, and was abandoned"
"""What is said of a step, and of an answer, that was late."""
