"""The base of the widgets that show samples: storing and packing them, waiting for them, and errors."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from importlib import import_module
from math import inf
from pathlib import Path
from typing import Any, Generic, TypeVar, overload

import traitlets

from ..runtime.error_routing import called_from_cell
from ..runtime.output_file import checked_output
from ..samples.checks import not_negative
from ..samples.staleness import LIVE
from .newest_sample import NewestSample
from .paced_widget import PacedWidget
from .pacer import pacer
from .png import Png, Saving
from .timed_frame import FRAME_HEADER
from .traits import Flag
from .watch import Watch
from .watching import Hooks, Watches

PATIENCE = 2.0
"""Seconds after which a waiting thread logs why no sample comes, if the reason is known."""

PAGES = "robowidgets.export.widget_page"
"""The module that makes pages, by name: it lies in a layer above the widgets."""

NO_TEXTS: dict[str, Any] = {}
"""No texts on a sample. Never changed."""

S = TypeVar("S")


class RobotWidget(PacedWidget, Generic[S]):
    """A widget that shows the newest sample of type S.

    Subclasses pack samples to bytes and back, and pass new ones to `_show`. The calling thread only stores a sample,
    and the pacer packs and sends it, so any thread may update a widget at any rate.

    Its parts, from the page to here; each class has a module in this folder:

    - `FrontEndWidget`: the script and the stylesheet, which a page keeps once, and `theme`.
    - `InWords`: the text of the output for readers without a page.
    - `NamedWidget`: `title` and `header`, the errors for unknown names, `close`, the repr.
    - `BeatingWidget`: a sign of life every second, if a class wants it.
    - `FreezableWidget`: `paused`, the frozen frame with its texts, and the group that is frozen together.
    - `PacedWidget`: `history`, and the sending of the newest frame and of changed traits by the pacer.
    - this class: the newest sample, its frame and texts, `wait`, the source, errors, `to_html`.

    It also has ``_newest``, a `NewestSample`, for which threads wait; ``_watches``, the `Watches` behind `watch`; and
    ``_png``, the `Png` behind `save_png`.
    """

    footer = Flag(True, help="True to show counts below the picture.").tag(sync=True)

    has_rate = True
    """True if samples come as they are measured, at a rate; False if they are picked from a recording."""

    goes_stale = True
    """True if a sample is no longer valid once the source is silent."""

    packs_now = False
    """True if a frame shows the state when it is packed, and not a sample."""

    sample_name = "sample"
    """The name of one sample in programs, such as ``"scan"``."""

    judges_frames = False
    """True if a player shows the verdicts on each sample of this widget."""

    column = "narrow"
    """The column in which it stands in a view with several widgets: ``"wide"``, ``"narrow"`` or ``"map"``."""

    frame_traits: tuple[str, ...] = ()
    """Names of the traits on which its frames depend, in addition to the sample."""

    _edition = traitlets.Int(0, help="Number of changes by a program to what a player shows with each sample.")
    _source = traitlets.Dict(
        help="From a feed: robot, topic, type, status and the error of a function, as plain text; and lost, True if "
        "the connection is."
    ).tag(sync=True, echo_update=False)
    _silence = traitlets.Float(0.0, help="Seconds; the age of the newest sample in a state that a page requests.").tag(
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

    # -- for the user --------------------------------------------------------------------------------------------------

    def wait(self, timeout: float | None = None) -> Any:
        """Wait for the next sample and return it, so that a loop never acts on an old one.

        A thread never gets the same sample twice. It gets the newest one at once if that is new to the thread and not
        older than the default time-out. Freezing the picture makes no difference. A speed widget returns the measured
        speed. In the player of a recording the call returns the shown sample at once. Any thread may wait, except the
        one that updates the widget.

        Args:
            timeout: seconds to wait, 0 or more. By default three periods of the source, but at least 1 s and at most 10
                s; 10 s for a source without a rate, which has just started or sends events.

        Raises:
            TimeoutError: no sample came. The text gives the age of the last one and the reason, if it is known.
            TypeError: the timeout is not a number. ValueError: it is not finite, or below 0.
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

        The first argument decides. A condition gets a lamp below the picture. A name gets a line below the picture,
        with its numbers of the last ten seconds. Conditions are judged in a thread of their own, on the newest sample.
        A condition that raises an error is switched off, and the lamp shows why. Changes are kept, and a program may
        wait for them: see `Watch`.

        Args:
            condition: a function of one sample that returns True or False, or None for unknown; or one of
                `robowidgets.conditions` that reads samples of this widget. For a number, its name.
            name: the name of the lamp, plain text. A watch of the same name is replaced. By default the name of the
                function, or the text of the condition. For a number, its value, which is plotted at the time of the
                newest sample. NaN and infinities are gaps.

        Returns:
            The `Watch` of the condition; or the number, so that the call can replace the number in an expression.

        Raises:
            TypeError: it is not a condition, a lambda without a name, or not a number.
            ValueError: the condition reads samples of another widget; the name is empty or too long, or both a
                condition and a number would have it; there are more than eight numbers; or a player of a recording
                moves this widget. Players show verdicts only on lasers: use `Recording.find`.

        Examples:
            >>> from robowidgets import LaserWidget
            >>> laser = LaserWidget()
            >>> wall = laser.watch(lambda scan: scan.distance("front") < 0.5, name="wall")
            >>> laser.watch("r", 0.42)
            0.42
        """
        return self._watches.watch(condition, name)

    def unwatch(self, name: str) -> None:
        """Stop judging a condition and remove its lamp, or remove a number and its line.

        Raises:
            KeyError: no watch has that name.
        """
        self._watches.unwatch(name)

    @property
    def watched(self) -> Mapping[str, Watch]:
        """The watches by name."""
        return self._watches.by_name

    def save_png(self, path: str | os.PathLike[str]) -> Saving:
        """Save the picture of the widget as a PNG file with at least twice the resolution of the screen.

        The page that shows the widget draws the picture. The call returns at once. The file is written a moment later,
        or after the end of the cell, because many kernels do not process messages of a page before. To get the file
        within the cell, use ``await laser.save_png("corner.png")``. Later errors appear on the widget and in the log.

        Args:
            path: the file; an existing one is replaced.

        Raises:
            TypeError: it is not a path. ValueError: the name does not end in .png. OSError: the folder is missing or
                not writable. RuntimeError: not in a notebook, or the widget is closed.
        """
        return self._png.save(path)

    def to_html(self, path: str | os.PathLike[str], *, title: str = "", note: str = "") -> Path:
        """Write a page with the widget and its history, which it can play: one file, without a kernel or a network.

        Args:
            path: the file, such as ``"wall.html"``; an existing one is replaced.
            title: the title of the page; by default the title of the widget.
            note: a plain text under the title.

        Returns:
            The path of the file.

        Raises:
            TypeError: not a path, or not a text. ValueError: the name does not end in .html. OSError: the file cannot
                be written. RuntimeError: the widget is closed.

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
        """Return the sample on show in one line, empty before the first."""
        sample = self._newest_measured()
        return "" if sample is None else repr(sample).strip("<>")

    def _pack(self, sample: S) -> bytes:
        """Return the bytes of a frame after its header."""
        raise NotImplementedError

    def _on_packed(self, sequence: int, sample: S) -> None:
        """Note that the frame of this number now shows this sample. Called with the send lock."""

    def _unpack(self, frame: bytes) -> S:
        """Return the sample in a frame, which includes its header."""
        raise NotImplementedError

    def _sample_on_show(self) -> S | None:
        """Return the sample on show: the frozen one while paused, else the newest, or None before the first."""
        if self.paused:
            return self._unpack(self._frozen_frame) if self._frozen_frame else None
        return self._newest.sample

    def _newest_measured(self) -> Any:
        """Return the newest sample that was measured, not commanded, for `wait`; None before the first."""
        return self._newest.sample

    def _longest_silence(self) -> float:
        """Return the seconds without a sample after which the source is silent."""
        rate = self.rate
        return LIVE.after(1 / rate if rate > 0 else inf)

    def _about_sample(self, sample: S) -> dict[str, Any]:  # noqa: ARG002
        """Return texts on a sample that take time to compute. Called only for samples that are sent."""
        return {}

    def _show(self, sample: S, about: dict[str, Any] = NO_TEXTS, *, counts: bool = True) -> None:
        """Store the newest sample, with the texts on it that the caller knows, for the page to show.

        With ``counts=False`` it is an improved version of the previous sample, not a new one.
        """
        self._newest.put(sample, about, counts=counts)
        self._mark()

    def _say_more(self) -> None:
        """Send the newest sample again with later texts on it."""
        with self._newest.lock:
            self._newest.changed = True
        self._mark()

    def _renew_frames(self) -> None:
        """Make a player show its samples again, because verdicts or drawings on them have changed."""
        if self.driven_by_player:
            self._edition += 1

    def make_locks(self) -> None:
        """Make the locks again, after a fork."""
        super().make_locks()
        self._watches.make_locks()

    def _mark(self) -> None:
        """Get the newest sample sent, with its texts, once the verdicts on it are known.

        An earlier send would send nothing and delay the next one by the interval between two sends.
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

        ``missing`` is the reason why no sample will come unless something changes, or empty.
        """
        self._missing = missing
        if source != self._source:
            self._trait_values["_source"] = source
            self.send_state("_source")

    def on_source_closed(self) -> None:
        """End conditions that do not return, because no more samples come."""
        self._watches.end_late()

    def _set_png_error(self, error: str) -> None:
        if error != self._png_error:
            self._png_error = error
            self._say_more()

    def frame_of(self, sample: S) -> tuple[dict[str, Any], bytes]:
        """Return the texts on a sample and its frame without the header, as `update` would show it."""
        return {}, self._pack(sample)

    def arrays_of(self, frame: bytes) -> tuple[int, int]:  # noqa: ARG002
        """Return the bytes in a frame before its arrays of float32 of equal lengths, and the number of arrays.

        Bytes include the header. Exported pages pack such arrays well. (0, 0) means that a frame has another layout.
        """
        return 0, 0

    def miss(self, count: int) -> None:
        """Note a number of messages that the widget missed. A widget that must get each message reports it."""

    def within(self, start: float, end: float) -> dict[str, Any]:  # noqa: ARG002
        """Return the traits that differ on a page with a part of a recording, given in seconds."""
        return {}

    # -- to the page ---------------------------------------------------------------------------------------------------

    def count_replaced(self, count: int) -> None:
        """Count messages that were skipped for a newer one, for the rate."""
        self._newest.count_replaced(count)

    @property
    def rate(self) -> float:
        """Messages per second over the last seconds with messages; NaN while it is unknown."""
        return self._newest.rate if self.has_rate else float("nan")

    def get_state(self, key: str | Iterable[str] | None = None, drop_defaults: bool = False) -> dict[str, Any]:  # noqa: ARG002
        """Return the synced state with the newest sample, for a new view, a reloaded page and a saved notebook.

        Defaults are never dropped: the front end does not know them, and it is itself the default of a trait.
        """
        if key is None:
            self._bring_up_to_date()
        state: dict[str, Any] = super().get_state(key)
        if key is None and self._newest.sequence and (self.rate > 0 or self._source):
            # A page that loads the state has not seen the sample arrive and cannot know its age.
            state["_silence"] = self._newest.age
        return state

    def _get_embed_state(self, drop_defaults: bool = False) -> dict[str, Any]:
        """Return the state for an exported page, which shows the last picture without its age."""
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
        """Return further texts for the page with the newest sample. Called with the lock of the samples."""
        return {}

    def _to_judge(self, shown: Any) -> Any:
        """Return the sample to judge for a sample on show, or None before the first."""
        return shown

    def _why_unknown(self) -> str:
        """Return why the present state is unknown, empty while the newest sample is not stale."""
        if self._newest_measured() is None:
            return f"no {self.sample_name} came"
        limit, age = self._longest_silence(), self._newest.age
        busy_for = self._watches.judge.busy_for if self._watches.judge else 0.0
        if busy_for > limit:
            return f"conditions at work for {busy_for:.1f} s"
        if self.goes_stale and self.has_rate and age > limit:
            return self._source.get("status", "") or f"no new {self.sample_name} for {age:.1f} s"
        return ""
