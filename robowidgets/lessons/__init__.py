"""Tasks for who learns to program a robot, each with a check that says what is still wrong. See the lesson notebooks.

The simulator is all they need.
"""

from ._check import check, example
from ._progress import LessonProgress, progress, report
from ._result import Result
from ._summary import ClassSummary, grade, summary
from ._texts import ENGLISH, languages

__all__ = [
    "ENGLISH",
    "ClassSummary",
    "LessonProgress",
    "Result",
    "check",
    "example",
    "grade",
    "languages",
    "progress",
    "report",
    "summary",
]
