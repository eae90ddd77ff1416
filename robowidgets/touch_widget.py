"""The touch widget: any number of bumpers, cliff sensors, wheel drops and buttons."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterable, Mapping
from typing import Any, ClassVar

import numpy as np
import traitlets

from .messages import to_touch
from .samples import Touch, TouchMode, TouchState
from .samples.checks import in_radians
from .samples.staleness import LIVE
from .samples.touch_tracker import TouchSensor, TouchTracker
from .widget.base_widget import check_given, refuse_unnamed
from .widget.front_end import bundle
from .widget.pacer import pacer
from .widget.robot_widget import RobotWidget
from .widget.timed_frame import FRAME_HEADER


class TouchWidget(RobotWidget[Touch]):
    """Live touch sensors: one labelled rectangle each, white when free, green when touched, gray when unknown.

    Each also shows its state as text, the duration of a touch and the number of touches. They are ordered from the
    robot's left to its right, or around its body if `angles` are given, forward up. A state is kept until the next
    message on its sensor. For sources that list only touched sensors, a touch ends after `hold`. If a message cannot be
    read, the states do not change, with the reason above them.

    Args:
        title: title in the header; usually the topic.
        sensors: names of the sensors to show, from left to right; by default all in the messages. For contacts of a
            simulator: the names of the robot's collisions.
        labels: other texts for the rectangles, by the name of the sensor. Plain text.
        angles: positions of sensors on the body by name, in radians or text like "20deg", counter-clockwise from
            forward, within ±2 pi.
        hold: seconds that a touch outlasts the last message that listed it, 0 or more.
        timeout: seconds of silence after which such a touch is over, infinite to wait for ever; by default `hold`.
        paused: True while the picture is frozen.
        history: seconds for which the page keeps samples to step back through while frozen, 0 (none) to 600.
        header, footer: False to hide them.

    Raises:
        TypeError: an unknown keyword.
        traitlets.TraitError: a value out of its range.

    Source: the dialects in `robowidgets.messages.dialects`.

    Examples:
        >>> touch = TouchWidget(title="/bumper", angles={"left": 0.9, "right": -0.9})
        >>> touch.update(left=True, right=False)
        >>> touch.states["left"].name, touch.touches["left"]
        ('TOUCHED', 1)
    """

    _esm, _css = bundle("touch_widget")
    _meant: ClassVar = {"touched": "states"}

    sample_name = "touch"
    frame_traits = ("hold", "timeout")
    goes_stale = False
    beats = True
    packs_now = True

    sensors = traitlets.List(traitlets.Unicode(), help="Names of the sensors to show, from left to right.").tag(
        sync=True
    )
    labels = traitlets.Dict(
        key_trait=traitlets.Unicode(),
        value_trait=traitlets.Unicode(),
        help="Labels by the name of the sensor, plain text.",
    ).tag(sync=True)
    angles = traitlets.Dict(
        key_trait=traitlets.Unicode(),
        help="Radians counter-clockwise from forward by the name of the sensor, within ±2 pi.",
    ).tag(sync=True)
    hold = traitlets.Float(0.15, help="Seconds that a touch outlasts the last message that listed it, 0 or more.")
    timeout = traitlets.Float(
        None, allow_none=True, help="Seconds of silence after which such a touch is over; hold by default."
    )

    def __init__(self, **kwargs: Any) -> None:
        self._tracker = TouchTracker()
        self._still_ns: int | None = None
        self._packed_ns: int | None = None
        """The time whose states are being packed."""
        self._states_sent: dict[str, TouchState] = {}
        """The states that were sent last."""
        self._judged: dict[str, TouchState] = {}
        """The states in the last judgement of conditions."""
        super().__init__(**kwargs)

    def _describe(self) -> str:
        return ", ".join(f"{name} {state.name.lower()}" for name, state in self.states.items())

    def make_locks(self) -> None:
        """See `PacedWidget`."""
        super().make_locks()
        self._tracking = threading.Lock()

    def update(self, message: Any = None, *unnamed: Any, **touched: bool | int | None) -> None:
        """Show the states in a message in the next animation frame.

        It only stores the states, and may be called from any thread at any rate.

        Args:
            message: a message of rclpy, rospy or rosbags in a dialect of `robowidgets.messages.dialects`, a rosbridge
                dictionary, a mapping of sensor names to True, False or None, or a `Touch`.
            *unnamed: raises an error with the call that takes sensors by name.
            **touched: instead of a message, sensor names with True, False, 1, 0 or None.

        Raises:
            TypeError: not such a message. ValueError: a number in it has no meaning. A callback (another thread; a
                task, timer or button of a notebook) raises nothing; the widget and the log show the error.
        """
        try:
            refuse_unnamed("update", unnamed, "update(left=True, right=False)")
            instead = "or sensors by name, like update(left=True, right=False)"
            check_given("update", message, touched, instead, noun="sensors")
            touch = to_touch(_with_flags(touched) or message, own=tuple(self.sensors))
        except (TypeError, ValueError) as error:
            self._refuse(error)
            return
        with self._tracking:
            self._still_ns = None
            self._tracker.apply(touch, self._now_ns())
        self._show(touch, about_touch(touch))

    def show(self, tracker: TouchTracker, now_ns: int) -> None:
        """Show the states of a tracker at a time, until the next call, for recordings.

        Args:
            tracker: the tracker. It keeps its hold and timeout until hold or timeout of the widget is set.
            now_ns: nanoseconds by the clock of the tracker's messages.
        """
        with self._tracking:
            self._tracker, self._still_ns = tracker, now_ns
        newest = tracker.newest or Touch({})
        is_another = tracker.newest is not None and tracker.newest is not self._newest.sample
        self._show(newest, {**about_touch(newest), "still": True}, counts=is_another)

    @property
    def states(self) -> dict[str, TouchState]:
        """The state of each sensor on show: the frozen one while paused, else the newest."""
        return {name: sensor.state for name, sensor in self._sensors_on_show().items()}

    @property
    def touches(self) -> dict[str, int]:
        """The number of touches of each sensor on show; frozen while paused."""
        return {name: sensor.touches for name, sensor in self._sensors_on_show().items()}

    @property
    def frozen(self) -> dict[str, TouchState] | None:
        """The states on show while frozen, or None while live."""
        return self.states if self.paused else None

    def reset(self) -> None:
        """Forget states and counts: every sensor is unknown until the next message on it."""
        with self._tracking:
            self._tracker.reset()
        self._send_again()

    def send_newest(self) -> int:
        """Send the current states to the page, and return the number of bytes sent. The pacer calls this."""
        with self._send_lock:
            states = self._states_at(self._now_ns())
            if states != self._states_sent:  # even without a message; the page itself counts how long they last
                self._states_sent, self._newest.changed = states, True
            size = super().send_newest()
            with self._tracking:
                changes = self.comm is not None and self._still_ns is None
                due_ns = self._tracker.next_change_ns(self._now_ns()) if changes else None
            pacer.mark_at(self, None if due_ns is None else due_ns / 1e9)
            return size

    def get_state(self, key: str | Iterable[str] | None = None, drop_defaults: bool = False) -> dict[str, Any]:
        """Return the synced state with the current states and durations."""
        if key is None:
            self._newest.changed = True
        return super().get_state(key, drop_defaults)

    def _to_judge(self, shown: Touch | None) -> Touch | None:
        """Return the current states of all sensors, in any mode of the source."""
        self._judged = self._states_at(self._now_ns())
        if shown is None:
            return None
        touched = {name: state.as_bool for name, state in self._judged.items()}
        return Touch(touched, stamp_ns=shown.stamp_ns, dialect=shown.dialect)

    def _bring_up_to_date(self) -> None:
        """Get states judged again if they have changed without a message, such as the end of a held touch."""
        with self._send_lock:
            self._packed_ns = self._now_ns()
            if self.watched and self._states_at(self._packed_ns) != self._judged:
                with self._newest.lock:
                    self._newest.renew()
            super()._bring_up_to_date()
            self._packed_ns = None

    def _states_at(self, now_ns: int) -> dict[str, TouchState]:
        with self._tracking:
            return {name: sensor.state for name, sensor in self._tracker.states(now_ns).items()}

    def _longest_silence(self) -> float:
        """Return the longest time for events, because they have no rate."""
        newest = self._newest.sample
        is_events = newest is not None and newest.mode is TouchMode.EVENT
        return LIVE.longest if is_events else super()._longest_silence()

    def _pack(self, sample: Touch) -> bytes:  # noqa: ARG002  # the tracker contains its states
        with self._tracking:
            return pack_states(self._tracker, self._packed_ns or self._now_ns())

    def _now_ns(self) -> int:
        return time.monotonic_ns() if self._still_ns is None else self._still_ns

    def _sensors_on_show(self) -> dict[str, TouchSensor]:
        if self.paused:
            rows = json.loads(self._frozen_frame[FRAME_HEADER.size :]) if self._frozen_frame else []
            known = {name: TouchSensor(TouchState[word.upper()], touches) for name, word, touches, _ in rows}
        else:
            with self._tracking:
                known = self._tracker.states(self._now_ns())
        return {name: known.get(name, TouchSensor()) for name in self.sensors or known}

    def _send_again(self) -> None:
        if self._newest.sample is not None:
            pacer.mark(self)

    @traitlets.validate("hold", "timeout")
    def _seconds(self, proposal: Any) -> Any:
        try:
            TouchTracker(**{proposal["trait"].name: proposal["value"]})
        except (TypeError, ValueError) as error:
            raise traitlets.TraitError(str(error)) from None
        return proposal["value"]

    @traitlets.observe("hold", "timeout")
    def _set_times(self, _change: Any) -> None:
        with self._tracking:
            self._tracker.hold, self._tracker.timeout = self.hold, self.timeout
        self._send_again()

    @traitlets.validate("angles")
    def _in_radians(self, proposal: Any) -> Any:
        try:
            return {name: in_radians(f"angles[{name!r}]", angle) for name, angle in proposal["value"].items()}
        except (TypeError, ValueError) as error:
            raise traitlets.TraitError(str(error)) from None

    @traitlets.validate("sensors")
    def _once_each(self, proposal: Any) -> Any:
        names = proposal["value"]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise traitlets.TraitError(f"sensors: expected each name once, got {twice!r} more than once")
        return names


def about_touch(touch: Touch) -> dict[str, Any]:
    """Return the texts on a touch."""
    return {"dialect": touch.dialect, "mode": touch.mode.value}


def pack_states(tracker: TouchTracker, now_ns: int) -> bytes:
    """Return the bytes of a frame after its header: the states of a tracker at a time."""
    known = tracker.states(now_ns)
    return json.dumps(
        [(name, sensor.state.name.lower(), sensor.touches, _age(sensor, now_ns)) for name, sensor in known.items()]
    ).encode()


def _age(sensor: TouchSensor, now_ns: int) -> float | None:
    return None if sensor.since_ns is None else max(0, now_ns - sensor.since_ns) / 1e9


def _with_flags(touched: Mapping[str, Any]) -> dict[str, Any]:
    """Return sensors by name, with 1 and 0 as True and False."""
    return {name: bool(state) if _is_bit(state) else state for name, state in touched.items()}


def _is_bit(state: Any) -> bool:
    """Return True for a whole number, of Python or NumPy, that is 1 or 0."""
    return isinstance(state, (int, np.integer)) and state in (0, 1)
