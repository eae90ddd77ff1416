"""A recording on the page: one widget for each topic that has one, and a player for its time."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import ipywidgets
import traitlets

from ..events.frames import event_marks, marks_of
from ..export.html import MAX_SIZE, SUFFIXES, Page, check_texts
from ..in_rerun.widget import RerunWidget
from ..kinds import on_demand_for_fields, on_demand_for_type
from ..kinds.choice import (
    Entry,
    TopicRequest,
    TopicSelection,
    WidgetChoice,
    checked_arrangement,
    choose_widgets,
    of_topic,
    parse_requests,
    why_no_plot,
)
from ..laser.row import LASER
from ..lines.recorded_lines import RecordedLinesWidget
from ..message_widget import MessageWidget
from ..messages.brief import brief
from ..notebook.cells import close_all, predecessor
from ..player_widget import PlayerWidget
from ..poses.places import WITHIN, Places
from ..recordings import RecordingData
from ..recordings.data import NO_SENSOR
from ..recordings.labels import SHORTEST
from ..recordings.odometry import places_of
from ..recordings.search.lines import check_function
from ..recordings.search.spans import Spans
from ..recordings.times import has_date
from ..recordings.topics import UnknownTopicError, shown, wanted
from ..repair import RecordingError
from ..runtime.output_file import checked_output
from ..samples.state_span import rows_of
from ..scanogram.overview import is_planar, whole_drive
from ..scanogram_widget import ScanogramWidget
from ..screen_widget import ScreenWidget
from ..speed_widget import SpeedWidget
from ..topics_widget import TopicRow, TopicsWidget
from ..touch.marks import touch_marks
from ..touch.row import TOUCH
from ..tracks import LOOKED_AT, Track, moment_at, moments_of, silent_after, track_of
from ..widget.cards import as_arrangement, as_entries, checked_cards
from ..widget.freezing import freeze_together
from ..widget.sample_widget import SampleWidget
from ..widget.time_traits import Marks, PlaybackSpeed, Seconds, TimeSpan
from ..widget.traits import Flag
from ..wires.recorded import RecordedWires
from ..wires_widget import WiresWidget
from ._leader import Leader
from ._lines import PlayerLines
from ._parts import LeadingPlayer, PlayerView, followers
from ._prefetcher import SEGMENT, Prefetcher, segment
from ._to_html import LONGEST_SEGMENT, Wanted, page_of
from .layout import ScreenPlaces, in_columns, on_one_screen

LONGEST_LOOK = 0.1
"""The maximum time in seconds for reading values for the list of topics whenever the shown time changes."""

_EARLY = 0.1
_TINY = 1e-7

_WIDE = {"flex_flow": "row wrap", "align_items": "flex-start", "width": "100%"}
_BESIDE = {"min_width": "min(100% - 8px, 300px)", "margin": "0 4px"}
HELD_BYTES, HELD_SEGMENTS = 200_000, 30
"""The approximate bytes, and the maximum number of segments, in the state of a player, which a saved notebook contains.
The page gets them at once, and the others from a thread."""

_VIEWER = "660px"
"""The minimum width: in less, Rerun hides its time."""


class Player(ScreenWidget):
    """Widgets for the topics of a recording, which all show the same time; `Recording.show` returns it.

    Each widget shows the last sample at that time or before it. A commanded speed is a tick on the bars of the measured
    speed, or has its own bars if no speed was measured. The page plays, steps and drags without the kernel, from
    segments of the recording that Python sends in advance, so it continues while a cell runs. `close` removes
    everything from the page and closes the recording; running the cell again does the same.

    Args:
        recording: the recording. No other code may read it meanwhile.
        topics: names of topics in it, or of fields, ``"/odom.twist.twist.linear.x"``. Without names, all topics with a
            widget and a message; without such topics, a few general widgets.
        scanogram: True to show a scanogram of the first topic with scans above the widgets, or None to show it if it
            takes a few seconds at most, and otherwise a line with the reason; of a drive of too many bytes, a few parts
            of the file are shown.
        rerun: True to show the Rerun viewer next to the widgets, at the same time.
        lines: a function or a program whose lines are shown, or the result of `Recording.find` with a function; None
            for the programs whose text is in the recording.

    Raises:
        UnknownTopicError: the topic does not exist, or no widget shows it. KeyError: the field does not exist.
        ImportError: ``rerun`` is set, and Rerun is not installed.
    """

    time = Seconds(help="The shown time in seconds from the start of the recording. Settable.")
    playing = Flag(False, help="True while it plays. Settable.")
    speed = PlaybackSpeed(1.0, help="Seconds of the recording per second. Settable.")
    loop = Flag(False, help="True to start again at the end, or at the end of the selection. Settable.")
    selection = TimeSpan(help="The span that loops: (start, end) in seconds from the start, or None. Settable.")
    marks = Marks(help="Marks on slider and scanogram: (start, end, text), in seconds. Touches, errors; settable.")

    rerun: RerunWidget | None = None
    _prefetcher: Prefetcher | None = None
    _leader: Leader | None = None
    scanogram: ScanogramWidget | None = None
    topic_list: TopicsWidget | None = None
    wires: WiresWidget | None = None
    _lines: PlayerLines | None = None

    def __init__(
        self,
        recording: RecordingData,
        topics: Sequence[str] = (),
        scanogram: bool | None = None,
        rerun: bool = False,
        arrangement: Any = None,
        lines: Any = None,
    ) -> None:
        earlier = predecessor(self, Player)
        is_again = earlier is not None and earlier.recording.path == recording.path
        self.recording = recording
        self.views: tuple[PlayerView, ...] = ()
        self._silences: dict[WidgetChoice, float] = {}
        asked = list(topics) if arrangement is None else [*topics, *checked_arrangement(arrangement)]
        _check(recording, asked)
        if lines is not None and not isinstance(lines, Spans):
            check_function(lines)
        self.rerun = RerunWidget(recording, topics, layout={**_BESIDE, "flex": f"3 1 {_VIEWER}"}) if rerun else None
        self.on_show = TopicSelection(asked)
        if is_again:
            self.on_show.keep(earlier.on_show)
        self._seeking = threading.RLock()
        shown = self._choose()
        self._set_views(shown)
        moves = recording.duration and self.views
        scanned = next((choice.topic for choice in shown if choice.kind.name == LASER.name), "") if moves else ""
        beside = [name for choice in shown if not choice.takes_messages for name in choice.topics]
        self.scanogram, note = whole_drive(recording, scanned, beside, scanogram, may_thin=True)
        self._show_used_axes(self.views)
        self.bar = self._make_bar(note)
        self._lines = PlayerLines(recording, self.bar, lines)
        self._lines.join(self._group)
        if moves and not rerun:
            self.topic_list = TopicsWidget(self._on_toggle, self._values_of)
            self.topic_list.set_rows(_rows(recording))
            self.topic_list.observe(self._on_wires, "wires")
        super().__init__("recording", self._everything, arrangement)
        self._list_shown()
        for name in ("time", "playing", "speed", "loop", "selection", "marks"):
            setattr(self, name, getattr(self.bar, name))
            self.observe(self._to_bar, name)
            self.bar.observe(self._from_bar, name)
        self._prefetcher = self._make_prefetcher()
        self.bar.on_msg(self._on_page)
        self.bar.observe(self._on_time, ["time", "playing", "speed", "loop", "selection"])
        if self.scanogram:
            self.scanogram.time = self.bar.time
            self.scanogram.observe(self._on_time_of, "time")
            self.bar.observe(partial(_select, self.scanogram), "selection")
            traitlets.link((self.bar, "marks"), (self.scanogram, "marks"))
        if self.rerun:
            traitlets.link((self, "time"), (self.rerun, "time"))
            # Rerun's viewer is no anywidget, so it cannot be on the screen itself.
            self.layout = {**_BESIDE, "flex": "2 1 380px"}
            self._beside = ipywidgets.Box([self.rerun, self], layout=_WIDE)
        self._on_time(None)
        if is_again:
            self.keep_cards(earlier)
        if earlier is not None and self.topic_list is not None and earlier.topic_list is not None:
            self.topic_list.keep(earlier.topic_list)

    def _repr_mimebundle_(self, **kwargs: Any) -> Any:
        """Return the output of a cell: the player, with the Rerun viewer at its left if it has one."""
        if self.rerun is None:
            return super()._repr_mimebundle_(**kwargs)
        return self._beside._repr_mimebundle_(**kwargs)

    def _in_words(self) -> str:
        """Return one line on what the player shows, for its repr."""
        shown = ", ".join(dict.fromkeys(title for view in self.views for title in view.choice.titles))
        return f"<Player {self.recording.path.name}: {self.time:.2f} of {self.duration:.2f} s, {shown or 'no topics'}>"

    @property
    def lines(self) -> RecordedLinesWidget | None:
        """The widget of the lines of a function, or of the recorded programs; None without any."""
        return self._lines.widget if self._lines is not None else None

    def show_lines(self, function: Any) -> None:
        """Show the lines of a function or a program below the other widgets, instead of those shown before."""
        before, self._lines = self._lines, PlayerLines(self.recording, self.bar, function)
        self._lines.join(self._group)
        self._arrange()
        if before is not None:
            before.close()

    @property
    def duration(self) -> float:
        """Seconds of the recording."""
        return self.recording.duration

    @property
    def followed(self) -> LeadingPlayer | None:
        """The player that this one follows, or None."""
        return self._leader.player if self._leader else None

    def places(self) -> Places:
        """Return the places of the robot at each of its scans, by odometry; without scans, at each odometry message.

        Raises:
            UnknownTopicError: the recording has no odometry.
        """
        with self._seeking:
            return places_of(self.recording)

    def seek(self, seconds: float) -> None:
        """Show a time, in seconds from the start of the recording.

        Raises:
            traitlets.TraitError: the value is not a time.
        """
        self.time = seconds

    def follow(self, other: Player | None, origin: Sequence[Any] = (0, 0, 0), within: float = WITHIN) -> None:
        """Go to the same place whenever another player moves, on the page and from Python; None to stop following.

        The same place is the scan nearest to the place of the other robot's shown scan, by the odometry of both. If no
        scan is near enough, this player keeps its time, and its bar shows a note.

        Args:
            other: the player of another run, or of the same recording.
            origin: x and y in metres and yaw in radians, or as "20deg", at which the odometry of this recording starts
                in the odometry frame of the other. By default both start at the same place.
            within: the maximum distance in metres; a radian of heading counts as a metre.

        Raises:
            UnknownTopicError: one of the recordings has no odometry.
            ValueError: the robots were never near each other; or the other player follows this one.
            TypeError: ``other`` is not a player.
        """
        if not isinstance(other, Player | None):
            raise TypeError(f"follow: expected another player or None, got {type(other).__name__}")
        leader = Leader(self, other, origin, within) if other else None
        if self._leader:
            self._leader.leave()
        self._leader = leader
        self.bar.follow(leader.state if leader else {})

    def to_html(
        self,
        path: str | os.PathLike[str],
        *,
        start: float | None = None,
        end: float | None = None,
        title: str = "",
        note: str = "",
        every: int = 1,
        scanogram: bool | None = None,
        max_size: int | None = MAX_SIZE,
    ) -> Path:
        """Write a page that plays the shown widgets: one file, without a kernel, a server or the web.

        It includes the selection, the marks and the settings of the widgets. If the player has no scanogram, the page
        gets one if that is quick. Arguments and errors are as for `Recording.to_html`.
        """
        target = checked_output("to_html", path, SUFFIXES)
        check_texts(title, note, max_size)
        with page_of(self, Wanted(start, end, title, note, every), scanogram) as page:
            return page.write(target, max_size)

    def pages(self, moments: Iterable[tuple[float, float, float]]) -> Iterator[Page]:
        """Yield the page for each start, end and shown time in seconds, as `to_html` writes it.

        Each has as few segments as possible, because each segment reads a part of the file again.
        """
        for start, end, shown_at in moments:
            with page_of(self, Wanted(start, end, time=shown_at, segment=LONGEST_SEGMENT), False) as page:
                yield page

    def html_size(
        self,
        *,
        start: float | None = None,
        end: float | None = None,
        every: int = 1,
        scanogram: bool | None = None,
    ) -> int:
        """Return about how many bytes `to_html` would write. See `Recording.html_size`."""
        with page_of(self, Wanted(start, end, every=every), scanogram) as page:
            return page.size()

    def close(self) -> None:
        """Remove the player from the page and close the recording."""
        if self._lines is not None:
            self._lines.close()
        if self._prefetcher:
            self.follow(None)
            self._prefetcher.close()
            close_all(self.bar)
        views = [view.widget for view in self.views]
        for widget in (self.scanogram, *self.children, *views, self.rerun):
            if widget is not None:
                close_all(widget)
        if self.rerun:
            self._beside.layout.close()
            self._beside.close()
        super().close()
        self.recording.close()

    def _make_bar(self, note: str) -> PlayerWidget:
        """Make the bar. Its state contains the first segments, which play in a saved notebook without a kernel."""
        seconds = _first_look(self.recording, self.views)
        touching = [view.choice.topic for view in self.views if view.choice.kind.name == TOUCH.name]
        start_ns = self.recording.start_ns or 0
        return PlayerWidget(
            duration=self.recording.duration,
            time=seconds,
            _segment=SEGMENT,
            _start=start_ns / 1e9 if has_date(start_ns) else None,
            _note=note,
            marks=marks_of(touch_marks(self.recording, touching), event_marks(self.recording)),
            labels=_labels(self.recording),
            # The scanogram shows all rows.
            states=rows_of(self.recording.states)[: 1 if self.scanogram else None],
            **self._of_views(seconds),
        )

    def _of_views(self, seconds: float) -> dict[str, Any]:
        """Return the traits of the bar that depend on the shown widgets, with the first segments from a time on."""
        return {
            "_targets": [view.widget.model_id for view in self.views],
            "_pauses": [self._pause(view.choice) for view in self.views],
            "_followers": followers(self.views, self.scanogram),
            "_first": [*self._first_segments(int(seconds // SEGMENT))],
        }

    def _pause(self, choice: WidgetChoice) -> float:
        """Return the seconds of silence after which a widget's content is stale. The first call reads the file."""
        if choice not in self._silences:
            self._silences[choice] = _pause(self.recording, choice)
        return self._silences[choice]

    def _make_prefetcher(self) -> Prefetcher:
        return Prefetcher(self._open_tracks, self._send_ahead, self.recording.duration, self._complain)

    def _first_segments(self, first: int) -> Iterator[dict[str, Any]]:
        """Yield the segments from a number on, as many as a notebook contains, in the form of the page."""
        tracks, size = [view.track for view in self.views], 0
        last = int(self.recording.duration // SEGMENT)
        for index in range(first, min(last + 1, first + HELD_SEGMENTS)):
            abouts, frames = segment(tracks, index)
            yield {"segment": index, "drop": [], "abouts": abouts, "tracks": frames}
            size += sum(map(len, frames))
            if size >= HELD_BYTES:
                return

    def tracks_of(self, recording: RecordingData) -> list[tuple[SampleWidget, Track]]:
        """Return its widgets, each with a track that reads the given recording, in one thread at a time."""
        return [(view.widget, track_of(recording, view.choice, view.widget)) for view in self.views]

    @contextmanager
    def _open_tracks(self) -> Iterator[Sequence[Track]]:
        with self.recording.reopened() as recording:
            yield [track for _, track in self.tracks_of(recording)]

    def _send_ahead(self, content: dict[str, Any], buffers: list[bytes]) -> None:
        self.bar.send(content, buffers)

    def _complain(self, problem: str) -> None:
        self.bar.complain(problem)

    def arranged(self, scanogram: ScanogramWidget | None) -> ScreenPlaces:
        """Return the places of all widgets, with the given scanogram among them."""
        widgets = [view.widget for view in self.views]
        moves = self.recording.duration and widgets
        bar = [self.bar] if moves else []
        if self.topic_list is None:
            return {"bar": [*bar, *([scanogram] if scanogram else [])], **in_columns(widgets)}
        added = [view.widget for view in self.views if view.choice.takes_messages]
        others = [widget for widget in widgets if widget not in added]
        wide = [widget for widget in others if widget.column == "wide"]
        if not wide and not scanogram:  # nothing else needs the space
            wide = [widget for widget in widgets if widget.column == "map"]
        small, added = ([widget for widget in some if widget not in wide] for some in (others, added))
        # A picture that the user names first gets the first place.
        named = next(iter(self._shown_entries()), "")
        first = next((view.widget for view in self.views if view.choice.topic == named), None)
        if first in added and first.column == "wide":
            wide = [first, *wide]
        small, added = ([widget for widget in some if widget not in wide] for some in (small, added))
        places = on_one_screen([scanogram] if scanogram else [], wide, small, added)
        return {"bar": [self.bar], "topics": [self.topic_list], **places}

    @property
    def arrangement(self) -> Any:
        """The shown topics and fields, as `Recording.show` takes them; a list contains fields that share a plot.

        If the user has arranged the cards, a dictionary with these topics and the cards. It can be stored as JSON, set
        again, or passed to `Recording.show`.
        """
        return as_arrangement(self._cards, self._shown_entries())

    @arrangement.setter
    def arrangement(self, entries: Any) -> None:
        asked, cards = checked_arrangement(entries), checked_cards(entries)
        _check(self.recording, asked)
        self.on_show.arrange(asked)
        self._cards = cards
        self._show_chosen()

    def card_name(self, widget: Any, kind: str) -> str:
        """Return the name of a widget in an arrangement by hand: its topics, or the name of its kind."""
        named = next((view.choice.card_name for view in self.views if view.widget is widget), None)
        return named or kind

    def _shown_entries(self) -> Sequence[Entry]:
        recording = self.recording
        return self.on_show.entries(wanted(recording.topics, ()), lambda name: not recording.why_unreadable(name))

    def _choose(self) -> tuple[WidgetChoice, ...]:
        """Choose the widgets to show."""
        return choose_widgets(self.recording.topics, self._shown_entries())

    def _set_views(self, shown: Sequence[WidgetChoice]) -> tuple[PlayerView, ...]:
        """Make a view for each choice, keep views that exist, and return the new ones."""
        there = {view.choice: view for view in self.views}
        self.views = tuple(there.get(choice) or _view(self.recording, choice) for choice in shown)
        new = tuple(view for view in self.views if view.choice not in there)
        for view in new:
            view.widget.has_rate = False
            view.widget.follow_player()
            if view.widget.frame_traits:
                view.widget.observe(self._on_frame_trait, view.widget.frame_traits)
            if view.widget.has_trait("time"):
                view.widget.observe(self._on_time_of, "time")
            if isinstance(view.widget, MessageWidget):
                view.widget.offer_plots(partial(self._plot_field, view.choice.topic))
        self._group = freeze_together(view.widget for view in self.views)
        if self._lines is not None:
            self._lines.join(self._group)
        return new

    def _show_used_axes(self, views: Iterable[PlayerView]) -> None:
        if self.scanogram and not self.scanogram.is_thinned:  # making it has read the measured speeds
            for view in views:
                if isinstance(view.widget, SpeedWidget):
                    view.widget.planar = is_planar(self.recording, view.choice.topics)

    def _on_frame_trait(self, _change: Any) -> None:
        if self._prefetcher:
            self._prefetcher.start()

    def _plot_field(self, topic: str, path: str) -> None:
        """Show a plot of a field, at the user's request."""
        self._on_toggle(f"{topic}.{path}", True)

    def _on_toggle(self, topic: str, on: bool) -> None:
        """Show a topic, or remove it with its fields, at the user's request."""
        known = {one.name: one for one in self.recording.topics}
        if on:
            _check(self.recording, [topic])
            self.on_show.add(topic)
        else:
            self.on_show.take_off(of_topic(topic, self._shown_entries(), known))
        self._show_chosen()

    def _on_wires(self, change: Any) -> None:
        """Show the wires below the rest, or hide them, at the user's request."""
        with self._seeking:
            before, self.wires = self.wires, None
            if change["new"]:
                self.wires = WiresWidget(RecordedWires(self.recording))
                self.wires.on_open(self._toggle_messages)
            self._arrange()
        if before is not None:
            before.close()

    def _toggle_messages(self, topic: str) -> None:
        """Show the messages of a topic field by field, or hide them, at the user's request."""
        self.on_show.toggle(f"{topic} as message")
        self._show_chosen()

    def _values_of(self, names: Sequence[str]) -> dict[str, str]:
        """Return the values of topics at the shown time, of as many topics as can be read quickly."""
        values: dict[str, str] = {}
        began = time.monotonic()
        of_kind = shown(self.recording.topics)
        with self._seeking:
            for name in names:
                if time.monotonic() - began > LONGEST_LOOK:
                    break
                try:
                    at = self.recording.at if name in of_kind else self.recording.message_at
                    moment = at(name, self.bar.time)
                except RecordingError:  # its row shows why it cannot be read; or the recording is closed
                    values[name] = ""
                    continue
                values[name] = brief(moment.sample) if moment else "nothing yet"
        return values

    def _show_chosen(self) -> None:
        """Show the current choice of widgets. Runs in the main thread or a subshell's."""
        with self._seeking:
            before = self.views
            new = self._set_views(self._choose())
            self._show_used_axes(new)
            if self._prefetcher:
                self._prefetcher.close()
            with self.bar.hold_sync():
                for name, value in self._of_views(self.bar.time).items():
                    setattr(self.bar, name, value)
            self._prefetcher = self._make_prefetcher()
            self._prefetcher.start()
            self._arrange()
            for view in before:
                if view not in self.views:
                    close_all(view.widget)
            self._on_time(None)

    def _arrange(self) -> None:
        """Put all shown widgets into their places."""
        self.place(self._everything)
        self._list_shown()

    @property
    def _everything(self) -> ScreenPlaces:
        """The places of all widgets. A page in a file lacks some, which need Python."""
        foot = [widget for widget in (self.lines, self.wires) if widget is not None]
        return {**self.arranged(self.scanogram), "foot": foot}

    def _list_shown(self) -> None:
        """Mark the shown topics in the list, and give them to the page for the code of an arrangement."""
        self._entries = as_entries(self._shown_entries())
        if self.topic_list is not None:
            self.topic_list.show(view.choice for view in self.views)

    def _from_bar(self, change: Any) -> None:
        setattr(self, change["name"], change["new"])

    def _on_time_of(self, change: Any) -> None:
        """Go to the time to which a program moved another widget. For the user, the page moves the player itself."""
        if change["new"] is not None and "time" not in change["owner"]._property_lock:
            self.time = change["new"]

    def _to_bar(self, change: Any) -> None:
        name, value = change["name"], change["new"]
        if getattr(self.bar, name) != value:
            setattr(self.bar, name, value)
            if name == "time":
                # While a page plays, it takes a time from Python for the time of another page.
                self.bar.send({"seek": value})

    def _on_page(self, _bar: PlayerWidget, content: dict[str, Any], _buffers: Any) -> None:
        """Handle a message of the page: it lacks all segments or the one at a time, or asks for a step or a label."""
        ahead = self._prefetcher
        if ahead is None:
            return
        if "have" in content:
            ahead.start()
        elif "pointed" in content:
            ahead.point(content["pointed"])
        elif "step" in content:
            self._step(*content["step"])
        elif "label" in content:
            self._label(content["label"])

    def _label(self, asked: Any) -> None:
        """Add a label, remove one, or both: the new one and the old one, either may be None."""
        problem, stored = "", None
        try:
            new, old = asked
            with self._seeking:
                gone = [one for one in self.recording.labels if old and [one.start, one.end, one.label] == old]
                if old and not gone:
                    raise ValueError(f"the label {old[2]!r} was changed or removed meanwhile; nothing is changed now")
                if new is not None:
                    start, end, name = new
                    named = self.recording.label(name, start, max(end, start + SHORTEST))
                    stored = [named.start, named.end, named.label]
                    gone = [label for label in gone if label != named]
                for label in gone:
                    self.recording.remove_label(label)
            self.read_labels()
        except (RecordingError, TypeError, ValueError) as error:
            problem = str(error)
        self.bar.send({"labelled": asked, "stored": stored, "problem": problem})

    def read_labels(self) -> None:
        """Show the current labels of the recording."""
        with self._seeking:
            labels = _labels(self.recording)
        self.bar.labels = labels

    def _step(self, seconds: float, direction: int) -> None:
        """Go from a time to the next or previous sample of the first widget, which may be an hour away."""
        with self._seeking:
            if not self.views:
                return
            choice = self.views[0].choice
            if direction > 0:
                later = moments_of(self.recording, choice, choice.requested, seconds)
                found = next((m for m in later if m.seconds > seconds), None)
            else:
                last = (moment_at(self.recording, choice, topic, seconds - _TINY) for topic in choice.requested)
                found = max((m for m in last if m), key=lambda m: m.time_ns, default=None)
        if found:
            self.bar.send({"seek": found.seconds, "step": [seconds, direction]})

    def _on_time(self, change: Any) -> None:
        bar, ahead = self.bar, self._prefetcher
        assert ahead is not None
        # After a change of another trait, the time that the page sent last is outdated.
        seconds = bar.time if change is None or change["name"] == "time" else None
        ahead.set_time(seconds, bar.speed if bar.playing else 0.0, bar.span, loops=bar.loop)
        if seconds is None:
            return
        # Messages of the page may arrive in another thread while a cell runs.
        with self._seeking:
            for view in self.views:
                view.track.seek(self.bar.time)
            self._tell_problems()
        if self.topic_list is not None and not bar.playing:
            self.topic_list.tell_values(bar.time)

    @property
    def problems(self) -> list[str]:
        """The problems of the recording that are problems of the screen, too."""
        # If widgets are shown nevertheless, a recording without known sensors is not a problem for the user.
        return [line for line in self.recording.problems if line != NO_SENSOR or not self.views]

    def _tell_problems(self) -> None:
        """Show the problems of the recording. Some are found only when it is read."""
        self.note([f"⚠ {line}" for line in self.problems])


def _select(scanogram: ScanogramWidget, change: Any) -> None:
    """Select the span of the bar in the scanogram, whose selection may contain rays, too."""
    selected = scanogram.selection
    if change["new"] != (selected and selected[:2]):
        scanogram.selection = change["new"]


def _labels(recording: RecordingData) -> list[tuple[float, float, str]]:
    """Return the labels of a recording as marks."""
    return [(one.start, one.end, one.label) for one in recording.labels]


def _check(recording: RecordingData, entries: Sequence[Entry]) -> None:
    """Check that a recording is open, and that widgets can show these topics and fields of it."""
    recording.samples(())
    for entry in entries:
        if not isinstance(entry, (str, tuple)):
            raise TypeError(f"expected the name of a topic as text, got {entry!r}")
    for request in parse_requests(entries, [topic.name for topic in recording.topics]):
        _check_entry(recording, request)


def _rows(recording: RecordingData) -> Iterator[TopicRow]:
    """Yield the topics of a recording for the list."""
    for topic in recording.topics:
        why = topic.problem or ("" if topic.widget else recording.why_unreadable(topic.name))
        on_demand = None if why else on_demand_for_type(topic.type)
        row = topic.widget or (on_demand.name if on_demand else "")
        problem = why or ("" if row else f"no widget shows {topic.type}")
        yield TopicRow(topic.name, topic.type, topic.count, topic.rate, row, problem)


def _check_entry(recording: RecordingData, request: TopicRequest) -> None:
    """Check that a topic or a field exists, and that a widget can show it."""
    topic = next((one for one in recording.topics if one.name == request.topic), None)
    if request.field and topic is not None and on_demand_for_fields():
        recording.fields(request.topic)[[request.field]]  # raises if the field does not exist
    elif topic is None or request.field or not (topic.widget or request.row or on_demand_for_type(topic.type)):
        recording.check(request.topic)
    elif why := why_no_plot(request, topic.type):
        raise ValueError(why)
    elif (not topic.widget or request.row) and (why := recording.why_unreadable(request.topic)):
        raise UnknownTopicError(f"{recording.path.name}: topic {request.topic!r} cannot be shown: {why}")


def _view(recording: RecordingData, choice: WidgetChoice) -> PlayerView:
    widget = choice.make()
    return PlayerView(widget, choice, track_of(recording, choice, widget))


def _pause(recording: RecordingData, choice: WidgetChoice) -> float:
    """Return the seconds after which a shown sample is stale, or 0 for never."""
    if not choice.kind.goes_stale:
        return 0.0
    return silent_after(islice(moments_of(recording, choice, (choice.topic,)), LOOKED_AT))


def _first_look(recording: RecordingData, views: Iterable[PlayerView]) -> float:
    """Return the earliest time at which every topic that starts early has a sample."""
    firsts = (
        next(moments_of(recording, view.choice, (topic,)), None) for view in views for topic in view.choice.topics
    )
    seconds = [first.seconds for first in firsts if first]
    return max((s for s in seconds if s <= _EARLY * recording.duration), default=min(seconds, default=0.0))
