"""The library of Rerun, imported lazily because it is an optional dependency."""

from __future__ import annotations

from importlib import import_module
from typing import Any

INSTALL = "pip install 'robowidgets[rerun]'"


def library(name: str) -> Any:
    """Return a module of rerun-sdk.

    Raises:
        ImportError: it is not installed or too old. The text contains the command that installs it.
    """
    try:
        module = import_module(name)
    except ImportError as error:
        raise ImportError(f"Rerun is not installed here ({error}): {INSTALL}, with Python 3.11 or later") from None
    if name == "rerun" and not hasattr(module, "StateChange"):
        version = getattr(module, "__version__", "another package of that name")
        raise ImportError(f"rerun-sdk 0.41 or later is needed, but {version} is installed: {INSTALL}")
    return module
