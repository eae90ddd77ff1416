"""Many recordings at once: which there are, and what holds of each, in several processes or on a cluster."""

from .check_up import CheckUp, doctor
from .hits import Hit, Hits
from .places import the_only
from .search import find
from .summary import Summary, summary

__all__ = ["CheckUp", "Hit", "Hits", "Summary", "doctor", "find", "summary", "the_only"]
