"""Old names of public classes, which stay for one release."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any


def renamed(module: str, name: str, new: Mapping[str, type]) -> Any:
    """Return the class that had a name before, for the `__getattr__` of a module; warn with its new name.

    Raises:
        AttributeError: no class had this name.
    """
    if name not in new:
        raise AttributeError(f"module {module!r} has no attribute {name!r}")
    warnings.warn(
        f"{module}.{name} is called {module}.{new[name].__name__} now; the next release no longer knows the old name",
        DeprecationWarning,
        stacklevel=3,
    )
    return new[name]
