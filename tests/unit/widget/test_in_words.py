"""The text of an output, which is on show where no page draws the widget."""

from __future__ import annotations

from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

import robowidgets
from robowidgets import LaserWidget
from robowidgets.widget.in_words import HOW_TO_DRAW

from ..pages import display


def text(shown: Any) -> str:
    """The text of an output that shows something."""
    data = display(shown)
    assert "application/vnd.jupyter.widget-view+json" in data
    return str(data["text/plain"])


def test_the_text_of_a_widget_has_its_numbers_and_how_to_get_a_picture() -> None:
    laser = LaserWidget(title="/scan")
    laser.update(ranges=[1.0, 2.5, 3.0], angle_min=0.0, angle_increment=0.1, range_min=0.1, range_max=5.0)
    assert text(laser).splitlines() == [repr(laser), HOW_TO_DRAW]
    assert "nearest 1.00 m at ranges[0]" in text(laser)


def test_the_text_of_a_player_has_a_line_for_each_of_its_widgets() -> None:
    player = robowidgets.open(robowidgets.SAMPLE).show("/scan", "/odom")
    player.time = 20.0
    first, *lines, last = text(player).splitlines()
    assert first == repr(player)
    assert {repr(view.widget) for view in player.views} <= set(lines)
    assert "nearest" in "".join(line for line in lines if line.startswith("<LaserWidget /scan: "))
    assert last == HOW_TO_DRAW
    player.close()


def test_the_text_of_a_view_of_wires_has_its_topics() -> None:
    recording = robowidgets.open(robowidgets.SAMPLE)
    view = recording.wires()
    assert text(view).splitlines() == [repr(view), repr(view.wires), HOW_TO_DRAW]
    view.close()


@pytest.mark.slow
def test_a_notebook_that_runs_without_a_page_has_the_numbers_in_its_outputs() -> None:
    source = """
from robowidgets import SpeedWidget
speed = SpeedWidget(title="/odom")
speed.update(linear=(0.25, 0, 0), angular=(0, 0, -0.5))
speed"""
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source)])
    NotebookClient(notebook, timeout=60, store_widget_state=False).execute()
    (output,) = notebook.cells[0].outputs
    lines = output.data["text/plain"].splitlines()
    assert "0.25" in lines[0]
    assert lines[-1] == HOW_TO_DRAW
