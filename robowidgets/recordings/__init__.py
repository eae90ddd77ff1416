"""The data of recordings: files of messages, opened for reading as samples. This part imports no widgets."""

from ..notebook import in_browser

if in_browser.IN_BROWSER:
    in_browser.prepare_recordings()

from ..repair import RecordingError
from .data import RecordingData
from .time_slice import TimeSlice
from .topics import Moment, TimedMessage, Topic, UnknownTopicError

__all__ = ["Moment", "RecordingData", "RecordingError", "TimeSlice", "TimedMessage", "Topic", "UnknownTopicError"]
