"""A page in a file: what it takes, and how it is written."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from .._core.output_file import whole_file
from .._core.tables import megabytes
from ._models import Models, shown
from ._page import Heading, Program, page
from ._segments import segment

__all__ = ["MAX_SIZE", "SUFFIXES", "Heading", "Models", "Page", "segment", "shown"]

SUFFIXES = (".html", ".htm")

MAX_SIZE = 50_000_000
"""Most bytes of a page, unless more are allowed."""

_SAMPLED = 40
"""Most segments that are packed to estimate the size of a page."""

_AROUND = 64
"""Bytes around a part."""


class Page(NamedTuple):
    """A page that can be written.

    Args:
        heading: its text.
        program: its scripts and stylesheets.
        state: its models.
        numbers: of its segments.
        segment: packs a segment, by its number.
        advice: how to have less of it, for a page that is too large.
    """

    heading: Heading
    program: Program
    state: bytes
    numbers: range = range(0)
    segment: Callable[[int], bytes] = bytes
    advice: str = ""

    def size(self) -> int:
        """Its bytes; estimated from some of its segments where there are many."""
        fixed = sum(map(len, page(self.heading, self.program, self.state, ())))
        step = -(-len(self.numbers) // _SAMPLED) or 1
        some = [len(self.segment(number)) + _AROUND for number in self.numbers[step // 2 :: step]]
        return fixed + round(sum(some) / max(1, len(some)) * len(self.numbers))

    def write(self, path: Path, max_size: int | None = MAX_SIZE) -> Path:
        """Write it, all of it or nothing; returns the path.

        Raises:
            ValueError: it would take more than ``max_size`` bytes; None: any size is fine. OSError: the file cannot be
                written.
        """
        if max_size is not None and len(self.numbers) > _SAMPLED:
            self._check(self.size(), path, max_size)
        size = 0
        try:
            with whole_file(path) as file:
                for piece in page(self.heading, self.program, self.state, map(self.segment, self.numbers)):
                    file.write(piece)
                    size += len(piece)
                    if max_size is not None:
                        self._check(size, path, max_size, "more than ")
        except OSError as error:
            raise type(error)(f"{path} was not written: {error.strerror or error}") from None
        return path

    def _check(self, size: int, path: Path, max_size: int, about: str = "about ") -> None:
        if size > max_size:
            raise ValueError(
                f"{path.name} would take {about}{megabytes(size)}, and at most {megabytes(max_size)} are allowed: "
                f"{self.advice}, or allow more (max_size={-(-2 * size // 10**6) * 10**6:_})"
            )
