"""The messages of a simulated robot's view to the page, and the edits of the page that it accepts."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
import pytest

from robowidgets import Arc, LaserWidget, Line, feeds
from robowidgets.simulator import Robot, Scanner, View, World, room
from robowidgets.simulator.view import HEADER, PATH_SECONDS

from ..pages import from_page, get_observers, synced
from ..waiting import wait_for

WORLD = World([(3.0, -2.0, 3.0, 2.0)], [(0.0, 1.5, 0.25)])
EXACT = Scanner(ray_count=3, field_of_view=3.0, noise=0.0, resolution=0.0, dropout=0.0, range_max=4.0)


def shown(view: View) -> tuple[tuple[float, ...], np.ndarray, np.ndarray, np.ndarray]:
    """Header, ranges, path and obstacles of the state that a new page gets."""
    frame = view.get_state()["_frame"]
    header = HEADER.unpack_from(frame)
    rays, places, discs = (int(count) for count in header[-3:])
    values = np.frombuffer(frame, "<f4", offset=HEADER.size)
    assert len(values) == rays + 3 * (places + discs)
    path, obstacles = values[rays : rays + 3 * places], values[rays + 3 * places :]
    return header, values[:rays], path.reshape(-1, 3), obstacles.reshape(-1, 3)


def edit(view: View, **content: Any) -> str:
    """The answer to an edit of the page: the reason why it was refused."""
    answers: list[Any] = []
    view.send = answers.append  # type: ignore[method-assign]
    from_page(view, {"edit": "a-1", **content})
    (answer,) = answers
    assert answer["edit"] == "a-1"
    return str(answer["refused"])


def test_a_page_gets_the_robot_its_scan_its_path_and_the_room() -> None:
    robot = Robot(WORLD, (0.5, 0.0, 0.0), scanner=EXACT)
    view = View(robot)
    robot.drive(0.5, 0.0)
    for _ in range(20):
        robot.step(0.05)
    header, ranges, path, obstacles = shown(view)
    assert header[:5] == (1.0, *robot.pose, 0.18)
    assert header[5:8] == tuple(robot.scan_pose)
    assert header[8:11] == pytest.approx((-1.5, 1.5, 4.0))
    assert ranges.tolist() == [np.inf, pytest.approx(3.0 - robot.scan_pose.x), np.inf]
    assert path[-1, 1] == pytest.approx(robot.pose.x, abs=0.1)
    assert np.diff(path[:, 1]).min() > 0.04
    assert obstacles.tolist() == [[0.0, 1.5, 0.25]]
    assert np.frombuffer(synced(view, "_walls"), "<f4").tolist() == [3, -2, 3, 2]
    assert repr(view) == f"<View simulator: robot at x {robot.pose.x:.2f}, y 0.00 m, 1 obstacle>"
    view.close()


def test_a_page_gets_what_is_drawn_on_the_lasers_of_the_robot_until_its_time_is_over() -> None:
    with feeds.simulator(wander=False, hz=50) as feed:
        laser, other, view = LaserWidget(), LaserWidget(), View(feed)
        feed.connect("/scan", laser)
        laser.angle_offset = 0.5
        laser.draw("wall", Line((1, -1), 5), color="green")
        laser.draw("soon", Arc(0.4), lifetime=0.2)
        other.draw("elsewhere", Line((1, -1), (1, 1)))
        wall, soon = view.get_state()["_shapes"]
        assert wall == {"name": "wall", "kind": "line", "at": [[1.0, -1.0], 5], "color": "green", "turned": 0.5}
        assert soon["name"] == "soon"
        wait_for(lambda: synced(view, "_shapes") == [wall], "its time is over")
        sent: list[Any] = []
        view.comm.send = lambda data, **_: sent.append(data["state"])
        laser.draw("wall", None)
        wait_for(lambda: any(state.get("_shapes") == [] for state in sent), "the page gets it with a step")
        count = len(sent)
        wait_for(lambda: len(sent) > count + 3, "steps go on")
        assert not any("_shapes" in state for state in sent[count + 1 :])


def test_a_path_is_as_long_as_the_page_shows_it() -> None:
    robot = Robot(World())
    view = View(robot)
    robot.drive(0.5, 0.0)
    for _ in range(int(2 * PATH_SECONDS)):
        robot.step(1.0)
    times = shown(view)[2][:, 0]
    assert (times[0], times[-1]) == (PATH_SECONDS, 2 * PATH_SECONDS)


def test_edits_of_the_page_move_robot_and_obstacles() -> None:
    robot = Robot(WORLD)
    view = View(robot)
    assert edit(view, act="robot", x=1.0, y=-1.0, yaw=0.5) == ""
    assert robot.pose == pytest.approx((1.0, -1.0, 0.5))
    assert edit(view, act="put", x=-1.0, y=0.0) == ""
    assert edit(view, act="move", index=0, x=0.5, y=1.0) == ""
    assert robot.world.obstacles.tolist() == [[0.5, 1.0, 0.25], [-1.0, 0.0, 0.2]]
    assert robot.world.walls is WORLD.walls
    assert edit(view, act="remove", index=0) == ""
    assert shown(view)[3].tolist() == [[-1.0, 0.0, pytest.approx(0.2)]]
    assert edit(view, act="put", x=0.0, y=0.0) == ""  # the start of the robot
    assert edit(view, act="reset") == ""
    assert (robot.world, robot.pose) == (WORLD, (0, 0, 0))


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ({"act": "robot", "x": 2.9, "y": 0, "yaw": 0}, "pose: expected a place with 0.18 m of room, got (2.9, 0)"),
        ({"act": "robot", "x": float("nan"), "y": 0, "yaw": 0}, "pose.x: expected a finite number"),
        ({"act": "put", "x": 0.1, "y": 0}, "pose: expected a place with 0.18 m of room, got (0, 0)"),
        ({"act": "put", "x": "<b>", "y": 0}, "x: expected a number, got '<b>'"),
        ({"act": "move", "index": 1, "x": 0, "y": 0}, "index: expected an obstacle, 0 to 0, got 1"),
        ({"act": "remove", "index": True}, "index: expected an obstacle, 0 to 0, got True"),
        ({"act": "fly"}, "act: expected robot, put, move, remove or reset, got 'fly'"),
        ({"act": "put"}, "x"),
    ],
)
def test_an_edit_that_cannot_be_made_changes_nothing_and_says_why(
    content: dict[str, Any], words: str, caplog: pytest.LogCaptureFixture
) -> None:
    robot = Robot(WORLD)
    view = View(robot)
    with caplog.at_level(logging.ERROR):
        assert words in edit(view, **content)
    assert robot.world is WORLD
    assert robot.pose == (0, 0, 0)
    assert "an edit of the page was not made" in caplog.text


def test_the_number_of_obstacles_has_a_limit() -> None:
    robot = Robot(World((), [(1.0 + i, 5.0, 0.1) for i in range(200)]))
    assert "expected at most 200 obstacles" in edit(View(robot), act="put", x=9.0, y=9.0)


def test_it_shows_the_robot_of_a_feed_which_runs_in_a_thread() -> None:
    with feeds.simulator(room="office", hz=100.0) as feed:
        view = View(feed)
        before = shown(view)[0][0]
        wait_for(lambda: shown(view)[0][0] > before + 0.1, "its time passes")
        assert edit(view, act="robot", x=5.0, y=3.0, yaw=1.0) == ""
        wait_for(lambda: shown(view)[0][1] == pytest.approx(5.0, abs=0.3), "it is moved while it runs")
        assert view.get_state()["_status"] == ""
    assert view.get_state()["_status"] == "the feed is closed"
    view.close()
    assert get_observers(feed.connection) == []
    with pytest.raises(TypeError, match=r"View\(\): expected a robot of robowidgets.simulator, or its feed, got 'R2'"):
        View("R2")
    with pytest.raises(TypeError, match="has no keyword 'titel'; did you mean 'title'"):
        View(Robot(World()), titel="a")


def test_a_closed_view_leaves_the_robot_alone() -> None:
    robot = Robot(room("maze"))
    view = View(robot)
    assert len(get_observers(robot)) == 1
    view.close()
    assert get_observers(robot) == []
    robot.step(0.1)


def test_another_world_is_taken_where_the_robot_has_room_and_shown() -> None:
    robot = Robot(WORLD)
    view = View(robot)
    robot.world = World([(2.0, -1.0, 2.0, 1.0)])
    shown(view)
    assert np.frombuffer(synced(view, "_walls"), "<f4").tolist() == [2, -1, 2, 1]
    with pytest.raises(ValueError, match=r"pose: expected a place with 0.18 m of room"):
        robot.world = World([(0.0, -1.0, 0.0, 1.0)])
    with pytest.raises(TypeError, match="world: expected World, got 'maze'"):
        robot.world = "maze"  # type: ignore[assignment]
