"""The camera of a running robot: overlays on its picture, and its depth image as a laser, over two middlewares."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import foxglove
import numpy as np
import pytest

from robowidgets import feeds
from robowidgets.feeds import Feed
from robowidgets.feeds.simulator import Simulated
from robowidgets.messages.encoding import encode

from ... import camera_drive
from ...reserved import free_domain
from ..clocks import ManualClock
from ..cloud.test_cloud_widget import cloud_message
from ..pages import get_newest
from ..waiting import wait_for
from .fox import definition, serving

foxglove.set_log_level("CRITICAL")

Publish = Callable[[str, Any], object]
Robot = tuple[Feed, Publish]

IMAGE, DEPTH = "/camera/image_raw", "/camera/depth/image_rect_raw"
CLOUD = "/points"


@pytest.fixture
def simulated() -> Any:
    return camera_drive.robot()


@pytest.fixture
def types(simulated: Any) -> dict[str, str]:
    return {**camera_drive.types(simulated), CLOUD: "sensor_msgs/msg/PointCloud2"}


@pytest.fixture(params=["foxglove", "dds"])
def robot(request: pytest.FixtureRequest, types: dict[str, str]) -> Iterator[Robot]:
    """Yield a feed of a robot with a camera, and a function that publishes fields on one of its topics."""
    if request.param == "foxglove":
        with serving(types) as (address, publish), feeds.foxglove(address) as feed:
            yield feed, publish
        return
    pytest.importorskip("cyclonedds", reason="cyclonedds is not installed: pip install cyclonedds")
    from cyclonedds.domain import DomainParticipant
    from cyclonedds.pub import DataWriter
    from cyclonedds.qos import Policy, Qos
    from cyclonedds.topic import Topic

    from robowidgets.feeds._dds_types import dds_topic, struct

    participant = DomainParticipant(free_domain())
    kinds = {topic: struct(kind, definition(kind)) for topic, kind in types.items()}
    qos = Qos(Policy.Reliability.Reliable(10**9), Policy.History.KeepLast(1))
    writers = {
        topic: DataWriter(participant, Topic(participant, dds_topic(topic), kind), qos) for topic, kind in kinds.items()
    }
    with feeds.dds(free_domain()) as feed:
        yield (
            feed,
            lambda topic, fields: writers[topic].write(kinds[topic](encode("cdr", types[topic], fields))),
        )


@pytest.mark.slow
def test_its_laser_and_its_sonar_lie_on_its_picture_by_themselves_once_tf_joins_them(
    robot: Robot, simulated: Any
) -> None:
    feed, publish = robot
    there = {one.topic: one for one in camera_drive.offers(simulated)}
    wait_for(lambda: {topic.name for topic in feed.topics} >= there.keys(), "its topics are listed")
    view = feed.show(IMAGE, "/scan")
    image, laser = view.widgets[IMAGE], view.widgets["/scan"]

    def over(*left_out: str) -> dict[str, Any]:
        simulated.step(0.05)
        for topic, offer in there.items():
            if topic not in left_out:
                publish(topic, camera_drive.fields(offer))
        image.send_newest()
        found: dict[str, Any] = image.get_state()["_about"].get("over", {})
        return found

    lost = "no tf from laser to camera_optical_frame"
    wait_for(lambda: lost in over("/tf").get("missing", ()), "it says what is missing")
    told: dict[str, Any] = {}

    def all_of_it() -> bool:
        told.clear()
        told.update(over())
        kinds = {one["kind"] for one in told.get("drawn", ())}
        return {"area", "cone", "arc"} <= kinds and "missing" not in told and abs(told["apart"]) <= 0.1

    wait_for(all_of_it, "all of it is there")
    assert told["laser"] == laser.model_id
    # The camera sees each reading at the distance of the laser, except at an edge.
    seen = image.seen
    rays = np.flatnonzero(np.isfinite(seen.pixels).all(axis=1))
    columns, rows = np.round(seen.pixels[rays]).astype(int).T
    ahead = simulated.depth_image().depth[rows, columns]
    assert len(rays) > 50
    assert np.mean(np.abs(ahead - seen.scan.x[rays] - 0.05) < 0.05) > 0.9  # the scanner is 5 cm ahead of the camera
    laser.sectors["near"] = ("-10deg", "10deg")
    wait_for(lambda: "near" in [one["name"] for one in over().get("drawn", ())], "a sector is on the picture")
    image.overlay = False
    left = feed.connection.by_topic.keys()
    assert left - {"/tf"} == {IMAGE, "/scan"}, "in addition to tf, which relates the angles of the laser to the robot"


def test_its_depth_image_and_its_cloud_are_lasers_where_that_is_asked_for(robot: Robot, simulated: Any) -> None:
    feed, publish = robot
    there = {one.topic: one for one in camera_drive.offers(simulated)}
    wait_for(lambda: {topic.name for topic in feed.topics} >= {*there, CLOUD}, "its topics are listed")
    view = feed.show(f"{DEPTH} as scan", f"{CLOUD} as scan")
    of_depth, of_cloud = view.widgets[DEPTH], view.widgets[CLOUD]
    cloud = cloud_message(np.array([(1.5, 0, 0.2)], [(axis, "f4") for axis in "xyz"]))

    def said() -> str:
        publish(DEPTH, camera_drive.fields(there[DEPTH]))
        return str(get_newest(of_depth).about.get("error", ""))

    wait_for(lambda: said().startswith("no camera_info"), "it says what is missing")

    def came() -> bool:
        for topic in (DEPTH, "/camera/camera_info"):
            publish(topic, camera_drive.fields(there[topic]))
        publish(CLOUD, cloud)
        return bool(of_depth.scan and of_cloud.scan)

    wait_for(came, "both are scans")
    assert of_cloud.scan.distance() == 1.5
    rays = [ray for ray in of_depth.scan if ray.source is not None]
    assert len(rays) > 100
    depth = simulated.depth_image().depth.flat
    assert [depth[ray.source] for ray in rays] == pytest.approx([ray.x for ray in rays], rel=0.005)


def test_the_simulated_robot_has_a_camera_where_that_is_asked_for() -> None:
    with feeds.simulator("pioneer") as feed:
        assert not [topic.name for topic in feed.topics if topic.name.startswith("/camera")]
    clock = ManualClock()
    simulated = camera_drive.robot()
    with Feed(Simulated(simulated, 10.0, False, False, clock), clock=clock) as feed:
        view = feed.show(IMAGE, "/scan", "/sonar/front_3")
        clock.advance(1.01)
        wait_for(lambda: view.widgets[IMAGE].seen, "a picture came")
        seen = view.widgets[IMAGE].seen
    assert (seen.missing, abs(seen.apart) <= 0.1) == ((), True)
    assert {"area", "cone"} <= {one.kind for one in seen.drawn}
    with pytest.raises(TypeError, match="which has its world, scanner and camera"):
        feeds.simulator(simulated, camera=True)
    with pytest.raises(TypeError, match="camera: expected True or False, got 1"):
        feeds.simulator(camera=1)  # type: ignore[arg-type]
