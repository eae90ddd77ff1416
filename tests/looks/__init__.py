"""The looks of the widgets: how they draw their states, kept as text in this folder, with small pictures for the eye.

`python -m tests.looks` writes both again; review their changes. Each room has its states in ``looks.py`` of its tests.
"""

from __future__ import annotations

import base64
import json
import re
import subprocess
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from importlib import import_module
from pathlib import Path
from typing import Any
from unittest.mock import patch

from robowidgets.widget.robot_widget import RobotWidget

from ..conftest import ROOT
from ..node import ENVIRONMENT

FOLDER = Path(__file__).parent
WIDTHS = {"wide": 640, "narrow": 280}
THEMES = ("light", "dark")
NOW = 100.0
"""Seconds of the monotonic clock."""

_NOT_DRAWN = ("_esm", "_css", "_script", "_style", "_anywidget_id", "layout", "tabbable", "tooltip")
_COLOR = re.compile(r"#[0-9a-f]{3,8}\b|rgba?\([^)]*\)")
_FONT = re.compile(r'(?<=px )((?:ui-monospace|"SF Mono")[^;}\n]*monospace|system-ui[^;}\n]*sans-serif)')


@dataclass(frozen=True, kw_only=True)
class Look:
    """A state of a widget.

    Args:
        make: returns the widget in this state.
        steps: the acts of a user then: ``{"event": "pointermove", "at": (200, 100)}``, ``{"event": "click", "on":
            ".rw-zoom"}``, ``{"event": "keydown", "key": "?"}``, or ``{"pass": 5000}`` for milliseconds that pass.
        height: pixels of the picture in the text.
        traits: values that replace those of the widget.
    """

    make: Callable[[], Any]
    steps: Sequence[Mapping[str, Any]] = ()
    height: int = 240
    traits: Mapping[str, Any] = field(default_factory=dict)

    def state(self) -> tuple[str, dict[str, Any]]:
        """Return the name of the script of its widget, and its traits."""
        clock = patch.multiple("time", monotonic=lambda: NOW, monotonic_ns=lambda: round(NOW * 1e9))
        with clock, patch.object(RobotWidget, "rate", 10.0), closing(self.make()) as widget:
            script = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", type(widget).__name__).lower()
            state = widget.get_state()
        drawn = {name: value for name, value in state.items() if name not in _NOT_DRAWN and name[:6] != "_model"}
        if "robot" in drawn.get("_source", {}):  # a random name
            drawn["_source"] = {**drawn["_source"], "robot": "robot"}
        return script, {**drawn, **self.traits}


def every() -> dict[str, Look]:
    """Return the states of all widgets by name, such as ``"laser/stale"``."""
    files = sorted((ROOT / "tests" / "unit").glob("*/looks.py"))
    rooms = [import_module(f"tests.unit.{file.parent.name}.looks").LOOKS for file in files]
    return {name: look for room in rooms for name, look in room.items()}


def draw(looks: Iterable[Look]) -> list[str]:
    """Return the text of each look: wide and narrow, in light and dark."""
    states = [(look, *look.state()) for look in looks]
    requests = [
        {
            "script": script,
            "traits": traits,
            "width": width,
            "height": look.height,
            "theme": theme,
            "steps": look.steps,
        }
        for look, script, traits in states
        for width in WIDTHS.values()
        for theme in THEMES
    ]
    ended = subprocess.run(
        ["node", "--no-warnings", ROOT / "tests" / "js" / "looks" / "looks.ts"],
        env=ENVIRONMENT,
        input=json.dumps(requests, default=encode),
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert ended.returncode == 0, ended.stderr
    drawn = iter([_FONT.sub(_family, "\n".join(lines)) for lines in json.loads(ended.stdout)])
    return [_text({width: (next(drawn), next(drawn)) for width in WIDTHS}) for _ in states]


def file_of(name: str) -> Path:
    """Return the file of the text of a look."""
    return FOLDER / f"{name}.txt"


def encode(value: Any) -> Any:
    """Return bytes for JSON."""
    if isinstance(value, (bytes, bytearray, memoryview)):
        return {"base64": base64.b64encode(bytes(value)).decode()}
    raise TypeError(f"expected a value of a trait, got {value!r}")


def _family(found: re.Match[str]) -> str:
    return "mono" if "mono" in found[0] else "sans"


def _text(drawn: Mapping[str, tuple[str, str]]) -> str:
    """Return one text for all widths and themes.

    A colour is followed by the colour in dark. Lines that are the same in the first width are left out.
    """
    parts: list[str] = []
    first: list[str] = []
    for width, (light, dark) in drawn.items():
        colors = iter(_COLOR.findall(dark))
        if _COLOR.sub("", light) == _COLOR.sub("", dark):
            both = _COLOR.sub(lambda found, colors=colors: "|".join(dict.fromkeys((found[0], next(colors)))), light)  # type: ignore[misc]
        else:
            both = f"{light}\n== {width}, dark\n{dark}"
        lines = both.splitlines()
        parts += [f"== {width}", *(_changed(first, lines) if first else lines)]
        first = first or lines
    return "\n".join(parts) + "\n"


def _changed(before: list[str], lines: list[str]) -> list[str]:
    """Return the lines, with a mark instead of several that are the same as before."""
    changes = SequenceMatcher(None, before, lines, autojunk=False).get_opcodes()
    return [
        line
        for tag, _, _, start, end in changes
        for line in (["  \u2026"] if tag == "equal" and end - start > 1 else lines[start:end])
    ]
