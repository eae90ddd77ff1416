"""Where another process of ours finds modules."""

from __future__ import annotations

import sys


def import_path() -> list[str]:
    """The entries of `sys.path` that are text: Python passes over others, such as a `Path`."""
    return [str(entry) for entry in sys.path if isinstance(entry, str)]
