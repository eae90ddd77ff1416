"""The error of the command."""

from __future__ import annotations


class CommandError(Exception):
    """The arguments are invalid, do not fit the recording, or need a missing package. The text is one line."""
