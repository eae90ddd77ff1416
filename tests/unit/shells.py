"""Shells of IPython for tests that run no cells."""

from __future__ import annotations

from typing import Any

import pytest
from IPython.core.interactiveshell import InteractiveShell


class Shell(InteractiveShell):  # type: ignore[misc]
    """A shell with only the members that a test gives it."""

    def __init__(self, **members: Any) -> None:
        vars(self).update(members)


def put_in_place(monkeypatch: pytest.MonkeyPatch, **members: Any) -> Shell:
    """Make IPython report this shell as the one that runs the cells."""
    shell = Shell(**members)
    monkeypatch.setattr("IPython.get_ipython", lambda: shell)
    return shell
