"""Cells with events, for the tests of their widget."""

from __future__ import annotations

ROBOT = """
from robowidgets import EventsWidget
events = EventsWidget(title="/rosout, /diagnostics")
_lines = [
    (0.0, "INFO", "bringup", "robot_state_publisher started"),
    (0.4, "DEBUG", "scan", "first packet of 1080 rays"),
    (1.2, "INFO", "follower", "looking for the wall on the right"),
    *((2.0 + 0.5 * i, "WARN", "scan", "12 rays were lost") for i in range(14)),
    (9.5, "INFO", "joy", "button 0 pressed"),
    (9.8, "INFO", "joy", "button 0 released"),
    (11.0, "ERROR", "base: left motor", "over current: 4.2 A, limit 3.0 A\\nthe driver is off until it is reset"),
    (12.5, "INFO", "follower", "wall at 0.42 m, and the robot turns away from it by 20 degrees"),
    (14.0, "FATAL", "bringup", "no contact to the base for 2 s: all nodes end"),
    (15.0, "WARN", "battery", "stale: no data for 5 s"),
]
for _time, _level, _source, _text in _lines:
    events.add(_text, level=_level, source=_source, time=_time)
events
"""
EMPTY = """
from robowidgets import EventsWidget
empty = EventsWidget(title="/rosout")
empty
"""
MANY = """
from robowidgets import EventsWidget
many = EventsWidget(title="/rosout")
for _i in range(3000):
    many.add(f"line {_i}", source=f"node_{_i % 3}", time=0.01 * _i)
many
"""
HOSTILE = """
from robowidgets import EventsWidget
hostile = EventsWidget(title="<i>t</i>")
hostile.add("<img src=x onerror=alert(1)>", level="ERROR", source="<b>node</b>")
hostile.add("\\u202ertl \\u0000 \\ud800 end\\n" + "x" * 3_000_000, source="n" * 500)
hostile
"""
RECORDING = """
import tempfile
from pathlib import Path
import robowidgets
from tests.unit.recordings import recorded
from tests.unit.recordings.sweeps import START_NS, TYPE, scan
_line = lambda text, level=20, name="node": {"level": level, "name": name, "msg": text}
_status = lambda level, text: {"status": [{"level": level, "name": "motor", "message": text, "values": []}]}
_messages = [
    *((i / 10, "/scan", scan(START_NS, [1.0 + i % 20 / 10] * 61)) for i in range(101)),
    (0.0, "/rosout", _line("started")),
    (0.5, "/diagnostics", _status(0, "fine")),
    (2.0, "/rosout", _line("lost the line", 30, "follower")),
    *((3.0 + i / 5, "/rosout", _line("no new map", 20, "amcl")) for i in range(5)),
    (5.0, "/diagnostics", _status(2, "over current")),
    (7.0, "/rosout", _line("lost the map", 40, "amcl")),
    (9.0, "/rosout", _line("found it again", 20, "amcl")),
]
_types = {"/scan": TYPE, "/rosout": "rcl_interfaces/msg/Log", "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray"}
_folder = Path(tempfile.mkdtemp()) / "drive"
recording = robowidgets.open(recorded.write(_folder, _types, sorted(_messages, key=lambda one: one[0])))
player = recording.show("/scan", "/rosout", "/diagnostics", scanogram=True)
player
"""
