"""The data of a recording about the program that drove: its versions and its states."""

from __future__ import annotations

from pathlib import Path

import pytest

import robowidgets
from robowidgets import RecordingError
from robowidgets.samples.state_span import StateSpan, rows_of

from . import program_run

A, B, C, D = ((i, i + 1) for i in range(4))


def spans(*given: tuple[tuple[float, float], str]) -> list[StateSpan]:
    return [StateSpan(*span, path) for span, path in given]


def test_states_and_versions_of_a_recording_are_data(tmp_path: Path) -> None:
    with robowidgets.open(program_run.write(tmp_path / "run")) as recording:
        assert recording.states == (
            StateSpan(0, 4, "Walker.forward"),
            StateSpan(4, 5, "Walker.avoid.stop"),
            StateSpan(4, 7, "Walker.avoid"),
            StateSpan(5, 7, "Walker.avoid.turn_left"),
            StateSpan(7, 10, "Walker.forward"),
        )
        assert (recording.states[1].machine, recording.states[1].name) == ("Walker.avoid", "stop")
        assert recording.programs == (
            (0, "Walker", 1, "class Walker:\n    v = 1\n"),
            (3, "Walker", 2, "class Walker:\n    v = 2\n"),
        )
        assert repr(recording).splitlines()[0].endswith(", 4 topics, 109 messages, 2 program versions")
    with pytest.raises(RecordingError, match="is closed"):
        _ = recording.states
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        assert (recording.states, recording.programs) == ((), ())


def test_the_player_and_the_scanogram_of_a_recording_show_its_states(tmp_path: Path) -> None:
    recording = robowidgets.open(program_run.write(tmp_path / "run"))
    outer = [(0, 4, "Walker.forward"), (4, 7, "Walker.avoid"), (7, 10, "Walker.forward")]
    inner = [(4, 5, "Walker.avoid.stop"), (5, 7, "Walker.avoid.turn_left")]
    with recording:
        player = recording.show()
        assert player.scanogram is not None
        assert [list(row) for row in player.scanogram.states] == [outer, inner]
        assert [list(row) for row in player.bar.states] == [outer]
        player.close()
        player = recording.show(scanogram=False)
        assert [list(row) for row in player.bar.states] == [outer, inner]
        player.close()


def test_nested_machines_stand_below_and_share_a_row_where_they_do_not_overlap() -> None:
    rows = rows_of(spans((A, "W.a"), (B, "W.b"), (A, "W.a.x"), (B, "W.b.y")))
    assert [[span.path for span in row] for row in rows] == [["W.a", "W.b"], ["W.a.x", "W.b.y"]]


def test_machines_side_by_side_have_a_row_each_and_there_are_three_at_most() -> None:
    rows = rows_of(spans(*((A, f"W.both.{machine}.x") for machine in "abcd"), (A, "W.both")))
    assert [[span.path for span in row] for row in rows] == [["W.both"], ["W.both.a.x"], ["W.both.b.x"]]
    assert rows_of([]) == []


def test_thousands_of_states_take_no_time_worth_noticing() -> None:
    many = [StateSpan(i, i + 1, f"W.a.{'xy'[i % 2]}") for i in range(20_000)]
    assert [len(row) for row in rows_of([*many, StateSpan(0, 20_000, "W.a")])] == [1, 20_000]
