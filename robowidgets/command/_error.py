"""The error of the command."""

from __future__ import annotations


class CommandError(Exception):
    """The arguments make no sense, not for this recording, or need what is not installed; one line for a person."""
