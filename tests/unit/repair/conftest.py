"""Fixtures for the tests of repair."""

from __future__ import annotations

from ..recordings.conftest import close_what_was_opened

__all__ = ["close_what_was_opened"]
