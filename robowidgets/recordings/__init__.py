"""Recordings of robots: files of messages, opened for reading as samples."""

from ..repair.source import RecordingError, UnknownTopicError
from .timeline import Moment, Topic

__all__ = ["Moment", "RecordingError", "Topic", "UnknownTopicError"]
