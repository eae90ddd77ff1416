"""A websocket to a robot that comes back by itself, in a thread of its own."""

from __future__ import annotations

import asyncio
import concurrent.futures
import contextlib
import math
import socket
import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Any, Protocol
from urllib.parse import urlsplit

from ._backoff import Backoff
from .middleware import CLOSE_TIMEOUT, SEND_TIMEOUT, FeedError

Frame = str | bytes

LARGEST = 50_000_000
"""Bytes of the largest message that is read."""

PATIENCE = 5.0
"""Seconds within which a robot has to answer when it is called."""

_ALIVE = 10.0  # seconds of silence after which a robot is given up
_PINGS = 10  # pings in that time
_OVERDUE = 0.005  # seconds for which frames that come without a pause may keep everything else from being done
_GOODBYE = 0.5
_QUICKACK: int | None = getattr(socket, "TCP_QUICKACK", None)


class Talk(Protocol):
    """What is spoken on a line. Everything is called in the thread of the line, `deliver` after some frames."""

    def on_open(self) -> None:
        """A connection begins."""

    def on_frame(self, frame: Frame) -> None:
        """A frame came: keep it in place of an older one of its kind, for there may be more behind it."""

    def deliver(self) -> None:
        """Read what was kept, and hand it on."""

    def on_lost(self, why: str, again_in: float, too_big: bool) -> None:
        """The connection ended, or there was none; perhaps because of a message larger than `LARGEST`."""

    async def finish(self) -> None:
        """Return when the robot has processed what was published; it is cancelled when that takes too long."""


