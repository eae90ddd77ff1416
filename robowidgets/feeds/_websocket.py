"""A connection over a websocket.

It does not use `websockets`: with release 17, this module had 352 lines instead of 385, but a speed in a flood of scans
took 1.3 to 2.4 times as long, and every Jupyter kernel has tornado already.
"""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import math
import socket
import threading
from collections import deque
from collections.abc import Callable
from typing import Any, Protocol
from urllib.parse import urlsplit

from ..runtime.clock import Clock
from ..runtime.platform_fixes import acknowledge_at_once, close_when_connected, skip_large_messages
from ..runtime.urls import redacted, without_secrets
from ..samples.staleness import NO_ANSWER, ROBOT_GONE, ROBOT_SILENCE
from .middleware import SEND_TIMEOUT, FeedError

Frame = str | bytes

LARGEST = 50_000_000
"""The size of the largest message that is read, in bytes. Larger messages are skipped."""

CONNECT_TIMEOUT_S = 5.0
"""Seconds within which a robot must answer a connection attempt."""

COMPARE = "is the robot on, and in this network? Is the address right? Does a firewall block the port?"

_PINGS = 10  # the number of pings until a connection is given up
_OVERDUE = 0.005  # seconds for which a flood of frames may delay everything else in the thread
_GOODBYE = 0.5
_TIMED_OUT = 599  # tornado's code for a timeout, which no server sends


class BridgeCalls(Protocol):
    """The part of a bridge that its `WebSocket` uses."""

    @property
    def hint(self) -> str:
        """Return the text to add if a server that listens at the address does not speak the protocol."""

    def on_open(self) -> None:
        """React to an established connection."""

    def on_frame(self, frame: Frame) -> None:
        """Handle a received frame."""

    def on_too_large(self, start: bytes, size: int) -> None:
        """Handle a frame larger than `LARGEST` that was skipped, with its first bytes and its size."""

    def deliver(self) -> None:
        """Decode the queued frames, and pass them on."""

    def on_silence(self, is_silent: bool) -> None:
        """Note that the robot has not answered for a while, or that it has answered again."""

    def on_no_answer(self) -> None:
        """Note that no answer has come for a moment."""

    async def finish(self) -> None:
        """Return when the robot has processed what was published."""


class _Ping:
    """A ping. Its pong shows that the robot has read every frame before it."""

    def __init__(self, mark: bytes, sent_at: float) -> None:
        self.mark, self.sent_at = mark, sent_at
        self.answered = asyncio.Event()


