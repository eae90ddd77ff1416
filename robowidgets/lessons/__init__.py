"""Tasks for students who learn to program a robot. A check of each task says what is still wrong.

See the lesson notebooks. They need only the simulator.
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
