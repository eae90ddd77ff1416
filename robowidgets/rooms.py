"""The rows of the package's rooms, in the order of their widgets on a page; those on demand, the most useful first."""

from __future__ import annotations

from .cloud.row import CLOUD
from .events.row import EVENTS
from .image.row import IMAGE
from .kinds import add
from .laser.row import LASER, SCAN
from .message.row import MESSAGE
from .path.row import PATH
from .plots.row import PLOT
from .sonar.row import SONAR
from .speed.row import SPEED
from .touch.row import TOUCH

for row in (LASER, SPEED, TOUCH, SONAR, PATH, EVENTS, IMAGE, CLOUD, SCAN, MESSAGE, PLOT):
    add(row)
