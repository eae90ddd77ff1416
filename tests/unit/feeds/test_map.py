"""The map of a running robot: its topics on one widget, over two middlewares."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import foxglove
import pytest

from robowidgets import LaserWidget, PathWidget, Range, SonarWidget, feeds
from robowidgets.path.packing import unpack_layers

from ... import map_scene as scene
from ..waiting import wait_for
from .bridge import Rosbridge
from .fox import serving

foxglove.set_log_level("CRITICAL")

Publish = Callable[[str, dict[str, Any]], None]
EVERY = 0.05
"""Seconds between two rounds of messages: a flooded connection needs time."""


@cache
def messages(seconds: float) -> dict[str, dict[str, Any]]:
    """Return the last message of each topic of the scene: it takes a second to compute."""
    return {topic: fields for _, topic, fields in scene.messages(seconds)}


@pytest.fixture
def left_out() -> str:
    """A topic that the robot does not have."""
    return ""


@pytest.fixture(params=["foxglove", "rosbridge"])
def robot(request: pytest.FixtureRequest, left_out: str) -> Iterator[tuple[Any, Publish]]:
    """Yield a feed of a robot with a map, and a function that publishes on one of its topics."""
    types = {topic: kind for topic, kind in scene.TYPES.items() if topic != left_out}
    if request.param == "foxglove":
        with serving(types) as (address, publish), feeds.foxglove(address) as feed:
            yield feed, publish
        return
    with Rosbridge(types) as bridge, feeds.rosbridge(bridge.address) as feed:

        def publish(topic: str, fields: dict[str, Any]) -> None:
            if topic in bridge.subscribed:
                bridge.publish(topic, fields)

        yield feed, publish


def layers(path: PathWidget) -> dict[str, Any]:
    path.send_newest()
    state = path.get_state()
    names = {layer["number"]: layer["name"] for layer in state["_map"].get("layers", ())}
    return {names[one.number]: one for one in unpack_layers(bytes(state["_frame"])[64:])}


@pytest.mark.slow
def test_a_robot_has_its_topics_on_one_map_joined_by_tf_with_its_scan(robot: tuple[Any, Publish]) -> None:
    feed, publish = robot
    wait_for(lambda: len(feed.topics) == len(scene.TYPES), "its topics are listed")
    view = feed.show("/map", "/odom", "/amcl_pose", "/plan", "/particles")
    (path,) = {widget for topic, widget in view.widgets.items() if isinstance(widget, PathWidget)}
    assert view.widgets["/map"] is view.widgets["/plan"] is path
    told = dict(messages(2.0))
    drawn: dict[str, Any] = {}

    def all_drawn() -> bool:
        for topic, fields in told.items():
            publish(topic, fields)
        drawn.update(layers(path))
        return drawn.keys() >= {"/map", "/odom", "/amcl_pose", "/plan", "/particles", "/scan"}

    wait_for(all_drawn, "all layers are drawn", every=EVERY)
    assert path.get_state()["_about"]["frame_id"] == "map"
    shift = told["/tf"]["transforms"][0]["transform"]["translation"]
    at = told["/odom"]["pose"]["pose"]["position"]
    assert drawn["/odom"].pose.x == pytest.approx(shift["x"] + at["x"], abs=0.05)
    sure = told["/amcl_pose"]["pose"]["covariance"]
    assert drawn["/amcl_pose"].scatter == (sure[0], sure[1], sure[7])
    assert len(drawn["/scan"].points) > 100
    assert len(drawn["/particles"].points) == 40
    assert path.get_state()["_grids"], "the map, once"


@pytest.mark.slow
def test_layers_are_connected_one_by_one_too(robot: tuple[Any, Publish]) -> None:
    feed, publish = robot
    path = PathWidget()
    topics = ("/tf", "/odom", "/amcl_pose")
    for topic in topics:
        feed.connect(topic, path)
    told = dict(messages(1.0))

    def is_drawn() -> bool:
        for topic in topics:
            publish(topic, told[topic])
        return layers(path).keys() == {"/odom", "/amcl_pose"} and path.get_state()["_about"]["frame_id"] == "map"

    wait_for(is_drawn, "odometry is drawn in the frame of the map", every=EVERY)


@pytest.mark.slow
def test_sonars_are_where_tf_says_by_themselves(robot: tuple[Any, Publish]) -> None:
    feed, publish = robot
    sonars = SonarWidget()
    feed.connect("/scan", LaserWidget())
    feed.connect("/sonar/front", sonars)
    sonars.update("front", Range(0.5, frame_id="laser"))
    told = dict(messages(1.0))

    def has_place() -> bool:
        publish("/tf", told["/tf_static"])
        publish("/scan", told["/scan"])
        return bool(sonars._mounts)

    wait_for(has_place, "a sonar has a place", every=EVERY)
    assert "laser" in sonars._mounts


@pytest.mark.slow
@pytest.mark.parametrize("left_out", ["/tf", "/odom"])
def test_a_laser_with_a_trail_takes_the_odometry_of_its_robot_or_its_tf_by_itself(
    robot: tuple[Any, Publish], left_out: str
) -> None:
    feed, publish = robot
    laser = LaserWidget(trail=5)
    feed.connect("/scan", laser)
    told = dict(messages(1.0))
    base = scene.plain(scene.tf("odom", "base_link", (1.0, 2.0, 0.0), 1.0))
    told["/tf"] = {
        "transforms": [one for part in (told["/tf"], base, told["/tf_static"]) for one in part["transforms"]]
    }

    def has_pose() -> bool:
        for topic in {"/odom", "/tf", "/scan"} - {left_out}:
            publish(topic, told[topic])
        laser.send_newest()
        return "pose" in laser.get_state()["_about"]

    wait_for(has_pose, "a scan has the pose of its robot", every=EVERY)
    if left_out == "/odom":
        assert laser.get_state()["_about"]["pose"] == [1.0, 2.0, 0.0]
    laser.trail = 0
    left = feed.connection.by_topic.keys()
    assert left - {"/tf", "/tf_static"} == {"/scan"}, "in addition to tf, which relates the angles to the robot"
