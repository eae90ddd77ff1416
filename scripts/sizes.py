"""Print the compressed size of the script and stylesheet of each widget, and the cost of an increase.

It never fails. After an increase, add a row to `sizes.csv` with the reason.
"""

from __future__ import annotations

import csv
import gzip
from pathlib import Path

STATIC = Path(__file__).parents[1] / "robowidgets" / "static"
TABLE = Path(__file__).with_name("sizes.csv")
MS_PER_KB = 0.8
"""Milliseconds per kB until a page shows its first widget of a kind, measured with a laser widget smaller by 6 kB."""
WORTH_A_ROW = 250
"""The increase in bytes from which a row is necessary."""


def sizes() -> dict[str, int]:
    """Return the bytes of each widget in the last build."""
    found = {}
    for script in sorted(STATIC.glob("*_widget.js")):
        parts = (script, script.with_suffix(".css"))
        found[script.stem.removesuffix("_widget")] = sum(len(gzip.compress(part.read_bytes())) for part in parts)
    return found


def known() -> dict[str, int]:
    """Return the bytes of each widget in its last row of the table."""
    with TABLE.open(encoding="utf-8") as rows:
        return {row["widget"]: int(row["bytes"]) for row in csv.DictReader(rows)}


def told(now: dict[str, int], before: dict[str, int]) -> list[str]:
    """Return a line for each widget, with the cost of an increase."""
    lines = []
    for name, size in now.items():
        line = f"{name} {size / 1000:.1f} kB"
        if name not in before:
            line += f": new. Give it a row in {TABLE.name}."
        elif (more := size - before[name]) >= WORTH_A_ROW:
            line += (
                f": warning, {more / 1000:.1f} kB more than in {TABLE.name}; a page shows its first one "
                f"{MS_PER_KB * more / 1000:.1f} ms later. If this is worth it, add a row with the reason."
            )
        lines.append(line)
    return lines


if __name__ == "__main__":
    print("\n".join(told(sizes(), known())))
