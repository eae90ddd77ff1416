"""A widget and a page that shows it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from ..pages import Page
from .number_widget import NumberWidget


@pytest.fixture
def widget() -> Iterator[NumberWidget]:
    made = NumberWidget()
    yield made
    made.close()


@pytest.fixture
def page(widget: NumberWidget) -> Page:
    return Page(widget)
