"""Many recordings at once: finding them, and running a function on each, in several processes or on a cluster."""

from .check_up import CheckUp, doctor
from .drives import Drives, drives, index, is_index
from .following import EVERY, follow
from .hits import Hit, Hits
from .places import the_only
from .rate_comparison import RateComparison, RateTable
from .search import find
from .statistics import Statistics
from .summary import Summary, summary

__all__ = [
    "EVERY",
    "CheckUp",
    "Drives",
    "Hit",
    "Hits",
    "RateComparison",
    "RateTable",
    "Statistics",
    "Summary",
    "doctor",
    "drives",
    "find",
    "follow",
    "index",
    "is_index",
    "summary",
    "the_only",
]
