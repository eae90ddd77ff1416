"""The data of recordings: files of messages, opened for reading as samples. No widget is imported."""

from importlib.util import find_spec

from .._core.in_browser import IN_BROWSER, NO_RECORDINGS

if IN_BROWSER and find_spec("lz4") is None:
    raise ImportError(NO_RECORDINGS)

from ..repair import RecordingError
from .data import RecordingData
from .time_slice import TimeSlice
from .topics import Moment, TimedMessage, Topic, UnknownTopicError

__all__ = ["Moment", "RecordingData", "RecordingError", "TimeSlice", "TimedMessage", "Topic", "UnknownTopicError"]
