"""Ready-made conditions for `Recording.find` and for `watch`, of `robowidgets.recordings.search.conditions`."""

from .recordings.search.conditions import *  # noqa: F403
from .recordings.search.conditions import __all__ as __all__
