"""Errors about wrong arguments, as a notebook shows them."""

from __future__ import annotations

import json
import re
import subprocess
import sys

import pytest

ERRORS = {
    "LaserWidget(arcs=5)": r"^TypeError: LaserWidget\(\) has no keyword 'arcs'; did you mean 'arc_count'\?",
    "LaserWidget('/scan')": r"^TypeError: LaserWidget\(\) takes keywords only",
    "LaserWidget(arc_count='4')": "^TraitError: The 'arc_count' trait of a LaserWidget instance",
    "laser.arcs_count = 2": r"^AttributeError: LaserWidget has no trait 'arcs_count'; did you mean 'arc_count'\?",
    "laser.angle_offset = 'x'": "^TraitError: angle_offset: expected radians",
    "laser.update([1, 2, 3])": r"^TypeError: update\(\) got a list without the scanner's geometry",
    "SpeedWidget().update(0.5)": r"^TypeError: update\(\) takes one message, or numbers by name",
    "TouchWidget().update(5)": "^TypeError: expected sensor names",
}
# Runs each code as a cell, and prints what the notebook shows of it.
RUN = """
import json, re, sys
from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import capture_output
shell = InteractiveShell.instance()
shell.run_cell("from robowidgets import LaserWidget, SpeedWidget, TouchWidget; laser = LaserWidget()")
shell.run_cell("def helper():\\n    laser.update([1, 2, 3])")
texts = {}
for code in json.loads(sys.argv[1]):
    with capture_output() as captured:
        shell.run_cell(code)
    texts[code] = re.sub(r"\\x1b\\[[0-9;]*m", "", captured.stdout)
print(json.dumps(texts))
"""


@pytest.fixture(scope="module")
def texts() -> dict[str, str]:
    """By code, what a notebook shows when it runs."""
    given = json.dumps([*ERRORS, "helper()"])
    done = subprocess.run([sys.executable, "-c", RUN, given], capture_output=True, text=True, check=True, timeout=60)
    shown: dict[str, str] = json.loads(done.stdout)
    return shown


def frames_of(text: str) -> list[str]:
    return re.findall(r"^(?:File|Cell In|Input In).*$", text, re.M)


@pytest.mark.parametrize("code", ERRORS)
def test_only_the_users_own_frame_is_shown(texts: dict[str, str], code: str) -> None:
    frames = frames_of(texts[code])
    assert len(frames) == 1, texts[code]
    assert not frames[0].startswith("File")
    assert re.search(ERRORS[code], texts[code].strip().splitlines()[-1])


def test_every_frame_of_the_users_own_code_is_shown(texts: dict[str, str]) -> None:
    assert [frame.endswith("in helper()") for frame in frames_of(texts["helper()"])] == [False, True]
