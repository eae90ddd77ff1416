"""Tells what script and stylesheet of each widget weigh, compressed as a server sends them, and what more of it costs.

It refuses nothing. Who adds weight adds a row to `sizes.csv`, which says what it is for.
"""

from __future__ import annotations

import csv
import gzip
from pathlib import Path

STATIC = Path(__file__).parents[1] / "robowidgets" / "static"
TABLE = Path(__file__).with_name("sizes.csv")
MS_PER_KB = 0.8
"""Milliseconds of a page until its first picture of the kind, once, as measured with 6 kB less of the laser."""
WORTH_A_ROW = 250
"""Bytes."""


def sizes() -> dict[str, int]:
    """The bytes of each widget, as it was built last."""
    found = {}
    for script in sorted(STATIC.glob("*_widget.js")):
        parts = (script, script.with_suffix(".css"))
        found[script.stem.removesuffix("_widget")] = sum(len(gzip.compress(part.read_bytes())) for part in parts)
    return found


def known() -> dict[str, int]:
    """The bytes of each widget in its last row of the table."""
    with TABLE.open(encoding="utf-8") as rows:
        return {row["widget"]: int(row["bytes"]) for row in csv.DictReader(rows)}


def told(now: dict[str, int], before: dict[str, int]) -> list[str]:
    """A line for each widget; one that has become heavier is told with the price of it."""
    lines = []
    for name, size in now.items():
        line = f"{name} {size / 1000:.1f} kB"
        if name not in before:
            line += f": new. Give it a row in {TABLE.name}."
        elif (more := size - before[name]) >= WORTH_A_ROW:
            line += (
                f": warning, {more / 1000:.1f} kB more than {TABLE.name} says; a page has its first one "
                f"{MS_PER_KB * more / 1000:.1f} ms later. If that is worth it, add a row that says why."
            )
        lines.append(line)
    return lines


if __name__ == "__main__":
    print("\n".join(told(sizes(), known())))
