"""The page of a single widget, which plays its history."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from functools import partial
from math import floor, nan
from pathlib import Path
from typing import Any

from ..notebook.cells import close_all
from ..player_widget import PlayerWidget
from ..runtime.text import as_date, many
from ..screen_widget import ScreenWidget
from ..widget.timed_frame import FRAME_HEADER, TimedFrame
from .html import Heading, Page, check_texts
from .models import Models
from .segments import segment

_SECONDS = 10.0
"""Length of a segment."""


def write(widget: Any, path: Path, title: str, note: str) -> Path:
    """See `RobotWidget.to_html`."""
    widget.check_open("to_html()")
    check_texts(title, note)
    sent = widget.sent_frames()
    start, end = (sent[0].seconds, sent[-1].seconds) if sent else (0.0, 0.0)
    began = time.time() - time.monotonic() + start
    frames = [
        TimedFrame(arrived - start, _with_own_verdicts(about, frame), _without_rate(frame))
        for arrived, about, frame in sent
    ]
    moves = len(frames) > 1
    still = {"_source": {}, "_silence": 0.0, "history": 0}
    models = Models()
    with ExitStack() as stack:
        bar = PlayerWidget(
            duration=end - start, time=end - start, _segment=_SECONDS, _targets=[widget.model_id], _pauses=[0.0],
            _start=began,
        )  # fmt: skip
        stack.callback(close_all, bar)
        root = ScreenWidget("recording single", {"bar": [bar] if moves else [], "foot": [widget]})
        stack.callback(root.close)
        models.add(widget, {**still, "_frame": b"", "_about": {}} if moves else still)
        if moves:
            models.add(bar, {})
        models.add(root, {})
        state = models.part(
            root.model_id, player=bar.model_id if moves else "", scanogram=None, begin=0.0, name=path.stem
        )
    until = as_date(round((began + end - start) * 1e9))
    facts = f"{end - start:.1f} s until {until} · {many(len(frames), 'sample')}" if moves else until
    heading = Heading(title or widget.title or path.stem, facts, (), note, (repr(widget),))
    numbers = range(floor((end - start) / _SECONDS) + 1) if moves else range(0)
    pack = partial(_segment, frames, widget.arrays_of)
    return Page(heading, models.assets(), state, numbers, pack).write(path, None)


def _segment(frames: Sequence[TimedFrame], arrays_of: Any, number: int) -> bytes:
    return segment(number, [(list(_of_segment(frames, number * _SECONDS)), arrays_of)])


def _of_segment(frames: Sequence[TimedFrame], start: float) -> Iterator[TimedFrame]:
    """Yield the frame on show at the start of a segment, and the frames in it."""
    yield next((timed for timed in reversed(frames) if timed.seconds <= start), frames[0])
    yield from (timed for timed in frames if start <= timed.seconds < start + _SECONDS)


def _without_rate(frame: bytes) -> bytes:
    """Return a frame without a rate, as in a recording. With a rate it would turn pale when nothing follows."""
    sequence, _, stamp_ns, arrived = FRAME_HEADER.unpack_from(frame)
    return FRAME_HEADER.pack(sequence, nan, stamp_ns, arrived) + frame[FRAME_HEADER.size :]


def _with_own_verdicts(about: dict[str, Any], frame: bytes) -> dict[str, Any]:
    """Return the texts on a sample, without lamps of an earlier sample."""
    sequence, *_ = FRAME_HEADER.unpack_from(frame)
    if about.get("judged", sequence) == sequence:
        return about
    return {name: value for name, value in about.items() if name not in ("judged", "lamps")}
