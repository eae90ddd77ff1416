"""The fields of any message as a tree, packed for the page: only the part that the user looks at."""

from __future__ import annotations

from .pack import pack
from .read import MOST_NUMBERS, Tree, read

__all__ = ["MOST_NUMBERS", "Tree", "pack", "read"]