class Line:
    """A connection to an address, opened again with growing pauses whenever it ends.

    Raises:
        TypeError, ValueError: the address is not one; the text says how to write it.
    """

    def __init__(self, address: str, talk: Talk, subprotocols: list[str] | None = None) -> None:
        self.address = checked(address)
        self._talk = talk
        self._subprotocols = subprotocols
        self._backoff = Backoff()
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._task: asyncio.Task[str] | None = None
        self._calls: deque[Callable[[], object]] = deque()
        self._forget()

    def open(self) -> None:
        """Connect; FeedError when that can never work."""
        try:
            import tornado.websocket  # noqa: F401
        except ImportError:
            raise FeedError(
                "websockets need the package tornado, which is not installed: pip install tornado"
            ) from None
        self._thread = threading.Thread(target=self._run, name=f"robowidgets {self.address}", daemon=True)
        self._thread.start()

    @property
    def closed(self) -> bool:
        """Whether it is closed for good."""
        return self._backoff.closed

    def close(self) -> None:
        """End the connection and the thread, from any thread; from its own, it ends as soon as the call returns."""
        with self._lock:
            if not self.closed:
                self._backoff.close()
                if self._loop is not None and self._task is not None:
                    self._loop.call_soon_threadsafe(self._task.cancel)
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join(CLOSE_TIMEOUT)

    def call(self, function: Callable[[], object]) -> None:
        """Call a function in the thread of the line: at once, or when there is a connection."""
        with self._lock:
            self._calls.append(function)
            if self._loop is not None:
                self._loop.call_soon_threadsafe(self._run_calls)

    def later(self, seconds: float, function: Callable[[], object]) -> None:
        """Call a function after a while, if the connection is the same by then. In the thread of the line."""
        if self._loop is not None:
            self._loop.call_later(seconds, function)

    def write(self, frame: Frame) -> None:
        """Send a frame; nothing when there is no connection. In the thread of the line."""
        with contextlib.suppress(Exception):  # the connection ended, which whoever reads from it learns with its reason
            self._send(frame)

    def publish(self, frame: Callable[[], Frame], confirm: bool) -> None:
        """Send a frame and return when the system has taken it, or the robot has answered. In any other thread.

        Args:
            frame: makes the frame, in the thread of the line; it may `write` others that must come before.
            confirm: whether to wait until anything comes from the robot after the frame: the system takes frames for
                a robot that is gone, too.

        Raises:
            FeedError: there is no connection, or it took more than `SEND_TIMEOUT`. A frame that was to be confirmed is
                still sent as soon as that is possible on this connection; others are not.
        """
        with self._lock:
            if self._connection is None or self._loop is None:
                raise FeedError(f"there is no connection to {self.address}")
            sending = asyncio.run_coroutine_threadsafe(self._publish(frame, confirm), self._loop)
        try:
            sending.result(SEND_TIMEOUT)
        except concurrent.futures.TimeoutError:
            if not confirm:
                sending.cancel()
            if self._written is not None and not self._written.done():
                raise FeedError(f"{self.address} does not take what is sent") from None
            silence = max(SEND_TIMEOUT, time.monotonic() - (self._asked_at or math.inf))
            raise FeedError(f"{self.address} has not answered for {silence:.1f} s") from None
        except Exception as error:  # whatever the network and tornado make up, or it was cancelled
            raise FeedError(f"the connection to {self.address} ended") from error

    # From here on everything runs in the thread of the line.

    def _run(self) -> None:
        while not self.closed:
            with contextlib.suppress(asyncio.CancelledError):  # that is how it is closed
                why = asyncio.run(self._session())
                if not self.closed:
                    pause = self._backoff.next_pause()
                    self._talk.on_lost(why, pause, self._too_big)
                    self._backoff.wait(pause)

    async def _session(self) -> str:
        """Connect, and stay as long as it goes; returns why it ended."""
        self._forget()
        with self._lock:
            self._loop, self._task = asyncio.get_running_loop(), asyncio.current_task()
        try:
            return "" if self.closed else await self._stay(await self._connect())
        except Exception as error:  # whatever the network, tornado or the other side make up
            return self._words(error)
        finally:
            with self._lock:
                self._loop = self._task = None

    async def _connect(self) -> Any:
        from tornado.httpclient import HTTPRequest
        from tornado.websocket import websocket_connect

        coming = asyncio.ensure_future(
            websocket_connect(
                HTTPRequest(self.address, connect_timeout=PATIENCE, request_timeout=PATIENCE),
                on_message_callback=self._on_frame,
                max_message_size=LARGEST,
                subprotocols=self._subprotocols,
            )
        )
        try:
            return await asyncio.shield(coming)
        except asyncio.CancelledError:
            # It is closed while it connects. Tornado lets go of a connection only when it is there.
            with contextlib.suppress(Exception):
                connection: Any = await asyncio.wait_for(coming, _GOODBYE)
                stream = connection.protocol.stream
                connection.close()
                stream.close()
            raise

    async def _stay(self, connection: Any) -> str:
        stream = connection.protocol.stream
        if self._subprotocols and connection.selected_subprotocol is None:
            stream.close()
            return f"{self.address} speaks none of {', '.join(self._subprotocols)}: something else listens there"
        self._connection, self._stream = connection, stream
        stream.set_nodelay(True)
        self._listen_in(connection.protocol)
        connection.on_message, connection.on_pong = self._on_frame, self._on_answer
        opened = time.monotonic()
        try:
            self._talk.on_open()
            self._run_calls()
            while self._early:
                self._on_frame(self._early.popleft())
            await self._watch()
        finally:
            try:
                await self._end(connection)
            finally:
                stream.close()
        # A robot that takes a call and drops it at once is called again ever more rarely, too.
        if time.monotonic() - opened > PATIENCE:
            self._backoff.worked()
        return self._ending(connection)

    async def _watch(self) -> None:
        """Return when the connection has ended, or the robot has not answered for `_ALIVE` seconds."""
        # Intervals without an answer are counted, not seconds: in a stall of this process nothing is read either.
        unanswered = 0
        while unanswered < _PINGS and not self._ended.is_set():
            self._ping()
            with contextlib.suppress(asyncio.TimeoutError):
                await asyncio.wait_for(self._ended.wait(), _ALIVE / _PINGS)
            unanswered = unanswered + 1 if self._asked_at is not None else 0
        self._silent = not self._ended.is_set()

    async def _end(self, connection: Any) -> None:
        """End a connection in the way that both sides agreed upon, in a moment."""
        if self.closed and not self._ended.is_set():
            self._run_calls()
            with contextlib.suppress(asyncio.TimeoutError):
                await asyncio.wait_for(self._talk.finish(), _GOODBYE)
        self._connection = None
        connection.close()
        if not self._silent:
            with contextlib.suppress(asyncio.TimeoutError):
                await asyncio.wait_for(self._ended.wait(), _GOODBYE)

    def _forget(self) -> None:
        self._connection = self._stream = None
        self._early: deque[Frame | None] = deque(maxlen=1000)
        self._written: asyncio.Future[None] | None = None
        self._asked_at: float | None = None
        """When a ping was sent; None since anything came from the robot."""
        self._answered, self._ended = asyncio.Event(), asyncio.Event()
        self._kept_since: float | None = None
        self._too_big = False
        self._silent = False

    def _listen_in(self, protocol: Any) -> None:
        """Note why tornado itself ends a connection, for it tells nobody."""
        close = protocol.close

        def noting(code: int | None = None, reason: str | None = None) -> None:
            self._too_big = self._too_big or code == 1009
            close(code, reason)

        protocol.close = noting

    def _on_frame(self, frame: Frame | None) -> Any:
        """Take a frame; tornado reads the next one when the future that may be returned is done."""
        if self._stream is None:  # tornado reads the first frames before it says that there is a connection
            self._early.append(frame)
        elif frame is None:
            self._ended.set()
        else:
            self._on_answer()
            self._talk.on_frame(frame)
            return self._deliver_soon()
        return None

    def _on_answer(self, _data: bytes = b"") -> None:
        self._asked_at = None
        self._answered.set()

    def _ping(self) -> None:
        """Ask the robot for an answer, unless one is outstanding."""
        if self._asked_at is None:
            self._asked_at = time.monotonic()
            self._answered.clear()
            with contextlib.suppress(Exception):  # the connection ended
                self._connection.ping()

    def _deliver_soon(self) -> asyncio.Future[None] | None:
        # As long as the network has more, tornado reads on and nothing else runs in this thread, so that only the
        # newest frames are decoded. After `_OVERDUE` it pauses, and what waits is delivered, written, closed.
        loop, now = asyncio.get_running_loop(), time.monotonic()
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
        self._talk.deliver()
        self._acknowledge()

    def _acknowledge(self) -> None:
        """Have Linux say at once what arrived: foxglove's server sends no more before that, for up to 40 ms."""
        if _QUICKACK is not None and not self._stream.closed():
            self._stream.socket.setsockopt(socket.IPPROTO_TCP, _QUICKACK, 1)

    def _run_calls(self) -> None:
        while self._connection is not None and self._calls:
            self._calls.popleft()()

    def _send(self, frame: Frame) -> None:
        self._written = self._connection.write_message(frame, binary=isinstance(frame, bytes))
        self._written.add_done_callback(lambda written: written.cancelled() or written.exception())

    async def _publish(self, frame: Callable[[], Frame], confirm: bool) -> None:
        # A speed that cannot be sent now must not reach the robot later, and tornado takes nothing back: it is handed
        # a frame only when no other waits there, and a speed only while the robot answers.
        if not confirm and self._asked_at is not None and time.monotonic() - self._asked_at > SEND_TIMEOUT:
            await self._answered.wait()
        if self._written is not None:
            await asyncio.shield(self._written)
        self._send(frame())
        assert self._written is not None
        await asyncio.shield(self._written)
        if confirm:
            self._ping()
            await self._answered.wait()

    def _words(self, error: BaseException) -> str:
        if isinstance(error, ConnectionRefusedError):
            return f"nothing listens at {self.address}; is the robot's bridge running?"
        if isinstance(error, socket.gaierror):
            return f"nobody here knows the name {urlsplit(self.address).hostname}"
        if getattr(error, "code", None) == 599 or isinstance(error, asyncio.TimeoutError):
            return f"no answer from {self.address} within {PATIENCE:g} s"
        return f"{self.address} cannot be connected to: {one_line(str(error)) or type(error).__name__}"

    def _ending(self, connection: Any) -> str:
        if self._too_big:
            return f"a message larger than {LARGEST // 1_000_000} MB came"
        if self._silent:
            return f"the robot did not answer for {_ALIVE:g} s"
        reason = one_line(connection.close_reason or "")
        return "the connection ended" + (f": {reason}" if reason else "")


def checked(address: object) -> str:
    """An address as it was given; TypeError or ValueError when it is none."""
    expected = "address: expected one like ws://192.168.1.5:8765"
    if not isinstance(address, str):
        raise TypeError(f"{expected}, got {address!r}")
    try:
        parts = urlsplit(address)
        good = parts.scheme in ("ws", "wss") and bool(parts.hostname) and parts.port != 0
    except ValueError:  # a port that is no number
        good = False
    if not good or address != address.strip() or not address.isprintable():
        raise ValueError(f"{expected} (wss:// for an encrypted one), got {address!r}")
    return address


def one_line(text: str) -> str:
    """What a machine wrote, in one line for a person."""
    line = " ".join("".join(c if c.isprintable() else " " for c in text[:2000]).split())
    return line if len(line) <= 160 else f"{line[:159]}…"
