"""Fixtures for the tests of recordings."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from robowidgets.recordings import RecordingData
from robowidgets.repair._indexed import IndexedSource


@pytest.fixture(autouse=True)
def close_what_was_opened(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Close every recording, and every source over damaged files, when its test ends."""
    opened: list[IndexedSource | RecordingData] = []
    for kind in (IndexedSource, RecordingData):

        def init(self: Any, *args: Any, _init: Any = kind.__init__) -> None:
            _init(self, *args)
            opened.append(self)

        monkeypatch.setattr(kind, "__init__", init)
    yield
    for source in opened:
        source.close()
