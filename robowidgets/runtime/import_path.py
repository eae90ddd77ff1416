"""The import path of the processes that this package starts."""

from __future__ import annotations

import sys


def import_path() -> list[str]:
    """Return the entries of `sys.path` that are text. Python ignores others, such as a `Path`."""
    return [str(entry) for entry in sys.path if isinstance(entry, str)]
