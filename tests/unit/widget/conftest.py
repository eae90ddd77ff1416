"""A widget, a page that shows it, and the time at which its samples come."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from robowidgets.widget import newest_sample

from ..pages import Page
from ..waiting import Clock
from .number_widget import NumberWidget


@pytest.fixture
def widget() -> Iterator[NumberWidget]:
    made = NumberWidget()
    yield made
    made.close()


@pytest.fixture
def page(widget: NumberWidget) -> Page:
    return Page(widget)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(newest_sample, "time", made)
    return made
