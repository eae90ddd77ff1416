"""The Node of this checkout, for tests in any of its Python environments."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from .conftest import ROOT

_PLACES = (str(ROOT / ".venv" / "bin"), str(Path(sys.executable).parent), os.environ["PATH"])

ENVIRONMENT = {**os.environ, "PATH": os.pathsep.join(_PLACES)}
"""The environment in which ``node`` is this Node."""
