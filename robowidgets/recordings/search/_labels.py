"""Conditions on labels: ``label("door")``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..labels import to_name
from ._steps import NO, YES, Steps, steps
from .base import UndecidedCondition

if TYPE_CHECKING:
    from .. import RecordingData
    from ._search import Search


class LabelCondition(UndecidedCondition):
    """The condition that a span has this label.

    Args:
        name: the name of the label, or None for any.
    """

    is_lasting = False
    """False, because the labels can change while the recording stays the same: results are not stored."""

    why = "only recordings have labels"

    def __init__(self, name: str | None) -> None:
        self._name = None if name is None else to_name(name)

    def topics(self, recording: RecordingData, asked: Any) -> list[str]:  # noqa: ARG002
        """See `Condition`."""
        return []

    def steps(self, search: Search) -> Steps:
        """See `Condition`."""
        recording = search.recording
        named = [one for one in recording.labels if self._name in (None, one.label)]
        found = [(recording.start_ns or 0, NO)]
        end_ns = None
        for one in named:
            if end_ns is None or one.start_ns > end_ns:
                found += [] if end_ns is None else [(end_ns, NO)]
                found.append((one.start_ns, YES))
                end_ns = one.end_ns
            end_ns = max(end_ns, one.end_ns)
        found += [] if end_ns is None else [(end_ns, NO)]
        return steps([at for at, _ in found], [value for _, value in found])

    def __str__(self) -> str:
        return f"labelled {self._name!r}" if self._name else "labelled"
