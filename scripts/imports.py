"""Print the number of modules that a first LaserWidget imports.

It never fails. After an increase, find the new modules by `python -X importtime`; if they are worth it, change `KEPT`.
The time of the import is not compared, because it doubles on a busy machine.
"""

from __future__ import annotations

import subprocess
import sys

KEPT = 98
"""The number of modules when it was last changed."""
GROWN = 1.1
"""The part of `KEPT` above which an increase is reported."""
CODE = """
import sys
import ipykernel.kernelapp, ipywidgets, numpy, anywidget
before = len(sys.modules)
from robowidgets import LaserWidget
print(len(sys.modules) - before)
"""


def count() -> int:
    """Return the number of modules that a kernel with anywidget imports for a LaserWidget."""
    return int(subprocess.run([sys.executable, "-c", CODE], capture_output=True, check=True).stdout)


def report(modules: int, kept: int) -> str:
    """Return a line with the number of modules, and a warning if it grew by more than a tenth."""
    line = f"a first LaserWidget imports {modules} modules"
    if modules <= GROWN * kept:
        return line
    return f"{line}: warning, {modules - kept} more than in imports.py. If they are worth it, change the number there."


if __name__ == "__main__":
    print(report(count(), KEPT))
