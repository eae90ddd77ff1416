"""Fields of a running robot over time."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace

import pytest

import robowidgets
from robowidgets import PlotWidget, feeds
from robowidgets.feeds import Advert, Feed

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


def test_a_closed_plot_keeps_no_more_values(feed: Feed, script: Scripted) -> None:
    plot = robowidgets.plot(feed, TURN)
    script.listener.on_message("/imu", {"angular_velocity": {"z": 0.1}})
    assert len(plot[TURN][0]) == 1
    plot.close()
    script.listener.on_message("/imu", {"angular_velocity": {"z": 0.1}})
    assert len(plot[TURN][0]) == 1


def test_a_plot_is_connected_as_any_widget_and_says_what_is_wrong_with_its_topic(feed: Feed, script: Scripted) -> None:
    plot = PlotWidget(TURN, "/cmd_vel.linear.x")
    feed.connect("/imu", plot)
    feed.connect("/cmd_vel", plot)
    assert (plot.title, plot.steps) == ("/", ["/cmd_vel.linear.x"])
    assert plot.get_state()["_facts"]["error"].startswith("waiting for /imu")
    script.listener.on_message("/imu", {"angular_velocity": {"z": 0.1}})
    script.listener.on_message("/cmd_vel", {"linear": {"x": 0.5}})
    assert plot[TURN][1].tolist() == [0.1]
    assert plot["/cmd_vel.linear.x"][1].tolist() == [0.5]
    assert plot.get_state()["_facts"]["error"] == ""


def test_fields_that_are_asked_for_are_a_card_of_the_view(feed: Feed, script: Scripted) -> None:
    view = feed.show(TURN, SPEED, "/odom")
    wait_for(lambda: len(view.widgets) == 2, "both have a widget")
    plot = view.widgets["/imu"]
    assert isinstance(plot, PlotWidget)
    script.listener.on_message("/imu", {"angular_velocity": {"z": 0.1}})
    script.listener.on_missed("/imu", 3)
    assert plot[TURN][1].tolist() == [0.1]
    assert plot.get_state()["_facts"]["missed"] == "3 messages did not come"


def test_two_plots_of_one_topic_both_get_it(feed: Feed, script: Scripted) -> None:
    plots = [robowidgets.plot(feed, TURN) for _ in range(2)]
    script.listener.on_message("/imu", {"angular_velocity": {"z": 0.1}})
    wait_for(lambda: all(plot.names for plot in plots), "both have it")


def test_what_can_not_be_plotted_live_is_refused(feed: Feed) -> None:
    with pytest.raises(TypeError, match="derivative and beside are for recordings"):
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
        wait_for(lambda: plot.names == (speed,) and plot[speed][1].max(initial=0.0) > 0, "it drives")
        assert plot.units == {speed: "m/s"}
        wait_for(lambda: plot.get_state()["_facts"]["error"] == "", "nothing is awaited any more")


def test_a_topic_of_numbers_that_is_asked_for_by_name_has_a_plot_of_its_own(feed: Feed, script: Scripted) -> None:
    view = feed.show("/imu", "/odom.twist.twist.linear.x")
    plot = view.widgets["/imu"]
    assert isinstance(plot, PlotWidget)
    assert plot.fields == (TURN, "/imu.linear_acceleration.x", "/imu.linear_acceleration.y")
    assert view.widgets["/odom"] is not plot
    linear = SimpleNamespace(x=0.1, y=0.2)
    turn = SimpleNamespace(z=0.3)
    script.listener.on_message("/imu", SimpleNamespace(angular_velocity=turn, linear_acceleration=linear))
    wait_for(lambda: len(plot.names) == 3, "its numbers have come")
    assert [plot[name][1].tolist() for name in plot.fields] == [[0.3], [0.1], [0.2]]
    view.arrangement = ["/imu as message"]
    assert type(view.widgets["/imu"]).__name__ == "MessageWidget"
    view.close()


def test_a_plot_of_a_topic_without_usual_numbers_says_that_it_needs_a_field() -> None:
    with Feed(Scripted(Advert("/joints", "sensor_msgs/msg/JointState"))) as feed:
        view = feed.show("/joints as plot")
        (note,) = view.notes
        assert "names no field of its messages to show; name one, as '/joints.FIELD'" in note
        view.close()
