"""Live data of a running robot, by one of several middlewares.

Each function here opens a `Feed`, which lists topics, shows them and drives the robot. A feed imports the packages of
its middleware when it is opened.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from ..runtime.renamed import renamed
from ._driving import Driving
from ._stop_all import StopAll
from ._topics import FeedTopic
from .dds import dds
from .feed import Feed
from .foxglove import foxglove
from .middleware import Advert, FeedError, Listener, Middleware
from .ros1 import ros1
from .ros2 import ros2
from .rosbridge import rosbridge
from .simulator import simulator
from .zenoh import zenoh

__all__ = [
    "Advert",
    "Driving",
    "Feed",
    "FeedError",
    "FeedTopic",
    "Listener",
    "Middleware",
    "StopAll",
    "dds",
    "foxglove",
    "recording",
    "ros1",
    "ros2",
    "rosbridge",
    "simulator",
    "zenoh",
]

if TYPE_CHECKING:
    from .replay import recording as recording
else:

    def __getattr__(name: str) -> Any:
        if name == "recording":  # the readers of files take longer to import than all other modules together
            return import_module(".replay", __name__).recording
        return renamed(__name__, name, {"Topic": FeedTopic})
