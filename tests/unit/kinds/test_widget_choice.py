"""The topics that share a widget."""

from __future__ import annotations

import pytest

from robowidgets import kinds
from robowidgets.feeds._topics import FeedTopic
from robowidgets.kinds import is_command
from robowidgets.kinds.choice import TopicSelection, choose_instead, choose_widgets
from robowidgets.messages.channel import Channel
from robowidgets.messages.decoding import shape_of
from robowidgets.messages.fields import get
from robowidgets.plots.row import PLOTTED

from ...more_rows.gauges import added
from ...more_rows.on_demand import AnyWidget
from ..pages import synced


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
    assert {choice.topic: choice.topics[1] for choice in chosen if choice.topics[1:]} == command_of
    assert {choice.topic for choice in chosen} == set(topics) - set(command_of.values())


def test_a_command_alone_is_shown_as_one() -> None:
    topics = [("/scan", "laser"), ("/odom", "speed"), ("/cmd_vel", "speed"), ("/cmd_vel_mux/input", "speed")]
    shown = [
        FeedTopic(name, "", widget, widget == "speed" and is_command(name), offered=True, wanted=None)  # type: ignore[arg-type]
        for name, widget in topics
    ]
    assert [(choice.topic, choice.role.commanded) for choice in choose_widgets(shown)] == [
        ("/scan", False), ("/odom", False), ("/cmd_vel_mux/input", True)
    ]  # fmt: skip
    assert [choice.make().bars for choice in choose_widgets(shown)[1:]] == ["measured", "commanded"]
    assert [choice.make().bars for choice in choose_widgets(shown[2:])] == ["commanded", "commanded"]


def test_odometry_has_a_path_next_to_its_speed_and_a_command_has_none() -> None:
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


def test_a_speed_of_a_topic_has_no_limits_until_they_are_set() -> None:
    shown = [FeedTopic("/odom", "", "speed", commanded=False, offered=True, wanted=None)]
    speed = choose_widgets(shown)[0].make()
    speed.update(linear=(3.0, 0.0, 0.0))
    assert (speed.linear_limits, speed.angular_limits, speed.limits_of("linear.x")) == (None, None, None)
    assert speed.over_limits == {}
    speed.linear_limits = 0.5
    assert speed.over_limits == {"linear.x": 3.0}


def listed(**widget_of: str) -> list[FeedTopic]:
    names = {name.replace("__", "/"): widget for name, widget in widget_of.items()}
    return [
        FeedTopic(f"/{name}", "", widget, commanded=False, offered=True, wanted=None) for name, widget in names.items()
    ]


def test_all_topics_of_a_namespace_share_a_widget_where_the_role_is_of_each() -> None:
    with added():
        topics = listed(a__left="gauge", b__left="gauge", scan="laser", a__right="gauge", top="gauge")
        chosen = choose_widgets(topics)
        assert [choice.topics for choice in chosen] == [("/scan",), ("/a/left", "/a/right"), ("/b/left",), ("/top",)]
        assert [choice.titles for choice in chosen[1:]] == [("/a",), ("/b/left",), ("/top",)]
        assert [choice.make().title for choice in chosen[1:]] == ["/a", "/b/left", "/top"]
        more = choose_widgets([*topics, *listed(a__back="gauge", b__back="gauge")])
        assert [one.is_like(other) for one, other in zip(chosen, more, strict=True)] == [True] * 4


def test_what_was_taken_off_is_shown_again_whether_it_was_asked_for_or_added_later() -> None:
    on_show = TopicSelection(["/scan"])
    for entry in ("/scan", "/imu"):
        on_show.add(entry)
        on_show.take_off([entry])
        assert entry not in on_show.entries([], lambda _: True)
        on_show.add(entry)
        assert entry in on_show.entries([], lambda _: True)
    on_show.toggle("/imu")
    assert on_show.entries([], lambda _: True) == ["/scan"]
    on_show.toggle("/imu")
    assert on_show.entries([], lambda _: True) == ["/scan", "/imu"]


def test_what_is_added_to_a_screen_has_its_classes_from_the_start() -> None:
    topics = [
        FeedTopic(name, of, None, commanded=False, offered=True, wanted=None)
        for name, of in (("/joints", "sensor_msgs/msg/JointState"), ("/fix", "sensor_msgs/msg/NavSatFix"))
    ]
    made = {choice.topic: choice.make() for choice in choose_widgets(topics, ["/joints", "/fix"])}
    assert synced(made["/joints"], "_dom_classes") == ("rw-added",)
    assert synced(made["/fix"], "_dom_classes") == ("rw-added", "rw-added-row")


