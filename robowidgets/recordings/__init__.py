"""The data of recordings: files of messages, opened for reading as samples. No widget is imported."""

from ..repair import RecordingError
from .data import RecordingData
from .time_slice import TimeSlice
from .topics import Moment, TimedMessage, Topic, UnknownTopicError

__all__ = ["Moment", "RecordingData", "RecordingError", "TimeSlice", "TimedMessage", "Topic", "UnknownTopicError"]
