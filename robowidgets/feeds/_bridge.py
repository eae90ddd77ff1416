"""The base of the middlewares with a protocol over a websocket."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections import Counter, deque
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

from ..notebook import in_browser
from ..runtime.clock import Clock
from ..runtime.urls import without_secrets
from ._threaded import ThreadedMiddleware
from ._websocket import COMPARE, LARGEST, Frame, WebSocket, checked
from .middleware import MOST_UNREAD, FeedError, Listener

_MATCHED = 0.3
"""Seconds within which the robot's subscribers discover a publisher that the bridge has made for us. Until then they
miss messages, and the bridge does not know it."""

Read = Callable[[Any], Any]
"""A function that decodes a frame into a message, or raises UnreadableError."""


class UnreadableError(Exception):
    """A message or a channel that cannot be read. The text gives the reason to the user."""


class Bridge(ThreadedMiddleware):
    """The part of a `Middleware` that is the same for every protocol over a websocket. Each protocol has a subclass.

    All methods except `_publish` and the methods of `Middleware` run in its thread. It first receives all frames that
    wait in the network. Then it decodes only the newest frame of each topic, but every event, and every message of a
    recorded topic. The subclass calls `Listener.on_connected` as soon as it can publish.

    Raises:
        TypeError, ValueError: the address is invalid.
    """

    def __init__(self, address: str, subprotocols: list[str] | None = None, clock: Clock | None = None) -> None:
        super().__init__(clock)
        self._address, self._subprotocols = checked(address), subprotocols
        self._socket: WebSocket | None = None
        """The newest connection."""
        self._listener: Listener
        self._was_tried = False
        self._followed: frozenset[str] = frozenset()
        """The wanted topics that this thread has subscribed to."""
        self._received: set[str] = set()
        self._too_large: frozenset[str] = frozenset()
        """The wanted topics that are not subscribed to because one of their messages was too large."""
        self._all_of: frozenset[str] = frozenset()
        """The topics that were subscribed to with every message."""
        self._pending: dict[str, deque[tuple[Read, Any]]] = {}
        self._came: Counter[str] = Counter()
        """By topic, the number of frames since the last messages were passed on."""
        self._newest: dict[str, int] = {}
        """By topic, how many of the last pending messages are for targets of the newest message."""
        self._published: set[str] = set()
        """The topics on which something was published."""
        self._unmatched: dict[Any, Frame | None] = {}
        """By new publisher of the bridge, the last frame if it was zero, or None."""
        self._begin()

    @property
    def where(self) -> str:
        """See `Middleware`."""
        return without_secrets(self._address)

    def open(self, listener: Listener) -> None:
        """See `Middleware`."""
        if why := in_browser.no_robot(self.where):
            raise FeedError(why)
        try:
            import tornado.websocket  # noqa: F401
        except ImportError:
            raise FeedError(
                "websockets need the package tornado, which is not installed: pip install tornado"
            ) from None
        self._start_thread(f"robowidgets {self.where}", listener)

    def _wake_session(self) -> None:
        if self._socket is not None:
            if self._closed.is_set():
                self._socket.cancel()
            else:
                self._socket.call_soon(partial(self._follow, self._wanted, self._each))

    def _follow(self, topics: frozenset[str], each: frozenset[str]) -> None:
        """Subscribe to these topics and no others. A new subscription may deliver the last message again."""
        self._too_large &= topics
        topics -= self._too_large
        if self._socket is not None and self._socket.is_open:
            before, self._followed = self._followed, topics
            changed, self._all_of = (self._all_of ^ each) & before & topics, each
            for topic in before - topics:
                self._received.discard(topic)
                self._stop(topic)
            for topic in topics - before:
                self._start(topic)
            for topic in changed:
                self._change_share(topic)

    def _run_session(self, listener: Listener) -> str:
        self._listener = listener
        with contextlib.suppress(asyncio.CancelledError):  # `close` cancels it
            return self._clock.run(self._run_connection())
        return ""

    async def _run_connection(self) -> str:
        with self._lock:
            if self._closed.is_set():
                return ""
            socket = self._socket = WebSocket(self._address, self, self._subprotocols, self._clock)
        reason = await socket.run()
        self._was_tried = True
        if socket.has_lasted:
            self._backoff.reset()
        return reason

    def _publish(self, topic: str, frame: Callable[[], Frame], confirm: bool) -> None:
        """Publish a frame on a topic. See `WebSocket.publish`."""
        self._published.add(topic)
        if self._socket is None:
            raise FeedError(f"not connected to {self.where}")
        self._socket.publish(frame, confirm)

    def _later(self, seconds: float, function: Callable[[], object]) -> None:
        """Call a function after a while, unless the connection has ended before."""
        if self._socket is not None:
            self._socket.later(seconds, function)

    def on_open(self) -> None:
        """React to an established connection."""
        self._followed, self._received, self._pending, self._unmatched = frozenset(), set(), {}, {}
        self._came.clear()
        self._begin()
        self._follow(self._wanted, self._each)

    def on_silence(self, is_silent: bool) -> None:
        """Refuse speeds because the robot has not answered for a while, or accept them because it answers again."""
        reason = f"{self.where} does not answer: until it does, only zero is sent" if is_silent else ""
        for topic in list(self._published):
            self._listener.on_unheard(topic, reason)

    def deliver(self) -> None:
        """Decode the queued frames, and pass them on."""
        pending, self._pending = self._pending, {}
        came, self._came = self._came, Counter()
        for topic, waiting in pending.items():
            first = max(0, len(waiting) - self._newest[topic])
            replaced = came[topic] - (len(waiting) - first)
            for index, (read, frame) in enumerate(waiting):
                if topic in self._wanted and not self._closed.is_set():
                    self._pass_on(topic, read, frame, newest=index >= first, replaced=replaced * (index == first))

    def _pass_on(self, topic: str, read: Read, frame: Any, *, newest: bool, replaced: int) -> None:
        try:
            message = read(frame)
        except UnreadableError as error:
            self._listener.on_trouble(topic, str(error))
        else:
            self._received.add(topic)
            self._listener.on_trouble(topic, self._flaw(topic, message))
            self._listener.on_message(topic, message, newest=newest, replaced=replaced)

    async def finish(self) -> None:
        """Return when the robot has processed what was published. It is cancelled if that takes too long."""
        while any(self._unmatched.values()):
            await asyncio.sleep(0.01)

    def on_frame(self, frame: Frame) -> None:
        """Queue a received frame. If only the newest message is needed, it replaces an older frame of its topic."""
        raise NotImplementedError

    def on_too_large(self, start: bytes, size: int) -> None:
        """End the subscription of a topic whose frame is larger than `LARGEST` and was skipped, and report it."""
        topic, limit = self._topic_of_start(start), f"{LARGEST // 1_000_000} MB"
        if topic not in self._followed:
            self._report_on_all(f"skipped a message of {size / 1e6:.0f} MB, which is larger than {limit}")
            return
        if topic in self._all_of:
            self._listener.on_missed(topic, 1)
        self._too_large |= {topic}
        self._follow(self._wanted, self._each)
        reason = f"{topic} sent a message of {size / 1e6:.0f} MB, larger than {limit}, and was unsubscribed"
        self._listener.on_trouble(topic, reason)

    def on_no_answer(self) -> None:
        """Report that no answer has come for a moment, with a hint, unless a connection was tried before."""
        if not self._was_tried:
            self._listener.on_nobody(f"no answer from {self.where} yet: {COMPARE}")

    @property
    def hint(self) -> str:
        """See `BridgeCalls`."""
        raise NotImplementedError

    def _topic_of_start(self, start: bytes) -> str:
        """Return the topic of the message whose frame begins with these bytes, or empty if they do not contain it."""
        raise NotImplementedError

    def _begin(self) -> None:
        """Reset the state of the protocol, for a new connection."""
        raise NotImplementedError

    def _start(self, topic: str) -> None:
        """Request the messages of a topic."""
        raise NotImplementedError

    def _stop(self, topic: str) -> None:
        """End the request for the messages of a topic."""
        raise NotImplementedError

    def _change_share(self, topic: str) -> None:
        """Request every message of a topic, or only the newest, for a server that can leave out messages."""

    def _keep(self, topic: str, kind: str, read: Read, frame: Any) -> None:
        """Queue a frame for decoding. A frame that drops out counts as missed if every message is passed on."""
        from ._topics import queue_length  # Imported lazily: a guard subscribes to nothing.

        newest = queue_length(kind)
        waiting = self._pending.get(topic)
        if waiting is None:
            self._newest[topic] = newest
            waiting = self._pending[topic] = deque(maxlen=MOST_UNREAD if topic in self._all_of else newest)
        if topic in self._all_of and len(waiting) == waiting.maxlen:
            self._listener.on_missed(topic, 1)
        waiting.append((read, frame))
        self._came[topic] += 1

    def _flaw(self, topic: str, message: Any) -> str:  # noqa: ARG002
        """Return the reason why a decoded message is refused, or empty if it is accepted."""
        return ""

    def _await_match(self, publisher: Any) -> None:
        """Note that the bridge makes a publisher now. A zero that it may lose is sent once more."""
        self._unmatched[publisher] = None
        self._later(_MATCHED, lambda: self._send_again(self._unmatched.pop(publisher)))

    def _note_sent(self, publisher: Any, frame: Frame, *, is_zero: bool) -> None:
        if publisher in self._unmatched:
            self._unmatched[publisher] = frame if is_zero else None

    def _send_again(self, frame: Frame | None) -> None:
        if frame is not None and self._socket is not None:
            self._socket.write(frame)

    def _write(self, operation: Mapping[str, Any]) -> None:
        if self._socket is not None:
            self._socket.write(json.dumps(operation))

    def _report_on_all(self, reason: str) -> None:
        for topic in self._followed:
            self._listener.on_trouble(topic, reason)


def short_type(name: str) -> str:
    """Return a type in the spelling of ROS 1: ``sensor_msgs/LaserScan``."""
    return name.replace("/msg/", "/")


def other_nodes(nodes: Iterable[str], bridge: str) -> tuple[str, ...]:
    """Return the names of nodes without the bridge's node, which subscribes and publishes for us."""
    return tuple(sorted({node for node in nodes if not node.rpartition("/")[2].startswith(bridge)}))


def strings(value: Any) -> list[str]:
    """Return the strings in a list that the server sent, or an empty list if it sent something else."""
    return [item for item in value if isinstance(item, str)] if isinstance(value, list) else []
