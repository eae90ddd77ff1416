"""Errors about wrong arguments, as a notebook shows them."""

from __future__ import annotations

import json
import re
import subprocess
import sys

import pytest

pytestmark = [pytest.mark.slow, pytest.mark.versions]

ERRORS = {
    "LaserWidget(arcs=5)": r"^TypeError: LaserWidget\(\) has no keyword 'arcs'; did you mean 'arc_count'\?",
    "LaserWidget('/scan')": r"^TypeError: LaserWidget\(\) takes keywords only",
    "LaserWidget(arc_count='4')": "^TraitError: The 'arc_count' trait of a LaserWidget instance",
    "laser.arcs_count = 2": r"^AttributeError: LaserWidget has no trait 'arcs_count'; did you mean 'arc_count'\?",
    "laser.freeze()": r"has no attribute 'freeze'; did you mean 'widget.paused = True'\?$",
    "laser.frozen = True": r"^AttributeError: LaserWidget.frozen cannot be set; did you mean 'widget.paused = True'\?$",
    "laser.show()": r"did you mean 'display\(widget\)'\?$",
    "laser.ranges": r"did you mean 'widget.scan.ranges'\?$",
    "SpeedWidget().max_speed": r"did you mean 'linear_limits'\?$",
    "recording.doctr()": r"^AttributeError: 'Recording' object has no attribute 'doctr'; did you mean 'doctor'\?$",
    "robowidgets.feeds.simulater()": r"has no attribute 'simulater'; did you mean 'simulator'\?$",
    "robowidgets.simulator.World.romms()": r"has no attribute 'romms'; did you mean 'rooms'\?$",
    "robowidgets.MachineWidget()": r"missing 1 required positional argument: 'robot'$",
    "robowidgets.DriveWidget(robowidgets.feeds.simulator())": r"takes keywords only, like send=feed\.drive; got ",
    "[].push": "^AttributeError: 'list' object has no attribute 'push'$",
    "laser.angle_offset = 'x'": "^TraitError: angle_offset: expected radians",
    "laser.update([1, 2, 3])": r"^TypeError: update\(\) got a list without the scanner's geometry",
    "SpeedWidget().update(0.5)": r"^TypeError: update\(\) takes one message, or numbers by name",
    "TouchWidget().update(5)": "^TypeError: expected sensor names",
    "laser.draw('wall', 5)": r"^TypeError: draw\('wall'\): expected a Line",
    "robowidgets.Laser": "^AttributeError: .*; did you mean 'LaserWidget'",
    "robowidgets.open('nothing.bag')": "^RecordingError: .*nothing.bag: no such file or folder",
    "robowidgets.open(5)": "^TypeError: path: expected the path of a recording, as text or as a pathlib.Path, got 5",
    "recording.at('/scan', 5).sample.distence('front')": r"has no attribute 'distence'; did you mean 'distance'\?$",
    "recording.scans('/scam')": "^UnknownTopicError: sample.mcap has no topic '/scam'",
    "recording.to_html('x.html', start=99)": "^ValueError: start: expected seconds from 0 to 58.00, got 99",
    "list(recording.samples('/scan', start='x'))": "^TypeError: start: expected seconds",
    "recording.find(5)": "^TypeError: condition: expected a function",
    "recording.find(robowidgets.conditions.touched)": r"call it, as in conditions\.touched\(\.\.\.\)$",
    "recording.show().seek('x')": "^TraitError: time: expected seconds from the start",
    "recording.at('/scan', 5).sample.distance('fron')": "^ValueError: sector: expected front, left",
    "robowidgets.feeds.simulator().connect('/scan')": r"^TypeError: connect\('/scan'\): expected a widget",
    "robowidgets.feeds.rosbridge('nowhere')": "^ValueError: address: expected one like ws",
}
CONDITIONS = {
    "recording.find(lambda moment: 1 / 0)": "ZeroDivisionError: division by zero",
    "recording.find(lambda scan: scan.distance() < 'x')": "'<' not supported between instances of 'float' and 'str'",
    "recording.find(lambda scan: scan.distances() < 1)": "no attribute 'distances'; did you mean 'distance'?",
}
FAULT = "recording._messages = None; recording.at('/scan', 1)"
# Runs each code as a cell, and prints the output of the notebook.
RUN = """
import json, re, sys
from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import capture_output
shell = InteractiveShell.instance()
shell.run_cell("import robowidgets; from robowidgets import LaserWidget, SpeedWidget, TouchWidget")
shell.run_cell("laser = LaserWidget(); recording = robowidgets.open(robowidgets.SAMPLE)")
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
    """By code, the output of a notebook that runs it."""
    given = json.dumps([*ERRORS, "helper()", *CONDITIONS, FAULT])
    done = subprocess.run([sys.executable, "-c", RUN, given], capture_output=True, text=True, check=True)
    shown: dict[str, str] = json.loads(done.stdout)
    return shown


def frames_of(text: str) -> list[str]:
    return re.findall(r"^(?:File |Cell In|Input In).*$", text, re.M)


@pytest.mark.parametrize("code", ERRORS)
def test_only_the_users_own_frame_is_shown(texts: dict[str, str], code: str) -> None:
    frames = frames_of(texts[code])
    assert len(frames) == 1, texts[code]
    assert not frames[0].startswith("File")
    assert re.search(ERRORS[code], texts[code].strip().splitlines()[-1])


def test_every_frame_of_the_users_own_code_is_shown(texts: dict[str, str]) -> None:
    assert [frame.endswith("in helper()") for frame in frames_of(texts["helper()"])] == [False, True]


@pytest.mark.parametrize("code", CONDITIONS)
def test_an_error_in_a_function_of_the_user_shows_its_line_and_none_of_ours(texts: dict[str, str], code: str) -> None:
    raised, told = frames_of(texts[code])
    assert "in <lambda>(" in raised
    assert CONDITIONS[code] in texts[code]
    assert not told.startswith("File")


def test_a_fault_of_robowidgets_shows_every_frame(texts: dict[str, str]) -> None:
    assert ["data.py" in frame for frame in frames_of(texts[FAULT])] == [False, True, True, True]
