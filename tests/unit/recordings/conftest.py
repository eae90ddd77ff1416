"""What the tests of recordings share."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from robowidgets import Recording
from robowidgets.repair._saved import SavedFile
from robowidgets.repair._sqlite import SavedDatabase


@pytest.fixture(autouse=True)
def _close_what_was_opened(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Every recording, and every source of the readers for damaged files, is closed when its test ends."""
    opened: list[SavedFile | SavedDatabase | Recording] = []
    for kind in (SavedFile, SavedDatabase, Recording):

        def init(self: Any, *args: Any, _init: Any = kind.__init__) -> None:
            _init(self, *args)
            opened.append(self)

        monkeypatch.setattr(kind, "__init__", init)
    yield
    for source in opened:
        source.close()
