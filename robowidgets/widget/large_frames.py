"""The base of the widgets whose frames are large: pictures and clouds."""

from __future__ import annotations

from collections import OrderedDict
from math import isfinite
from typing import Any, TypeVar

from ..runtime.clock import scheduler
from ..runtime.error_routing import cell_is_running
from ..runtime.platform_fixes import route_by_message
from .credit import Credit
from .pacer import pacer
from .robot_widget import RobotWidget
from .timed_frame import FRAME_HEADER
from .traits import Flag

S = TypeVar("S")

MOST_KEPT, MOST_KEPT_BYTES = 600, 64_000_000
"""The number and the approximate bytes of the last samples, which the page may request and step back to."""

_NO_ANSWERS = "fewer pictures while a cell runs: this notebook does not say before its end what the page has drawn"


class LargeFrameWidget(RobotWidget[S]):
    """A widget that sends a frame when the page has drawn the one before, and drops the samples in between.

    A subclass packs frames as every `RobotWidget` does, returns the size of a sample in `_size_of`, and draws frames in
    the page with a `Credit` of ``shared/credit.ts``. It gets its own messages from the page in `_on_message`. See
    `Credit` for the order of frames. The page may get a sample in less detail, so the last samples are kept here.
    """

    _answers = Flag(True, help="True if Python waits for the page to report the frames it has drawn.").tag(sync=True)

    def __init__(self, **kwargs: Any) -> None:
        self._credit = Credit(scheduler.clock.now, cell_is_running)
        self._kept: OrderedDict[float, S] = OrderedDict()
        """The samples of the last frames, by the numbers of the frames."""
        self._look = _Look(self)
        self._pace = ""
        super().__init__(**kwargs)
        self.on_msg(self._on_page)

    def open(self) -> None:
        """Connect to the page."""
        super().open()
        route_by_message(self.comm)

    def close(self) -> None:
        """Remove the widget from the page."""
        super().close()
        pacer.forget(self._look)

    def follow_player(self) -> None:
        """See `PacedWidget`."""
        self._answers = False
        super().follow_player()

    def send_newest(self) -> int:
        """See `PacedWidget`. Frames that wait for the page count nothing against the budget of all widgets."""
        size = super().send_newest()
        return size if self._credit.is_paced else 0

    def _may_send_frame(self) -> bool:
        """See `PacedWidget`."""
        has_more = self._newest.changed or self._trait_values["_frame"] != self._sent[0]
        is_last = pacer.is_flushing and self._credit.is_unheard
        if self.driven_by_player or not has_more or is_last or self._credit.may_send():
            return True
        pacer.hold(self)
        pacer.mark_at(self._look, self._credit.look_at)
        return False

    def _before_frame(self, frame: bytes) -> None:
        """See `PacedWidget`."""
        number, *_ = FRAME_HEADER.unpack_from(frame)
        self._credit.sent(number, len(frame))

    def _on_packed(self, sequence: int, sample: S) -> None:
        """See `RobotWidget`."""
        kept = self._kept
        kept[sequence] = sample
        while len(kept) > MOST_KEPT or (len(kept) > 1 and sum(map(self._size_of, kept.values())) > MOST_KEPT_BYTES):
            kept.popitem(last=False)

    def _size_of(self, sample: S) -> int:
        """Return the approximate size of a sample in bytes."""
        raise NotImplementedError

    def _unpack(self, frame: bytes) -> S | None:  # type: ignore[override]  # the sample may be dropped
        number, *_ = FRAME_HEADER.unpack_from(frame)
        return self._kept.get(number)

    def look_again(self) -> None:
        """Send a frame that was held back if it may go now, or ask pages what they have drawn. The pacer calls this."""
        asked_after = self._credit.asks()
        if asked_after is not None and self.comm is not None:
            self.send({"asks": asked_after})
        pacer.mark(self)

    def _texts_now(self) -> dict[str, Any]:
        """See `RobotWidget`."""
        return {**super()._texts_now(), **({"pace": _NO_ANSWERS} if self._credit.says_paced else {})}

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        """Handle a message of the page, in the main thread or a subshell's. It does not wait."""
        if not isinstance(content, dict):
            return
        if "drawn" not in content:
            self._on_message(content)
            return
        page, number, lacks = content.get("page"), content["drawn"], content.get("lacks")
        if not isinstance(page, str) or not _is_number(number) or not (lacks is None or _is_number(lacks)):
            return
        if self._credit.on_drawn(page, number, lacks):
            pacer.mark(self)

    def _on_message(self, content: dict[str, Any]) -> None:
        """Handle a message of the page for the subclass."""


class _Look:
    """Lets the pacer check if a frame may go. The widget itself may be due at another time."""

    def __init__(self, widget: LargeFrameWidget[Any]) -> None:
        self._widget = widget

    def send_newest(self) -> int:
        """Check the widget. The pacer calls this."""
        self._widget.look_again()
        return 0


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and isfinite(value)