class WebSocket:
    """A connection to an address in the event loop of a thread. Only that thread may use it.

    Any thread may call `publish`, `call_soon` and `cancel`.

    Args:
        address: the address; see `checked`.
        bridge: the bridge. See `BridgeCalls`.
        subprotocols: the names of the protocol. The robot must support one of them.
        clock: the clock of the event loop, which `publish` also uses.

    Attributes:
        is_cancelled: True once `cancel` was called.
    """

    def __init__(self, address: str, bridge: BridgeCalls, subprotocols: list[str] | None, clock: Clock) -> None:
        self._address = address
        self._shown = without_secrets(address)
        self._bridge = bridge
        self._subprotocols = subprotocols
        self._clock = clock
        self._lock = threading.Lock()
        self._publishing = threading.RLock()
        self._published = clock.condition(self._publishing)
        self._loop: asyncio.AbstractEventLoop | None = asyncio.get_running_loop()
        self._task = asyncio.current_task()
        self._connection: Any = None
        self._stream: Any = None
        self._early: deque[Frame | None] = deque(maxlen=1000)
        self._written: asyncio.Future[None] | None = None
        self._pings = itertools.count()
        self._unanswered: tuple[_Ping, ...] = ()
        """The pings without a pong, oldest first. Other frames do not count as an answer, because a robot that no
        longer reads may still send."""
        self._is_heard = False
        """True if anything was received since the last look."""
        self._silence_noted = False
        """True while the bridge knows that the robot has not answered for a while."""
        self._ended = asyncio.Event()
        self._kept_since: float | None = None
        self._opened_at = math.inf
        self._silent = False
        self.is_cancelled = False

    @property
    def is_open(self) -> bool:
        """True while frames can be written."""
        return self._connection is not None

    @property
    def has_lasted(self) -> bool:
        """True if it was open for a while, because a robot that accepts a connection may drop it at once."""
        return self._clock.now() - self._opened_at > CONNECT_TIMEOUT_S

    async def run(self) -> str:
        """Connect, and run until the connection ends. Return the reason."""
        try:
            return await self._run_connection(await self._connect())
        except Exception as error:  # any error of the network, of tornado or of the server
            return self._failure(error)
        finally:
            with self._lock:
                self._loop = None

    def cancel(self) -> None:
        """End the connection and the task that runs it."""
        if self._task is not None:
            self.is_cancelled = True
            self.call_soon(self._task.cancel)

    def call_soon(self, function: Callable[[], object]) -> None:
        """Call a function in the thread that runs the connection, unless the connection has ended."""
        with self._lock:
            if self._loop is not None:
                self._loop.call_soon_threadsafe(function)

    def later(self, seconds: float, function: Callable[[], object]) -> None:
        """Call a function after a while, unless the connection has ended before."""
        if self._loop is not None:
            self._loop.call_later(seconds, function)

    def write(self, frame: Frame) -> None:
        """Send a frame, unless the connection has ended."""
        with contextlib.suppress(Exception):  # the connection has ended; the reading task reports why
            self._send(frame)

    def publish(self, frame: Callable[[], Frame], confirm: bool) -> None:
        """Send a frame, and return when the system has accepted it or the robot has answered. Called in another thread.

        Args:
            frame: makes the frame, in the thread of the connection. It may `write` frames that must be sent before.
            confirm: True to wait for an answer of the robot after the frame. The system also accepts frames for a robot
                that is gone.

        Raises:
            FeedError: the connection is closed, or nothing could be sent within `SEND_TIMEOUT`. The frame is dropped.
            TimeoutError, ConnectionError: the frame may have reached the robot, or may still reach it. A frame to
                confirm is sent as soon as this connection allows it.
        """
        taken = threading.Lock()  # acquired by the thread of the connection to send the frame, or here to drop it
        with self._lock:
            if self._connection is None or self._loop is None:
                raise FeedError(f"not connected to {self._shown}")
            sending = asyncio.run_coroutine_threadsafe(self._publish(frame, confirm, taken), self._loop)
        sending.add_done_callback(self._note_published)
        until = self._clock.now() + SEND_TIMEOUT
        with self._publishing:
            while not sending.done() and self._published.wait_until(until):
                pass
        late: OSError
        try:
            if sending.done():
                return sending.result()
            late = TimeoutError(self._why_late())
        except FeedError:
            raise
        except Exception:  # any error of the network or of tornado, or a cancellation
            late = ConnectionError(f"the connection to {self._shown} ended")
        if not confirm and taken.acquire(blocking=False):
            sending.cancel()
            raise FeedError(str(late))
        raise late

    def _note_published(self, _: object) -> None:
        with self._publishing:
            self._published.notify_all()

    async def _connect(self) -> Any:
        from tornado.httpclient import HTTPRequest
        from tornado.websocket import websocket_connect

        connecting = asyncio.ensure_future(
            websocket_connect(
                HTTPRequest(self._address, connect_timeout=CONNECT_TIMEOUT_S, request_timeout=CONNECT_TIMEOUT_S),
                on_message_callback=self._on_frame,
                max_message_size=LARGEST,
                subprotocols=self._subprotocols,
            )
        )
        silence = asyncio.get_running_loop().call_later(NO_ANSWER, self._bridge.on_no_answer)
        try:
            return await asyncio.shield(connecting)
        except asyncio.CancelledError:
            await close_when_connected(connecting, _GOODBYE)
            raise
        finally:
            silence.cancel()

    async def _run_connection(self, connection: Any) -> str:
        stream = connection.protocol.stream
        if self._subprotocols and connection.selected_subprotocol is None:
            stream.close()
            names = ", ".join(self._subprotocols)
            return f"{self._shown} supports none of {names}: another program listens there; {self._bridge.hint}"
        self._connection, self._stream = connection, stream
        stream.set_nodelay(True)
        skip_large_messages(connection, LARGEST, self._bridge.on_too_large, self._on_part)
        connection.on_message, connection.on_pong = self._on_frame, self._on_pong
        self._opened_at = self._clock.now()
        try:
            self._bridge.on_open()
            while self._early:
                self._on_frame(self._early.popleft())
            await self._watch()
        finally:
            try:
                await self._end(connection)
            finally:
                stream.close()
        return self._ending(connection)

    async def _watch(self) -> None:
        """Return when the connection has ended, or when nothing has come for `ROBOT_GONE` seconds.

        If more data come than the network can carry, answers are late, but the data are good.
        """
        # Counts intervals without a frame instead of seconds, because a stalled process reads nothing either.
        silent = 0
        while silent < _PINGS and not self._ended.is_set():
            self._is_heard = False
            if not self._unanswered:
                self._ping()
            with contextlib.suppress(asyncio.TimeoutError):
                await asyncio.wait_for(self._ended.wait(), ROBOT_GONE / _PINGS)
            silent = 0 if self._is_heard else silent + 1
        self._silent = not self._ended.is_set()

    async def _end(self, connection: Any) -> None:
        """Close a connection with the closing handshake, within a moment."""
        if self.is_cancelled and not self._ended.is_set():
            with contextlib.suppress(asyncio.TimeoutError):
                await asyncio.wait_for(self._bridge.finish(), _GOODBYE)
        self._connection, self._unanswered = None, ()
        self._note_silence()
        connection.close()
        if not self._silent:
            with contextlib.suppress(asyncio.TimeoutError):
                await asyncio.wait_for(self._ended.wait(), _GOODBYE)

    def _on_part(self) -> None:
        """Note a part of a large message, which may take longer than the limit for silence."""
        self._is_heard = True

    def _on_frame(self, frame: Frame | None) -> Any:
        """Handle a frame. tornado reads the next one when the returned future, if any, is done."""
        if self._stream is None:  # tornado passes on the first frames before `websocket_connect` returns
            self._early.append(frame)
        elif frame is None:
            self._ended.set()
        else:
            self._is_heard = True
            self._bridge.on_frame(frame)
            return self._deliver_soon()
        return None

    @property
    def _silence(self) -> float:
        """Seconds since the oldest unanswered ping, or 0."""
        return self._clock.now() - self._unanswered[0].sent_at if self._unanswered else 0.0

    def _note_silence(self) -> None:
        is_silent = self._silence >= ROBOT_SILENCE
        if is_silent != self._silence_noted:
            self._silence_noted = is_silent
            self._bridge.on_silence(is_silent)

    def _ping(self) -> _Ping:
        ping = _Ping(b"%d" % next(self._pings), self._clock.now())
        self._unanswered += (ping,)
        self.later(ROBOT_SILENCE, self._note_silence)
        with contextlib.suppress(Exception):  # the connection ended
            self._connection.ping(ping.mark)
        return ping

    def _on_pong(self, mark: bytes) -> None:
        """Handle the answer to a ping and all earlier pings. A robot may answer only the last of several pings."""
        self._is_heard = True
        count = next((i for i, ping in enumerate(self._unanswered, 1) if ping.mark == mark), 0)
        for ping in self._unanswered[:count]:
            ping.answered.set()
        self._unanswered = self._unanswered[count:]
        self._note_silence()

    def _deliver_soon(self) -> asyncio.Future[None] | None:
        # While the network has more frames, tornado continues to read, and nothing else runs in this thread, so that
        # only the newest frames are decoded. After `_OVERDUE` it pauses, so that other calls can run.
        loop, now = asyncio.get_running_loop(), self._clock.now()
        if self._kept_since is None:
            self._kept_since = now
            loop.call_soon(self._deliver)
        elif now - self._kept_since > _OVERDUE:
            pause = loop.create_future()
            loop.call_soon(pause.set_result, None)
            return pause
        return None

    def _deliver(self) -> None:
        self._kept_since = None
        self._bridge.deliver()
        if not self._stream.closed():
            acknowledge_at_once(self._stream.socket)

    def _send(self, frame: Frame) -> None:
        self._written = self._connection.write_message(frame, binary=isinstance(frame, bytes))
        self._written.add_done_callback(lambda written: written.cancelled() or written.exception())

    def _why_late(self) -> str:
        if self._written is not None and not self._written.done():
            return f"{self._shown} does not accept data"
        return f"{self._shown} has not answered for {max(SEND_TIMEOUT, self._silence):.1f} s"

    async def _publish(self, frame: Callable[[], Frame], confirm: bool, taken: threading.Lock) -> None:
        # A speed that cannot be sent now must not reach the robot later, and tornado cannot cancel a write. So tornado
        # gets a frame only after it has written the previous one, and a speed only while the robot answers.
        if self._written is not None:
            await asyncio.shield(self._written)
        if not confirm and self._silence >= ROBOT_SILENCE:
            raise FeedError(f"{self._why_late()}: until it answers, only zero is sent")
        if not taken.acquire(blocking=False):
            return
        self._send(frame())
        assert self._written is not None
        await asyncio.shield(self._written)
        if confirm:
            await self._ping().answered.wait()
        elif not self._unanswered:  # so that its silence counts from the first speed that it did not read
            self._ping()

    def _failure(self, error: BaseException) -> str:
        if isinstance(error, ConnectionRefusedError):
            return (
                f"nothing listens at {self._shown}; is the robot's bridge running, and the port right? The usual ports "
                "are 8765 for foxglove_bridge and 9090 for rosbridge"
            )
        if isinstance(error, socket.gaierror):
            return f"the name {urlsplit(self._address).hostname} cannot be resolved; try the robot's IP address"
        if getattr(error, "code", None) == _TIMED_OUT or isinstance(error, asyncio.TimeoutError):
            return f"no answer from {self._shown} within {CONNECT_TIMEOUT_S:g} s: {COMPARE}"
        hint = f"; {self._bridge.hint}" if hasattr(error, "code") else ""  # a server answered with an error of HTTP
        return f"{self._shown} cannot be connected to: {redacted(one_line(str(error))) or type(error).__name__}{hint}"

    def _ending(self, connection: Any) -> str:
        if self._silent:
            return f"the robot did not answer for {ROBOT_GONE:g} s"
        reason = one_line(connection.close_reason or "")
        return "the connection ended" + (f": {reason}" if reason else "")


def checked(address: object) -> str:
    """Return the address. Raise TypeError or ValueError if it is invalid."""
    expected = "address: expected one like ws://192.168.1.5:8765"
    if not isinstance(address, str):
        raise TypeError(f"{expected}, got {redacted(repr(address))}")
    try:
        parts = urlsplit(address)
        good = parts.scheme in ("ws", "wss") and bool(parts.hostname) and parts.port != 0
    except ValueError:  # a port that is not a number
        good = False
    if not good or address != address.strip() or not address.isprintable():
        raise ValueError(f"{expected} (wss:// for an encrypted one), got {redacted(repr(address))}")
    return address


def one_line(text: str) -> str:
    """Return text from another machine as one printable line of at most 160 characters."""
    line = " ".join("".join(c if c.isprintable() else " " for c in text[:2000]).split())
    return line if len(line) <= 160 else f"{line[:159]}…"
