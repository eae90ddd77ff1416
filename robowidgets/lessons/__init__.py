"""Tasks for who learns to program a robot, each with a check that says what is still wrong. See the lesson notebooks.

The simulator is all they need.
"""

from ._check import check, example
from ._progress import Progress, progress, report
from ._result import Result
from ._summary import Summary, summary
from ._texts import ENGLISH, languages

__all__ = ["ENGLISH", "Progress", "Result", "Summary", "check", "example", "languages", "progress", "report", "summary"]
