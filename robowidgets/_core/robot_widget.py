"""The base of the widgets that show samples: storing them, sending them to the page, and errors."""

from __future__ import annotations

import os
import threading
import time
import weakref
from collections.abc import Iterable
from typing import Any, Generic, TypeVar

import traitlets

from ..samples.checks import not_negative
from .error_routing import called_from_cell
from .freezing import FreezableWidget
from .judge import Shot
from .numbers import Numbers
from .pacer import pacer
from .page_file import SentFrames, WritesPage
from .platform_fixes import message_padding
from .png import SavesPng
from .rate import RateMeter
from .timed_frame import FRAME_HEADER, TimedFrame
from .traits import Flag, HistorySeconds
from .watching import JudgesConditions

SHORTEST_SILENCE, LONGEST_SILENCE = 1.0, 10.0
"""Seconds without a sample after which a source is silent: three of its periods, within these limits, and the longest
where it has no rate yet. The page follows the same rule (shared/stream.ts)."""

RESYNC_TRAITS = ("title", "_about", "_source")
"""Traits that only Python writes, which are sent again with a frame at intervals: a server that is flooded with prints
silently drops messages, and a page may overwrite new traits with an older state that it requested before."""

RESYNC_S = 5.0
"""Seconds between two such frames."""

NO_TEXTS: dict[str, Any] = {}
"""No texts on a sample; never changed."""

S = TypeVar("S")


