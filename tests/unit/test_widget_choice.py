"""Which topics share a widget."""

from __future__ import annotations

import pytest

from robowidgets._widget_choice import choose_widgets
from robowidgets.feeds._topics import FeedTopic
from robowidgets.kinds import is_command


@pytest.mark.parametrize(
    ("topics", "command_of"),
    [
        (["/odom", "/cmd_vel"], {"/odom": "/cmd_vel"}),
        (["/odom", "/mobile_base/commands/velocity"], {"/odom": "/mobile_base/commands/velocity"}),
        (["/wheel/odom", "/cmd_vel"], {"/wheel/odom": "/cmd_vel"}),
        (["/odom", "/twist", "/cmd_vel"], {"/odom": "/cmd_vel", "/twist": "/cmd_vel"}),
        (["/odom", "/cmd_vel", "/cmd_vel_mux/input"], {"/odom": "/cmd_vel"}),
        (
            ["/robot1/odom", "/robot1/cmd_vel", "/robot2/odom", "/robot2/cmd_vel"],
            {"/robot1/odom": "/robot1/cmd_vel", "/robot2/odom": "/robot2/cmd_vel"},
        ),
        (["/robot1/odom", "/robot2/odom", "/robot2/cmd_vel"], {"/robot2/odom": "/robot2/cmd_vel"}),
        (["/cmd_vel"], {}),
    ],
    ids=str,
)
def test_a_measured_speed_gets_the_command_of_its_own_robot(topics: list[str], command_of: dict[str, str]) -> None:
    shown = [FeedTopic(name, "", "speed", is_command(name), offered=True, wanted=None) for name in topics]
    chosen = choose_widgets(shown)
    assert {choice.topic: choice.command for choice in chosen if choice.command} == command_of
    assert {choice.topic for choice in chosen} == set(topics) - set(command_of.values())


def test_a_command_alone_is_shown_as_one() -> None:
    topics = [("/scan", "laser"), ("/odom", "speed"), ("/cmd_vel", "speed"), ("/cmd_vel_mux/input", "speed")]
    shown = [
        FeedTopic(name, "", widget, widget == "speed" and is_command(name), offered=True, wanted=None)  # type: ignore[arg-type]
        for name, widget in topics
    ]
    assert [(choice.topic, choice.commanded) for choice in choose_widgets(shown)] == [
        ("/scan", False), ("/odom", False), ("/cmd_vel_mux/input", True)
    ]  # fmt: skip
    assert [choice.make().bars for choice in choose_widgets(shown)[1:]] == ["measured", "commanded"]
    assert [choice.make().bars for choice in choose_widgets(shown[2:])] == ["commanded", "commanded"]


def test_odometry_has_a_path_beside_its_speed_and_a_command_has_none() -> None:
    odometry = "nav_msgs/msg/Odometry"
    shown = [
        FeedTopic(name, of, "speed", is_command(name), offered=True, wanted=None)
        for name, of in (("/odom", odometry), ("/twist", "geometry_msgs/msg/Twist"), ("/odom_cmd", odometry))
    ]
    chosen = choose_widgets(shown)
    assert [(choice.shown.name, choice.topic) for choice in chosen] == [
        ("speed", "/odom"), ("speed", "/twist"), ("path", "/odom")
    ]  # fmt: skip
    assert type(chosen[-1].make()).__name__ == "PathWidget"


def test_a_speed_of_a_topic_has_no_limits_until_somebody_sets_them() -> None:
    shown = [FeedTopic("/odom", "", "speed", commanded=False, offered=True, wanted=None)]
    speed = choose_widgets(shown)[0].make()
    speed.update(linear=(3.0, 0.0, 0.0))
    assert (speed.linear_limits, speed.angular_limits, speed.limits_of("linear.x")) == (None, None, None)
    assert speed.over_limits == {}
    speed.linear_limits = 0.5
    assert speed.over_limits == {"linear.x": 3.0}
