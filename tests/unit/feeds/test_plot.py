"""Fields of a running robot over time."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

import pytest

import robowidgets
from robowidgets import feeds
from robowidgets.feeds import Feed

from ..waiting import wait_for
from .scripted import IMU, ODOM, Scripted

TURN, SPEED = "/imu.angular_velocity.z", "/odom.twist.twist.linear.x"


@pytest.fixture
def script() -> Scripted:
    return Scripted(IMU, ODOM)


@pytest.fixture
def feed(script: Scripted) -> Iterator[Feed]:
    with Feed(script) as opened:
        yield opened


def test_each_message_adds_its_numbers_whatever_the_middleware_hands_over(feed: Feed, script: Scripted) -> None:
    plot = robowidgets.plot(feed, TURN, "/imu.covariance[1]", SPEED, title="drive")
    for i in range(50):
        script.listener.on_message("/imu", {"angular_velocity": {"z": i / 10}, "covariance": [0.0, i]})
    linear = SimpleNamespace(linear=SimpleNamespace(x=0.2))
    script.listener.on_message("/odom", SimpleNamespace(twist=SimpleNamespace(twist=linear)))
    wait_for(lambda: len(plot.names) == 3 and len(plot[TURN][0]) == 50, "all have come")
    times, values = plot[TURN]
    assert values.tolist() == [i / 10 for i in range(50)]
    assert times[0] == 0.0
    assert (times[1:] >= times[:-1]).all()
    assert plot["/imu.covariance[1]"][1].tolist() == list(range(50))
    assert plot[SPEED][1].tolist() == [0.2]
    assert (plot.units[TURN], plot.units[SPEED], plot.title) == ("rad/s", "m/s", "drive")


def test_a_field_that_is_not_there_is_named_on_the_plot_while_other_topics_go_on(feed: Feed, script: Scripted) -> None:
    plot = robowidgets.plot(feed, "/imu.angular_velocity.w", SPEED)
    script.listener.on_message("/imu", {"angular_velocity": {"z": 0.1}})
    wait_for(lambda: plot.get_state()["_facts"]["error"] != "", "the plot says so")
    script.listener.on_message("/odom", {"twist": {"twist": {"linear": {"x": 0.2}}}})
    wait_for(lambda: plot.names == (SPEED,), "the other one has come")
    expected = "no field 'w'; angular_velocity is a dict with the keys z."
    assert plot.get_state()["_facts"]["error"] == f"/imu.angular_velocity.w: {expected}"


def test_a_closed_plot_gets_no_more_messages(feed: Feed, script: Scripted) -> None:
    plot = robowidgets.plot(feed, TURN)
    assert [function.topic for function in feed.functions] == ["/imu"]
    plot.close()
    script.listener.on_message("/imu", {"angular_velocity": {"z": 0.1}})
    wait_for(lambda: feed.functions == (), "it is disconnected")


def test_two_plots_of_one_topic_both_get_it(feed: Feed, script: Scripted) -> None:
    plots = [robowidgets.plot(feed, TURN) for _ in range(2)]
    script.listener.on_message("/imu", {"angular_velocity": {"z": 0.1}})
    wait_for(lambda: all(plot.names for plot in plots), "both have it")


def test_what_can_not_be_plotted_live_is_refused(feed: Feed) -> None:
    with pytest.raises(TypeError, match="derivative is for recordings"):
        robowidgets.plot(feed, TURN, derivative=True)
    with pytest.raises(TypeError, match="expected a field of /imu"):
        robowidgets.plot(feed, "/imu")
    with pytest.raises(ValueError, match="at most 8 lines"):
        robowidgets.plot(feed, *(f"/imu.covariance[{i}]" for i in range(9)))
    assert feed.functions == ()


def test_the_speed_of_the_simulated_robot_is_plotted_as_it_drives() -> None:
    speed = "/odom.linear[0]"
    with feeds.simulator() as robot:
        plot = robowidgets.plot(robot, speed)
        wait_for(lambda: plot.names == (speed,) and plot[speed][1].max() > 0, "it drives")
        assert plot.units == {speed: "m/s"}
        assert plot.get_state()["_facts"]["error"] == ""