class RobotWidget(SavesPng, WritesPage, JudgesConditions, FreezableWidget, Generic[S]):
    """A widget that shows the newest sample of type S.

    Subclasses pack samples to bytes and back, and pass new ones to `_show`. The calling thread only stores a sample,
    and the pacer packs and sends it, so any thread may update a widget at any rate. The pacer also sends the traits
    that a program sets, because a loop may set them at any rate, too.
    """

    footer = Flag(True, help="Whether counts stand below the picture.").tag(sync=True)
    history = HistorySeconds(
        30.0,
        why="; the page keeps 20 samples for each of them",
        help="Seconds for which the page keeps samples to step back through, 0 (none) to 600; 20 a second and 8 MB at "
        "most.",
    ).tag(sync=True)

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
        self._process = os.getpid()
        self._newest: S | None = None
        self._newest_about: dict[str, Any] = {}
        self._png_error = ""
        self._sequence = 0
        self._version = 1
        """Of what there is to show; each sample, and each text on it, has a higher one."""
        self._sent_version = 0
        self._arrived = 0.0
        self._meter = RateMeter()
        self._plotted = Numbers()
        self._changed = False
        self._waiting = 0
        self._sent: tuple[bytes, dict[str, Any]] = (b"", {})
        """`_frame` and `_about` as they were sent last; only the pacer sends them."""
        self._sent_frames = SentFrames()
        self._unsent: set[str] = set()
        self._resync_at = time.monotonic() + RESYNC_S
        self._make_locks()
        _made.add(self)
        super().__init__(**kwargs)

    def _make_locks(self) -> None:
        """Make free locks; again in a forked process, which has no threads that could release the old ones."""
        self._sample_lock = threading.RLock()
        self._send_lock = threading.RLock()
        self._sample_arrived = threading.Condition(self._sample_lock)
        self._given = threading.local()
        """By thread, the sequence number of the sample that `wait` returned last."""

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
        given = getattr(self._given, "sequence", 0)

        def has_next() -> bool:
            if self._newest_sample() is None:
                return False
            return not self.has_rate or (self._sequence > given and time.monotonic() - self._arrived <= limit)

        with self._sample_arrived:
            self._waiting += 1
            try:
                came = self._sample_arrived.wait_for(has_next, min(seconds, threading.TIMEOUT_MAX))
            finally:
                self._waiting -= 1
            if not came:
                raise TimeoutError(self._why_none(seconds))
            self._given.sequence = self._sequence
            return self._newest_sample()

    def _summary(self) -> str:
        shown = self._describe() or "nothing yet"
        return f"frozen, {shown}" if self.paused else shown

    # -- for subclasses ------------------------------------------------------------------------------------------------

    def _describe(self) -> str:
        """The sample on show in one line; empty before the first."""
        sample = self._newest_sample()
        return "" if sample is None else repr(sample).strip("<>")

    def _pack(self, sample: S) -> bytes:
        """The bytes of a frame after its header."""
        raise NotImplementedError

    def _unpack(self, frame: bytes) -> S:
        """The sample in a frame, with its header."""
        raise NotImplementedError

    def _on_show(self) -> S | None:
        """The sample on show: the frozen one while paused, else the newest; None before the first."""
        if self.paused:
            return self._unpack(self._frozen_frame) if self._frozen_frame else None
        return self._newest

    def _newest_sample(self) -> Any:
        """The sample that `wait` returns; None before the first one."""
        return self._newest

    def _longest_silence(self) -> float:
        """Seconds without a sample after which the source is silent."""
        rate = self.rate
        return min(max(SHORTEST_SILENCE, 3 / rate), LONGEST_SILENCE) if rate > 0 else LONGEST_SILENCE

    def _about_sample(self, sample: S) -> dict[str, Any]:  # noqa: ARG002
        """Texts on a sample that take time to find; asked for when it is sent, not for each that arrives."""
        return {}

    def _show(self, sample: S, about: dict[str, Any] = NO_TEXTS, *, counts: bool = True) -> None:
        """Store the newest sample, with the texts on it that its caller knows, for the page to show.

        With ``counts=False`` it is an improved version of the previous sample, not a new one.
        """
        with self._sample_lock:
            # Bypasses __setattr__, which would take longer than everything else here.
            mine = self.__dict__
            mine["_newest"], mine["_newest_about"], mine["_changed"] = sample, about, True
            mine["_version"] += 1
            if counts:
                mine["_sequence"] += 1
                mine["_arrived"] = time.monotonic()
            if mine["_waiting"]:
                mine["_sample_arrived"].notify_all()
        self._mark()

    def _say_more(self) -> None:
        """Have the newest sample sent with what was said of it later."""
        with self._sample_lock:
            self._changed = True
        self._mark()

    def _mark(self) -> None:
        """Have the newest sample sent with what is on it, once the verdicts on it are there.

        To send before that would send nothing, and the next send would wait for the interval between two.
        """
        judge = self._judge
        if judge is None or not judge.will_mark(self._version):
            pacer.mark(self)

    def _refuse(self, error: Exception) -> None:
        """Show why a message could not be shown; then raise the error in a cell, and log it in a callback."""
        text = str(error)
        with self._sample_lock:
            self._newest_about = {**self._newest_about, "error": text if text.endswith((".", "?")) else f"{text}."}
            self._changed = True
        pacer.mark(self)
        if called_from_cell():
            raise error from None
        self._log_once(f"a message could not be shown: {text}")

    def _why_none(self, seconds: float) -> str:
        error = self._newest_about.get("error", "")
        reasons = [self._source.get("status", ""), f"what came could not be shown: {error}" if error else ""]
        sample = self._newest_sample()
        if not self._source and not error and sample is None:
            reasons.append("no feed is connected to it; feed.connect(topic, widget) does that")
        why = "; ".join(filter(None, reasons))
        none = f"nothing to show in {seconds:g} s"
        if sample is not None:
            age = time.monotonic() - self._arrived
            none = f"no new {type(sample).__name__.lower()} for {age:.{'1f' if age >= 1 else '2g'}} s"
        return f"{type(self).__name__} {self.title}".rstrip() + f" had {none}" + f": {why}" * bool(why)

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
        if not self.has_rate:
            return float("nan")
        with self._sample_lock:
            return self._meter.rate(self._sequence, self._arrived)

    def send_newest(self) -> int:
        """Send the newest sample to the page; returns the number of bytes sent. The pacer calls it."""
        if os.getpid() != self._process:
            self._log_once(
                "nothing reaches the page from a forked process; hand messages to the notebook's own, "
                "through a multiprocessing.Queue, and update there"
            )
            return 0
        with self._send_lock:
            # Bypasses the descriptors of the traits, which would take longer than everything else here.
            values = self._trait_values
            comm = values.get("comm")
            if comm is None:
                return 0
            self._bring_up_to_date()
            frame, about = newest = values["_frame"], values["_about"]
            keys = []
            if not self.driven_by_player:
                keys += ["_frame"] if frame != self._sent[0] else []
                keys += ["_about"] if about != self._sent[1] else []
            unsent: tuple[str, ...] = ()
            if self._unsent:
                with self._sample_lock:
                    unsent = tuple(self._unsent)
                    self._unsent.clear()
                keys += unsent
            if keys and time.monotonic() >= self._resync_at:
                keys = [*dict.fromkeys((*keys, *RESYNC_TRAITS))]
                self._resync_at = time.monotonic() + RESYNC_S
            try:
                if keys in (["_frame"], ["_frame", "_about"]):
                    # The message that ipywidgets would build, without its cost.
                    state = {"_about": about} if "_about" in keys else {}
                    update = {"method": "update", "state": state, "buffer_paths": [["_frame"]], **message_padding()}
                    comm.send(data=update, buffers=[frame])
                elif keys:
                    super().send_state(keys)
            except BaseException:
                with self._sample_lock:
                    self._unsent.update(unsent)
                raise
            if "_frame" in keys:
                self._sent_frames.add(TimedFrame(self._arrived, about, frame), self.history)
            self._sent = newest
            return len(frame) if "_frame" in keys else 0

    def sent_frames(self) -> list[TimedFrame]:
        """See `WritesPage`."""
        with self._send_lock:
            self._bring_up_to_date()
            newest = TimedFrame(self._arrived, self._about, self._frame)
            kept = [sent for sent in self._sent_frames if sent.frame != newest.frame]
        return [*kept, newest] if newest.frame else kept

    def send_state(self, key: str | Iterable[str] | None = None) -> None:
        """Send traits to the page with the next sample; without names, when a page requests all of them, at once."""
        if key is None or self.comm is None:
            super().send_state(key)
            return
        with self._sample_lock:
            self._unsent.update((key,) if isinstance(key, str) else key)
        pacer.mark(self)

    def get_state(self, key: str | Iterable[str] | None = None, drop_defaults: bool = False) -> dict[str, Any]:  # noqa: ARG002
        """The synced state with the newest sample, for a new view, a reloaded page and a saved notebook.

        Defaults are never dropped: the front end does not know them, and is itself the default of a trait.
        """
        if key is None:
            self._bring_up_to_date()
        state: dict[str, Any] = super().get_state(key)
        if key is None and self._sequence and (self.rate > 0 or self._source):
            # A page that loads the state has not seen the sample arrive and cannot know its age.
            state["_silence"] = time.monotonic() - self._arrived
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
        with self._send_lock:
            super().close()
            pacer.forget(self)

    def _bring_up_to_date(self) -> None:
        """See `FreezableWidget`."""
        with self._send_lock:
            with self._sample_lock:
                if not self._changed:
                    return
                shot: Shot | None = self._newest_shot()
                lamps: list[dict[str, Any]] = []
                if self._judge and shot:
                    shot, lamps = self._judge.choose(shot, self._sent_version)
                if shot is None:
                    return
                self._changed, self._sent_version = shot.version != self._version, shot.version
                _, sequence, arrived, sample, about = shot
                rate = self.rate
                if sample is not None:
                    about = {**self._about_sample(sample), **about}
                if self._png_error:
                    about = {**about, "notes": [*about.get("notes", ()), self._png_error]}
                shown = {**about, **self._on_sample(), **self._plotted.on(sequence)}
            if lamps:
                shown |= {"lamps": lamps, "judged": sequence}
            self._trait_values["_about"] = shown
            if about != self._abouts[-1][1]:
                self._abouts.append((sequence, about))
            if sample is not None:
                stamp = getattr(sample, "stamp_ns", None) or 0
                self._trait_values["_frame"] = FRAME_HEADER.pack(sequence, rate, stamp, arrived) + self._pack(sample)

    def _on_sample(self) -> dict[str, Any]:
        """What else the page is told with the newest sample. Called with the lock of the samples."""
        return {}

    def _newest_shot(self) -> Shot:
        return Shot(self._version, self._sequence, self._arrived, self._newest, self._newest_about)

    def _to_judge(self, shown: Any) -> Any:
        """What conditions are judged on, of a sample as it is shown; None before the first."""
        return shown

    def _why_unknown(self) -> str:
        if self._newest_sample() is None:
            return f"no {self.sample_name} came"
        age = time.monotonic() - self._arrived
        if self.goes_stale and self.has_rate and age > self._longest_silence():
            return self._source.get("status", "") or f"no new {self.sample_name} for {age:.1f} s"
        return ""


_made: weakref.WeakSet[RobotWidget[Any]] = weakref.WeakSet()


def _after_fork() -> None:
    for widget in _made:
        widget._make_locks()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)
