"""The states of a list of topics whose looks are kept."""

from __future__ import annotations

from robowidgets.topics_widget import TopicRow, TopicsWidget

from ...looks import Look

_ROWS = (
    TopicRow("/scan", "sensor_msgs/msg/LaserScan", 52, 10.4, "laser"),
    TopicRow("/odom", "nav_msgs/msg/Odometry", 250, 50.0, "speed"),
    TopicRow("/camera/image", "sensor_msgs/msg/Image", 150, 30.0, "image"),
    TopicRow("/camera/info", "sensor_msgs/msg/CameraInfo", 150, 30.0, "message"),
    TopicRow("/secret", "my_msgs/msg/Secret", 3, None, "", "its definition is missing"),
)


def _list() -> TopicsWidget:
    topics = TopicsWidget(folded=False)
    topics.set_rows(_ROWS)
    return topics


def _shown() -> TopicsWidget:
    topics = _list()
    topics._shown = {"/scan": ["/scan"]}
    return topics


def _folded() -> TopicsWidget:
    topics = _list()
    topics.folded = True
    return topics


LOOKS = {
    "topics/empty": Look(make=lambda: TopicsWidget(folded=False)),
    "topics/list": Look(make=_list),
    "topics/shown": Look(make=_shown),
    "topics/folded": Look(make=_folded),
}
