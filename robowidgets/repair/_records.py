"""The records of a file, and what is wrong with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

MAX_PLACES = 10_000
MAX_TEXT = 1 << 22


class Record(NamedTuple):
    """The offsets of a record: ``start``, the first byte of its data (``body``), the byte after its data (``end``).

    A chunk that is not compressed ends where its data starts: its records are walked as if they lay outside it, so a
    wrong length or a missing end costs nothing. ``whole`` is False when the data ends early.
    """

    op: int
    start: int
    body: int
    end: int
    fields: Mapping[str, bytes] = {}
    whole: bool = True


@dataclass
class Damage:
    """The damage of a file.

    ``places`` counts where the walk had to search for the next record or could not use one; ``index``: lengths in the
    index were wrong; ``cut``: data is missing at the end; ``unfinished``: only the index is missing at the end;
    ``checksums`` counts chunks that differ from their checksum; ``compressions`` names those that cannot be read;
    ``unnamed`` counts messages of topics that the file does not name; ``disk`` is the text of the disk's error.
    """

    places: int = 0
    index: bool = False
    cut: bool = False
    unfinished: bool = False
    checksums: int = 0
    compressions: set[str] = field(default_factory=set)
    unnamed: int = 0
    disk: str = ""
