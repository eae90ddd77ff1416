"""The base of the widgets that show samples: storing and packing them, waiting for them, and errors."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterable
from importlib import import_module
from math import inf
from pathlib import Path
from typing import Any, Generic, TypeVar

import traitlets

from ..samples.checks import not_negative
from ..samples.staleness import LIVE
from .error_routing import called_from_cell
from .output_file import checked_output
from .paced_widget import PacedWidget
from .pacer import pacer
from .plotted_numbers import PlottedNumbers
from .png import SavesPng
from .timed_frame import FRAME_HEADER
from .traits import Flag
from .watching import JudgesConditions

PATIENCE = 2.0
"""Seconds after which a thread that waits is told that what it waits for is missing, if that is known."""

PAGES = "robowidgets.export.widget_page"
"""Makes the pages. Named as entry points do: it lies in a layer above the widgets."""

NO_TEXTS: dict[str, Any] = {}
"""No texts on a sample; never changed."""

S = TypeVar("S")


class RobotWidget(SavesPng, JudgesConditions, PacedWidget, Generic[S]):
    """A widget that shows the newest sample of type S.

    Subclasses pack samples to bytes and back, and pass new ones to `_show`. The calling thread only stores a sample,
    and the pacer packs and sends it, so any thread may update a widget at any rate.
    """

    footer = Flag(True, help="Whether counts stand below the picture.").tag(sync=True)

    has_rate = True
    """Whether samples come as they are measured, at a rate; False for samples that are picked from a recording."""

    goes_stale = True
    """Whether a sample says nothing any more once the source is silent."""

    _packs_now = False
    """Whether a frame tells what is known when it is packed, not a sample."""

    column = "narrow"
    """The column in which it stands in a view with several widgets: ``"wide"``, ``"narrow"`` or ``"map"``."""

    frame_traits: tuple[str, ...] = ()
    """Names of the traits on which its frames depend, besides the sample."""

    _edition = traitlets.Int(0, help="How often a program has changed what a player shows with each sample.")
    _source = traitlets.Dict(
        help="From a feed: robot, topic, type, status, error of a function, as plain text; whether the connection is "
        "lost."
    ).tag(sync=True, echo_update=False)
    _silence = traitlets.Float(0.0, help="Seconds; how old the newest sample is in a state that a page asks for.").tag(
        sync=True
    )

    def __init__(self, **kwargs: Any) -> None:
        self._png_error = self._missing = ""
        self._packed_version = 0
        self._plotted = PlottedNumbers()
        super().__init__(**kwargs)

    # -- what a person uses --------------------------------------------------------------------------------------------

    def wait(self, timeout: float | None = None) -> Any:
        """The next sample, frozen or not, so that a loop never acts on an old one.

        A thread never gets the same sample twice. It gets the newest one at once if it has not had it, and if that is
        no older than the default time-out; else the call waits. A speed widget returns the measured speed. In the
        player of a recording the call returns the shown sample at once. Any thread may wait, except the one that
        updates the widget.

        Args:
            timeout: seconds to wait, 0 or more. None: three periods of the source, at least 1 s and at most 10 s; 10 s
                for a source without a rate, which has just begun or sends events.

        Raises:
            TimeoutError: none came; the text gives the age of the last one and the reason, if it is known.
            TypeError: the timeout is no number. ValueError: it is not finite, or below 0.
        """
        limit = self._longest_silence()
        seconds = limit if timeout is None else not_negative("timeout", timeout, "seconds")
        newest = self._newest

        def has_next() -> bool:
            if self._newest_measured() is None:
                return False
            return not self.has_rate or (newest.is_new() and newest.age <= limit)

        left = seconds
        if self._source and seconds > PATIENCE:
            with newest.lock:
                left -= 0.0 if newest.wait_for(has_next, PATIENCE) else PATIENCE
            if left < seconds and (why := self._missing):
                self._log_once(f"{why}; waiting for {seconds:g} s, in case it comes")
        with newest.lock:
            if not newest.wait_for(has_next, min(left, threading.TIMEOUT_MAX)):
                raise TimeoutError(self._why_none(seconds))
            newest.take()
            return self._newest_measured()

    def to_html(self, path: str | os.PathLike[str], *, title: str = "", note: str = "") -> Path:
        """Write a page with the widget as it is, and its history to play: one file, without a kernel or the web.

        Args:
            path: the file, such as ``"wall.html"``; an existing one is replaced.
            title: of the page; empty: the title of the widget.
            note: a text under the title, which is shown as it is.

        Returns:
            The path of the file.

        Raises:
            TypeError: no path. ValueError: a name that does not end in .html. OSError: the file cannot be written.

        Example:
            >>> laser.to_html("wall.html", note="The reading that it stopped for.")  # doctest: +SKIP
        """
        target = checked_output("to_html", path, (".html", ".htm"))
        written: Path = import_module(PAGES).write(self, target, title, note)
        return written

    def _summary(self) -> str:
        shown = self._describe() or "nothing yet"
        return f"frozen, {shown}" if self.paused else shown

    # -- for subclasses ------------------------------------------------------------------------------------------------

    def _describe(self) -> str:
        """The sample on show in one line; empty before the first."""
        sample = self._newest_measured()
        return "" if sample is None else repr(sample).strip("<>")

    def _pack(self, sample: S) -> bytes:
        """The bytes of a frame after its header."""
        raise NotImplementedError

    def _unpack(self, frame: bytes) -> S:
        """The sample in a frame, with its header."""
        raise NotImplementedError

    def _sample_on_show(self) -> S | None:
        """The sample on show: the frozen one while paused, else the newest; None before the first."""
        if self.paused:
            return self._unpack(self._frozen_frame) if self._frozen_frame else None
        return self._newest.sample

    def _newest_measured(self) -> Any:
        """The newest sample that was measured, not commanded, which `wait` returns; None before the first one."""
        return self._newest.sample

    def _longest_silence(self) -> float:
        """Seconds without a sample after which the source is silent."""
        rate = self.rate
        return LIVE.after(1 / rate if rate > 0 else inf)

    def _about_sample(self, sample: S) -> dict[str, Any]:  # noqa: ARG002
        """Texts on a sample that take time to find; asked for when it is sent, not for each that arrives."""
        return {}

    def _show(self, sample: S, about: dict[str, Any] = NO_TEXTS, *, counts: bool = True) -> None:
        """Store the newest sample, with the texts on it that its caller knows, for the page to show.

        With ``counts=False`` it is an improved version of the previous sample, not a new one.
        """
        self._newest.put(sample, about, counts=counts)
        self._mark()

    def _say_more(self) -> None:
        """Have the newest sample sent with what was said of it later."""
        with self._newest.lock:
            self._newest.changed = True
        self._mark()

    def _make_locks(self) -> None:
        super()._make_locks()
        if self._judge:
            self._judge.make_runner()

    def _mark(self) -> None:
        """Have the newest sample sent with what is on it, once the verdicts on it are there.

        To send before that would send nothing, and the next send would wait for the interval between two.
        """
        judge = self._judge
        if judge is None or not judge.will_mark():
            pacer.mark(self)

    def _refuse(self, error: Exception) -> None:
        """Show why a message could not be shown; then raise the error in a cell, and log it in a callback."""
        text = str(error)
        newest = self._newest
        with newest.lock:
            newest.about = {**newest.about, "error": text if text.endswith((".", "?")) else f"{text}."}
            newest.changed = True
        pacer.mark(self)
        if called_from_cell():
            raise error from None
        self._log_once(f"a message could not be shown: {text}")

    def _why_none(self, seconds: float) -> str:
        error = self._newest.about.get("error", "")
        reasons = [self._source.get("status", ""), f"what came could not be shown: {error}" if error else ""]
        sample = self._newest_measured()
        if not self._source and not error and sample is None:
            reasons.append("no feed is connected to it; feed.connect(topic, widget) does that")
        why = "; ".join(filter(None, reasons))
        none = f"nothing to show in {seconds:g} s"
        if sample is not None:
            age = self._newest.age
            none = f"no new {type(sample).__name__.lower()} for {age:.{'1f' if age >= 1 else '2g'}} s"
        return f"{type(self).__name__} {self.title}".rstrip() + f" had {none}" + f": {why}" * bool(why)

    def _set_source(self, source: dict[str, Any], missing: str = "") -> None:
        """Set the trait without a call of its observers: threads of a feed that carry speeds call this.

        ``missing`` tells why nothing will come unless something changes.
        """
        self._missing = missing
        if source != self._source:
            self._trait_values["_source"] = source
            self.send_state("_source")

    def _set_png_error(self, error: str) -> None:
        if error != self._png_error:
            self._png_error = error
            self._say_more()

    def _catch_up(self) -> None:
        self.send_newest()

    def frame_of(self, sample: S) -> tuple[dict[str, Any], bytes]:
        """The text on a sample, and its frame without the header: what `update` of the sample would show."""
        return {}, self._pack(sample)

    def arrays_of(self, frame: bytes) -> tuple[int, int]:  # noqa: ARG002
        """What a frame, with its header, holds: bytes before arrays of float32 of equal lengths, and their number.

        Exported pages pack such numbers well. (0, 0): it holds other things.
        """
        return 0, 0

    # -- to the page ---------------------------------------------------------------------------------------------------

    @property
    def rate(self) -> float:
        """Samples per second over the last seconds in which some came; NaN while it is unknown."""
        return self._newest.rate if self.has_rate else float("nan")

    def get_state(self, key: str | Iterable[str] | None = None, drop_defaults: bool = False) -> dict[str, Any]:  # noqa: ARG002
        """The synced state with the newest sample, for a new view, a reloaded page and a saved notebook.

        Defaults are never dropped: the front end does not know them, and is itself the default of a trait.
        """
        if key is None:
            self._bring_up_to_date()
        state: dict[str, Any] = super().get_state(key)
        if key is None and self._newest.sequence and (self.rate > 0 or self._source):
            # A page that loads the state has not seen the sample arrive and cannot know its age.
            state["_silence"] = self._newest.age
        return state

    def _get_embed_state(self, drop_defaults: bool = False) -> dict[str, Any]:
        """The state for an exported page, which shows the last picture without its age."""
        state: dict[str, Any] = super()._get_embed_state(drop_defaults)
        state["state"]["_silence"] = 0.0
        return state

    def close(self) -> None:
        """Remove the widget from the page."""
        if self._judge:
            self._judge.close()
        super().close()

    def _bring_up_to_date(self) -> None:
        """See `FreezableWidget`."""
        with self._send_lock:
            newest = self._newest
            with newest.lock:
                if not newest.changed:
                    return
                shot, lamps = self._judge.choose(self._packed_version) if self._judge else (newest.shot(), [])
                if shot is None:
                    return
                newest.changed, self._packed_version = shot.version != newest.version, shot.version
                _, sequence, arrived, sample, about = shot
                rate = self.rate
                if sample is not None:
                    about = {**self._about_sample(sample), **about}
                if self._png_error:
                    about = {**about, "notes": [*about.get("notes", ()), self._png_error]}
                shown = {**about, **self._texts_now(), **self._plotted.on(sequence)}
            if lamps:
                shown |= {"lamps": lamps, "judged": sequence}
            self._trait_values["_about"] = shown
            if about != self._abouts[-1][1]:
                self._abouts.append((sequence, about))
            if sample is not None:
                stamp = getattr(sample, "stamp_ns", None) or 0
                self._trait_values["_frame"] = FRAME_HEADER.pack(sequence, rate, stamp, arrived) + self._pack(sample)

    def _texts_now(self) -> dict[str, Any]:
        """What else the page is told with the newest sample. Called with the lock of the samples."""
        return {}

    def _to_judge(self, shown: Any) -> Any:
        """What conditions are judged on, of a sample as it is shown; None before the first."""
        return shown

    def _why_unknown(self) -> str:
        if self._newest_measured() is None:
            return f"no {self.sample_name} came"
        limit, age = self._longest_silence(), self._newest.age
        busy_for = self._judge.busy_for if self._judge else 0.0
        if busy_for > limit:
            return f"conditions at work for {busy_for:.1f} s"
        if self.goes_stale and self.has_rate and age > limit:
            return self._source.get("status", "") or f"no new {self.sample_name} for {age:.1f} s"
        return ""