def of_types(**types: str) -> list[FeedTopic]:
    return [FeedTopic(f"/{name}", of, None, commanded=False, offered=True, wanted=None) for name, of in types.items()]


def chosen(topics: list[FeedTopic], *entries: str | list[str]) -> list[tuple[str, tuple[str, ...], tuple[str, ...]]]:
    return [(choice.shown.name, choice.topics, choice.fields) for choice in choose_widgets(topics, entries)]


IMU, NUMBER_TYPE = "sensor_msgs/msg/Imu", "std_msgs/msg/Float32"
IMU_FIELDS = ("/imu.angular_velocity.z", "/imu.linear_acceleration.x", "/imu.linear_acceleration.y")


class TestTopicsOfNumbers:
    def test_have_a_plot_each_if_they_are_asked_for_by_name_and_a_tree_if_that_is_asked_for(self) -> None:
        topics = of_types(imu=IMU, left=NUMBER_TYPE, right=NUMBER_TYPE)
        assert chosen(topics, "/imu") == [("plot", ("/imu",), IMU_FIELDS)]
        assert chosen(topics, "/imu as plot") == chosen(topics, "/imu")
        assert chosen(topics, "/imu as message") == [("message", ("/imu",), ())]
        assert chosen(topics, "/left", "/right") == [
            ("plot", ("/left",), ("/left.data",)), ("plot", ("/right",), ("/right.data",))
        ]  # fmt: skip
        assert choose_widgets(topics, ["/imu"])[0].make().fields == IMU_FIELDS

    def test_share_a_plot_in_a_list_and_with_no_field_that_was_asked_for_elsewhere(self) -> None:
        topics = of_types(imu=IMU, left=NUMBER_TYPE)
        assert chosen(topics, ["/imu", "/left"]) == [("plot", ("/imu", "/left"), (*IMU_FIELDS, "/left.data"))]
        assert chosen(topics, "/left", "/imu.orientation.w") == [
            ("plot", ("/imu",), ("/imu.orientation.w",)), ("plot", ("/left",), ("/left.data",))
        ]  # fmt: skip
        assert len(chosen(topics, "/left", "/left.data")) == 1

    def test_of_many_each_has_room_in_its_plot(self) -> None:
        topics = of_types(**{f"n{i}": NUMBER_TYPE for i in range(12)})
        made = [choice.make() for choice in choose_widgets(topics, [topic.name for topic in topics])]
        assert [widget.fields for widget in made] == [(f"/n{i}.data",) for i in range(12)]

    def test_come_before_trees_if_no_topic_has_a_kind(self) -> None:
        topics = of_types(joints="sensor_msgs/msg/JointState", lux="sensor_msgs/msg/Illuminance")
        shown = choose_instead(topics, lambda _: True)
        assert shown == ["/lux", "/joints"]

    def test_have_the_widget_that_the_user_adds_for_their_type(self) -> None:
        mine = kinds.OnDemandWidget(name="mine", types=frozenset({IMU}), widget=lambda: AnyWidget)
        before = dict(kinds.ON_DEMAND)
        kinds.add(mine)
        try:
            assert chosen(of_types(imu=IMU), "/imu") == [("mine", ("/imu",), ())]
        finally:
            kinds.ON_DEMAND.clear()
            kinds.ON_DEMAND.update(before)

    @pytest.mark.parametrize("type_name", sorted(PLOTTED))
    def test_have_the_fields_that_their_definitions_have(self, type_name: str) -> None:
        shape = shape_of(Channel(0, "", type_name, "cdr", "", 0))
        for field in PLOTTED[type_name]:
            assert isinstance(get(shape, field), str), field


@pytest.mark.parametrize(
    ("widget", "type_name"),
    [
        ("path", "turtlesim/msg/Pose"),
        ("path", "gps_msgs/msg/GPSFix"),
        ("path", "geometry_msgs/msg/PointStamped"),
        ("path", "geometry_msgs/msg/TransformStamped"),
        ("events", "rcl_interfaces/msg/ParameterEvent"),
        ("events", "action_msgs/msg/GoalStatusArray"),
        ("events", "sensor_msgs/msg/CameraInfo"),
    ],
)
def test_a_topic_that_is_asked_for_by_name_has_the_picture_that_fits(widget: str, type_name: str) -> None:
    assert [name for name, *_ in chosen(of_types(one=type_name), "/one")] == [widget]
