"""Recordings of robots: files of messages, opened for reading as samples."""

from .recording import Recording, open
from .source import RecordingError, UnknownTopicError
from .timeline import Moment, Topic

__all__ = ["Moment", "Recording", "RecordingError", "Topic", "UnknownTopicError", "open"]
