"""Print the oldest version of each dependency that pyproject.toml allows, as constraints for pip."""

from __future__ import annotations

import re
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1] / "pyproject.toml"

for name, oldest in re.findall(r'"([\w.-]+)(?:\[\w+\])?>=([\d.]+)', PROJECT.read_text("utf-8")):
    print(f"{name}=={oldest}")
