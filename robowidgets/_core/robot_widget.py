"""The base of the widgets that show samples: storing and packing them, waiting for them, and errors."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from importlib import import_module
from math import inf
from pathlib import Path
from typing import Any, Generic, TypeVar, overload

import traitlets

from ..samples.checks import not_negative
from ..samples.staleness import LIVE
from .error_routing import called_from_cell
from .newest_sample import NewestSample
from .output_file import checked_output
from .paced_widget import PacedWidget
from .pacer import pacer
from .png import Png, Saving
from .timed_frame import FRAME_HEADER
from .traits import Flag
from .watch import Watch
from .watching import Hooks, Watches

PATIENCE = 2.0
"""Seconds after which a thread that waits is told that what it waits for is missing, if that is known."""

PAGES = "robowidgets.export.widget_page"
"""Makes the pages. Named as entry points do: it lies in a layer above the widgets."""

NO_TEXTS: dict[str, Any] = {}
"""No texts on a sample; never changed."""

S = TypeVar("S")


class RobotWidget(PacedWidget, Generic[S]):
    """A widget that shows the newest sample of type S.

    Subclasses pack samples to bytes and back, and pass new ones to `_show`. The calling thread only stores a sample,
    and the pacer packs and sends it, so any thread may update a widget at any rate.

    What it is made of, from the page to here; each class is a module beside this one:

    - `FrontEndWidget`: the script and the stylesheet, which a page keeps once.
    - `NamedWidget`: `title` and `header`, the errors for unknown names, `close`, the repr.
    - `BeatingWidget`: a sign of life every second, where a class asks for it.
    - `FreezableWidget`: `paused`, the frozen frame with its texts, and the group that is frozen together.
    - `PacedWidget`: `history`, and what is sent when: the newest frame and the traits that were set, by the pacer.
    - this class: the newest sample, what is packed of it and said of it, `wait`, the source, errors, `to_html`.

    And what it has: ``_newest``, a `NewestSample`, for which threads wait; ``_watches``, the `Watches` behind `watch`;
    ``_png``, the `Png` behind `save_png`.
    """

    footer = Flag(True, help="Whether counts stand below the picture.").tag(sync=True)

    has_rate = True
    """Whether samples come as they are measured, at a rate; False for samples that are picked from a recording."""

    goes_stale = True
    """Whether a sample says nothing any more once the source is silent."""

    packs_now = False
    """Whether a frame tells what is known when it is packed, not a sample."""

    sample_name = "sample"
    """What programs call one sample: ``"scan"``."""

    judges_frames = False
    """Whether a player shows the verdicts on each sample of this widget."""

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
        self._newest: NewestSample[Any] = NewestSample()
        hooks = Hooks(self._to_judge, self._why_unknown, self._say_more, self._renew_frames)
        self._watches = Watches(self, self._newest, hooks)
        self._png = Png(self, self._set_png_error, self.send_newest)
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

        def take_next() -> S | None:
            with newest.lock:
                sample: S | None = self._newest_measured()
                if self.has_rate and not (newest.is_new() and newest.age <= limit):
                    return None
                if sample is not None:
                    newest.take()
                return sample

        left, sample = seconds, None
        if self._source and seconds > PATIENCE:
            sample, left = newest.waiters.wait_for(take_next, PATIENCE), seconds - PATIENCE
            if sample is None and (why := self._missing):
                self._log_once(f"{why}; waiting for {seconds:g} s, in case it comes")
        if sample is None:
            sample = newest.waiters.wait_for(take_next, left)
        if sample is None:
            with newest.lock:
                raise TimeoutError(self._why_none(seconds))
        return sample

    @overload
    def watch(self, name: str, value: float, /) -> float: ...
    @overload
    def watch(self, condition: Any, name: str | None = None) -> Watch: ...
    def watch(self, condition: Any, name: Any = None) -> Any:
        """Judge a condition on each sample, ``watch(condition, name)``; or plot a number, ``watch(name, value)``.

        What comes first decides. A condition gets a lamp below the picture, a name gets a line there with its numbers
        of the last ten seconds. Conditions are judged in a thread of their own, on the newest sample. What raises is
        switched off, and the lamp says why. The changes are kept, and a program may wait for it: see `Watch`.

        Args:
            condition: a function of one sample that returns True or False, or None for unknown; or one of
                `robowidgets.conditions` that looks at samples of this widget. Or, for a number, its name.
            name: of the lamp, plain text. A watch of the same name is replaced. None: the name of the function, or the
                text of the condition. Or the number: it is plotted at the time of the newest sample; NaN and infinities
                are gaps.

        Returns:
            The `Watch` of the condition; or the number, so that the call may stand where the number is used.

        Raises:
            TypeError: no such condition, a lambda without a name, or no number.
            ValueError: the condition looks at samples of another widget; the name is empty or too long, or both a
                condition and a number would have it; there are more than eight numbers; a player of a recording moves
                this widget, and shows verdicts on lasers only: `Recording.find` finds the condition.

        Examples:
            >>> from robowidgets import LaserWidget
            >>> laser = LaserWidget()
            >>> wall = laser.watch(lambda scan: scan.distance("front") < 0.5, name="wall")
            >>> laser.watch("r", 0.42)
            0.42
        """
        return self._watches.watch(condition, name)

    def unwatch(self, name: str) -> None:
        """Judge a condition no more, and remove its lamp; or remove a number with its line.

        Raises:
            KeyError: there is no watch of that name.
        """
        self._watches.unwatch(name)

    @property
    def watched(self) -> Mapping[str, Watch]:
        """The watches by name."""
        return self._watches.by_name

    def save_png(self, path: str | os.PathLike[str]) -> Saving:
        """Write what the widget shows now into a PNG file, at least twice as fine as on the screen.

        The page that shows the widget draws the picture. The call returns at once, and the file is written a moment
        later, or after the cell has ended, because many kernels process no message of a page before. To have the file
        within the cell, use ``await laser.save_png("corner.png")``. Later errors appear on the widget and in the log.

        Args:
            path: the file; an existing one is replaced.

        Raises:
            TypeError: no path. ValueError: a name that does not end in .png. OSError: a missing folder, or one that is
                not writable. RuntimeError: no notebook, or the widget is closed.
        """
        return self._png.save(path)

    def to_html(self, path: str | os.PathLike[str], *, title: str = "", note: str = "") -> Path:
        """Write a page with the widget as it is, and its history to play: one file, without a kernel or the web.

        Args:
            path: the file, such as ``"wall.html"``; an existing one is replaced.
            title: of the page; empty: the title of the widget.
            note: a text under the title, which is shown as it is.

        Returns:
            The path of the file.

        Raises:
            TypeError: no path, or no text. ValueError: a name that does not end in .html. OSError: the file cannot be
                written. RuntimeError: the widget is closed.

        Examples:
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

    def _on_packed(self, sequence: int, sample: S) -> None:
        """Note that the frame of this number is of this sample from now on. Called with the lock of the sends."""

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

    def _renew_frames(self) -> None:
        """Have a player show its samples anew, on which something else is judged or drawn now."""
        if self.driven_by_player:
            self._edition += 1

    def make_locks(self) -> None:
        super().make_locks()
        self._watches.make_locks()

    def _mark(self) -> None:
        """Have the newest sample sent with what is on it, once the verdicts on it are there.

        To send before that would send nothing, and the next send would wait for the interval between two.
        """
        judge = self._watches.judge
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

    def set_source(self, source: dict[str, Any], missing: str = "") -> None:
        """Set the trait without a call of its observers: threads of a feed that carry speeds call this.

        ``missing`` tells why nothing will come unless something changes.
        """
        self._missing = missing
        if source != self._source:
            self._trait_values["_source"] = source
            self.send_state("_source")

    def on_source_closed(self) -> None:
        """End conditions that do not return: no sample comes any more."""
        self._watches.end_late()

    def _set_png_error(self, error: str) -> None:
        if error != self._png_error:
            self._png_error = error
            self._say_more()

    def frame_of(self, sample: S) -> tuple[dict[str, Any], bytes]:
        """The text on a sample, and its frame without the header: what `update` of the sample would show."""
        return {}, self._pack(sample)

    def arrays_of(self, frame: bytes) -> tuple[int, int]:  # noqa: ARG002
        """What a frame, with its header, holds: bytes before arrays of float32 of equal lengths, and their number.

        Exported pages pack such numbers well. (0, 0): it holds other things.
        """
        return 0, 0

    def miss(self, count: int) -> None:
        """Note that so many messages came that it does not get. A widget that gets each message says it."""

    def within(self, start: float, end: float) -> dict[str, Any]:  # noqa: ARG002
        """What of its traits differs in a page of a stretch of a recording, in seconds: what it shows of all of it."""
        return {}

    # -- to the page ---------------------------------------------------------------------------------------------------

    def count_replaced(self, count: int) -> None:
        """Count so many messages for the rate that were left out because a newer one came."""
        self._newest.count_replaced(count)

    @property
    def rate(self) -> float:
        """Messages per second over the last seconds in which some came; NaN while it is unknown."""
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
        self._watches.close()
        super().close()

    def _bring_up_to_date(self) -> None:
        """See `FreezableWidget`."""
        with self._send_lock:
            newest, judge = self._newest, self._watches.judge
            if newest.changed and judge:
                judge.await_verdicts()
            with newest.lock:
                if not newest.changed:
                    return
                shot, lamps = judge.choose(self._packed_version) if judge else (newest.shot(), [])
                if shot is None:
                    return
                newest.changed, self._packed_version = shot.version != newest.version, shot.version
                _, sequence, arrived, sample, about = shot
                rate = self.rate
                if sample is not None:
                    about = {**self._about_sample(sample), **about}
                if self._png_error:
                    about = {**about, "notes": [*about.get("notes", ()), self._png_error]}
                shown = {**about, **self._texts_now(), **self._watches.numbers.on(sequence)}
            if lamps:
                shown |= {"lamps": lamps, "judged": sequence}
            self._trait_values["_about"] = shown
            if about != self._abouts[-1][1]:
                self._abouts.append((sequence, about))
            if sample is not None:
                stamp = getattr(sample, "stamp_ns", None) or 0
                self._trait_values["_frame"] = FRAME_HEADER.pack(sequence, rate, stamp, arrived) + self._pack(sample)
                self._on_packed(sequence, sample)

    def _texts_now(self) -> dict[str, Any]:
        """What else the page is told with the newest sample. Called with the lock of the samples."""
        return {}

    def _to_judge(self, shown: Any) -> Any:
        """What conditions are judged on, of a sample as it is shown; None before the first."""
        return shown

    def _why_unknown(self) -> str:
        """Why nothing is known of the present; empty while the newest sample is not stale."""
        if self._newest_measured() is None:
            return f"no {self.sample_name} came"
        limit, age = self._longest_silence(), self._newest.age
        busy_for = self._watches.judge.busy_for if self._watches.judge else 0.0
        if busy_for > limit:
            return f"conditions at work for {busy_for:.1f} s"
        if self.goes_stale and self.has_rate and age > limit:
            return self._source.get("status", "") or f"no new {self.sample_name} for {age:.1f} s"
        return ""
