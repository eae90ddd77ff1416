"""Recordings of robots: files of messages, opened for reading as samples."""

from .recording import Recording, UnknownTopicError, open
from .source import RecordingError
from .timeline import Moment, Topic

__all__ = ["Moment", "Recording", "RecordingError", "Topic", "UnknownTopicError", "open"]
