"""Fixes for Python, Linux and other packages: each changes or bypasses code from outside this package.

Each function is one fix, and its docstring says what is wrong, what the fix does and what happens without it. Its last
lines name the versions that need it, with the issue or the code upstream. For each of these lines,
`tests/unit/runtime/test_platform_fixes.py` shows that an installed version goes wrong without the fix: the test fails
when a version is cured.

With ``ROBOWIDGETS_PLATFORM_FIXES=off`` in the environment of the kernel all fixes are off. Use it to find out if one of
them causes a problem.
"""

from __future__ import annotations

import contextlib
import functools
import itertools
import os
import signal
import socket
import sys
import threading
from collections import deque
from collections.abc import Callable
from types import SimpleNamespace, TracebackType
from typing import TYPE_CHECKING, Any

from .error_routing import ipython_shell

if TYPE_CHECKING:
    import asyncio

_Changed = contextlib.AbstractContextManager["TracebackType | None"]

ENABLED = os.environ.get("ROBOWIDGETS_PLATFORM_FIXES", "").strip().lower() != "off"

SWITCH_INTERVAL = 0.0001
"""Seconds that a thread waits before it asks another one for the interpreter lock."""

_DEFAULT_SWITCH_INTERVAL = 0.005
_QUICKACK: int | None = getattr(socket, "TCP_QUICKACK", None)
_pads = itertools.cycle([" " * width for width in range(63, -1, -1)])


def shorten_switch_interval() -> None:
    """Shorten the wait for the interpreter lock (GIL), for the whole process.

    By default a thread waits 5 ms before it asks for the lock, and that wait restarts each time the lock changes hands.
    So a loop that reads a file or prints every millisecond starves all other threads, and the page stands still. The
    fix sets 0.1 ms, unless the program has set an interval itself.

    Needed for Python >=3.10: https://bugs.python.org/issue7946
    """
    if ENABLED and sys.getswitchinterval() == _DEFAULT_SWITCH_INTERVAL:
        sys.setswitchinterval(SWITCH_INTERVAL)


def message_padding() -> dict[str, str]:
    """Return an extra field for a message to the page, so that successive messages differ in length.

    Jupyter's server leaves Nagle's algorithm on, so it holds a small message back until the previous one is
    acknowledged. Linux takes messages of equal length for full segments and delays their acknowledgement by 40 ms. So
    every third frame of the display would be missing. Messages of different length are acknowledged at once.

    Needed for jupyter_server >=2: https://github.com/jupyter-server/jupyter_server/blob/main/jupyter_server/services/kernels/websocket.py
    """
    return {"pad": next(_pads)} if ENABLED else {}


def run_beside_debugger(thread: Any) -> None:
    """Keep a thread running while a debugger suspends the program. Called before the thread starts.

    At a breakpoint debugpy, which JupyterLab and VS Code use, suspends all threads, including the one that would send
    zero. The fix marks a thread as ipykernel marks its own threads. Without the fix, a robot drives on during a
    breakpoint.

    Needed for debugpy >=1.6: https://github.com/microsoft/debugpy/issues/547
    """
    if ENABLED:
        thread.pydev_do_not_trace = thread.is_pydev_daemon_thread = True


def route_by_message(comm: Any, only: str | None = None) -> None:
    """Make a widget's comm handle messages of the page during a running cell, so that Stop does not wait for the cell.

    JupyterLab has a subshell for widgets, a thread next to the main one, and names it in each message. ipykernel 7.1 to
    7.3 handle the message there. ipykernel 7.4 handles it in the shell from which the widget last sent something. That
    is nearly always the main one, where the message waits for the end of the cell. The fix makes one comm use the name
    in the message instead; its handlers must be safe in any thread. ipykernel 6 has no subshells. ``only`` restricts
    the fix to messages with this key. ipykernel routes other messages, and changes of traits, which functions of the
    user may observe.

    Needed for ipykernel >=7.4: https://github.com/ipython/ipykernel/blob/main/ipykernel/comm/comm.py
    """
    if ENABLED and hasattr(comm, "_reply_subshell_for"):
        usual = comm._reply_subshell_for

        def shell_for(data: Any, named_by_message: Any) -> Any:
            content = data.get("content") if isinstance(data, dict) else None
            is_meant = only is None or (isinstance(content, dict) and only in content)
            return named_by_message if is_meant else usual(data, named_by_message)

        comm._reply_subshell_for = shell_for


def call_on_interrupt(call: Callable[[], None]) -> None:
    """Call a function as soon as the running cell is interrupted, before the interrupt is raised.

    IPython's own event comes after the traceback was made, and not at all if the cell catches the interrupt. A robot
    would drive on meanwhile. A cell with ``await`` may even go on to its end. ipykernel sets a SIGINT handler again for
    each cell: Python's or, for a cell with ``await``, one of its own. So each cell must call this. A handler that the
    program has set stays. Without the fix, only the event is left.

    Needed for ipython >=8: https://github.com/ipython/ipython/blob/main/IPython/core/events.py
    Needed for ipykernel >=6: https://github.com/ipython/ipykernel/issues/328
    """
    before: Any = signal.getsignal(signal.SIGINT)

    def on_interrupt(number: int, frame: Any) -> None:
        __tracebackhide__ = True  # see short_traceback.py
        call()
        before(number, frame)

    is_usual = before is signal.default_int_handler or getattr(before, "__module__", "") == "ipykernel.ipkernel"
    if ENABLED and is_usual:
        _set_below_rclpy(signal.SIGINT, on_interrupt)


def call_before_traceback(shell: Any, call: Callable[[], None]) -> None:
    """Call a function as soon as the running cell has raised, before IPython shows the traceback.

    IPython's own event comes after the traceback, which may take seconds, and not at all for a script that ``%run``
    runs. A robot would drive on meanwhile. Without the fix, only the event is left.

    Needed for ipython >=8: https://github.com/ipython/ipython/blob/main/IPython/core/interactiveshell.py
    """
    show = shell.showtraceback

    def call_and_show(*args: Any, **kwargs: Any) -> Any:
        call()
        return show(*args, **kwargs)

    if ENABLED:
        shell.showtraceback = call_and_show


def call_on_idle_interrupt(kernel: Any, call: Callable[[], None]) -> None:
    """Call a function when a kernel is interrupted between cells.

    Between cells ipykernel ignores SIGINT. But a program goes on driving between cells, and an interrupt then is meant
    to stop it. After each cell, ipykernel restores the handler from before the cell; the fix replaces that handler.
    Without the fix, only Stop and the interrupt of a running cell stop a program.

    Needed for ipykernel >=6: https://github.com/ipython/ipykernel/pull/49
    """

    def on_interrupt(_number: int, _frame: Any) -> None:
        call()

    if ENABLED and getattr(kernel, "saved_sigint_handler", None) is signal.SIG_IGN:
        kernel.saved_sigint_handler = on_interrupt


def call_before_end(call: Callable[[], object]) -> None:
    """Call a function before a signal, or ipykernel, ends the process without running its exit handlers.

    SIGTERM comes from ``kill`` or from a container or a service that is stopped, SIGHUP from a terminal that is closed.
    A kernel whose server is gone ends itself by ``os._exit``. In each case a robot would drive on. The function is
    called in a thread of its own, because the main thread may hold a lock that the function needs. Then the process
    ends as it would have. If rclpy handles SIGTERM, the process does not end: rclpy shuts down, and the program ends
    itself. The main thread notices a signal only between two steps of Python. A handler that the program has set stays.
    Without the fix, the function is called only if the process ends normally.

    Needed for Python >=3.10: https://docs.python.org/3/library/atexit.html
    Needed for ipykernel >=6: https://github.com/ipython/ipykernel/blob/main/ipykernel/parentpoller.py
    """

    def end(number: int, ends: bool) -> None:
        try:
            call()
        finally:
            if ends:
                os.kill(os.getpid(), number)

    unheard: set[int] = set()

    def on_signal(number: int, _frame: Any) -> None:
        ends = number in unheard or _rclpy_that_handles(number) is None
        if ends:
            signal.signal(number, signal.SIG_DFL)
        with contextlib.suppress(RuntimeError):  # too late for a thread: the exit handlers run already
            threading.Thread(target=end, args=(number, ends), name="robowidgets-end", daemon=True).start()

    def leave(code: int) -> None:
        try:
            call()
        finally:
            os._exit(code)

    if not ENABLED:
        return
    poller: Any = sys.modules.get("ipykernel.parentpoller")
    if poller is not None and poller.os is os:
        poller.os = SimpleNamespace(**{**vars(os), "_exit": leave})
    if threading.current_thread() is threading.main_thread():
        for number in (signal.SIGTERM, getattr(signal, "SIGHUP", signal.SIGTERM)):
            if signal.getsignal(number) is signal.SIG_DFL and not _set_below_rclpy(number, on_signal):
                unheard.add(number)


def let_threads_print() -> None:
    """Keep prints and logs of threads from hanging for ever in ipykernel 6.29 to 7.0.

    To find the cell of a printed text, ipykernel notes the starter of each thread, by their identifiers. Python uses
    the identifier of an ended thread again, so the notes may form a circle, and ipykernel follows it without end. The
    fix drops the notes on an ended thread when its identifier is used again. Without the fix, a thread that prints or
    logs may hang, and so does each thread that logs after it.

    Needed for ipykernel >=6.29,<7.1: https://github.com/ipython/ipykernel/issues/1269
    """
    kernel = getattr(ipython_shell(), "kernel", None)
    for name in ("_stdout", "_stderr"):
        stream: Any = getattr(kernel, name, None)
        if ENABLED and type(getattr(stream, "_thread_to_parent", None)) is dict:
            stream._thread_to_parent = _ThreadParents()


def capture_prints(take: Callable[[str], bool]) -> None:
    """Pass the prints of the calling thread to a function, which returns True to keep them from ``sys.stdout``.

    ``sys.stdout`` belongs to the process: Python has no separate output for a thread. The fix replaces it by a stream
    that checks the thread. IPython and pytest may replace ``sys.stdout`` at any time, so each call checks it again.
    Without the fix, a program's page does not show its prints.

    Needed for Python >=3.10: https://docs.python.org/3/library/contextlib.html#contextlib.redirect_stdout
    """
    if not ENABLED:
        return
    with _printing:
        _takes[threading.current_thread()] = take
        if not isinstance(sys.stdout, _Router):
            sys.stdout = _router_of(sys.stdout)


def release_prints() -> None:
    """Undo `capture_prints` for the calling thread, and for threads that have ended.

    After the last one, ``sys.stdout`` is restored.
    """
    with _printing:
        _takes.pop(threading.current_thread(), None)
        for ended in [thread for thread in _takes if not thread.is_alive()]:
            del _takes[ended]
        if not _takes and isinstance(sys.stdout, _Router):
            sys.stdout = sys.stdout.inner


class _Router:
    """Replaces ``sys.stdout``: passes prints on, except those that the thread's function takes."""

    def __init__(self, inner: Any) -> None:
        self.inner = inner

    def write(self, text: str) -> int:
        """Write a text."""
        take = _takes.get(threading.current_thread())
        if take is not None and take(text):
            return len(text)
        written: int = self.inner.write(text)
        return written

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)


def _router_of(stream: Any) -> _Router:
    for router in _routers:
        if router.inner is stream:
            return router
    _routers.append(_Router(stream))
    return _routers[-1]


_takes: dict[threading.Thread, Callable[[str], bool]] = {}
"""The functions that take prints, by thread."""
_routers: deque[_Router] = deque(maxlen=50)
"""The last routers, one for each stream. They are kept, because ``print`` may not hold a reference to ``sys.stdout``
while it writes: a router that is freed meanwhile, at the end of the last program, would crash the process."""
_printing = threading.Lock()


def change_tracebacks(change: Callable[[BaseException, TracebackType | None], _Changed]) -> None:
    """Make IPython, if it is running, show each traceback as a context manager returns it.

    IPython lets an error render itself only if its class is not one of Python's, and always shows the last frame, even
    if it is marked as hidden. The fix wraps the function that makes the traceback. Without the fix, the traceback of a
    wrong argument includes the lines of robowidgets and traitlets that found it.

    Needed for ipython >=8: https://github.com/ipython/ipython/issues/12565
    """
    shows = getattr(ipython_shell(), "InteractiveTB", None)  # optional: some shells have none
    if not ENABLED or shows is None:
        return
    whole = shows.structured_traceback

    @functools.wraps(whole)
    def changed(
        kind: type[BaseException], error: BaseException, traceback: TracebackType | None, *args: Any, **options: Any
    ) -> Any:
        with change(error, traceback) as shown:
            return whole(kind, error, shown, *args, **options)

    shows.structured_traceback = changed


def share_class(widget: Any, made: type) -> bool:
    """Give a widget the class with further traits that was made for another one of its class; return True if done.

    anywidget adds the front end to each widget as traits, for which traitlets makes a new class each time. That doubles
    the time to make a widget. Without the fix, each widget has its own class.

    Needed for traitlets >=5: https://github.com/ipython/traitlets/issues/500
    Needed for anywidget >=0.11: https://github.com/manzt/anywidget/blob/main/anywidget/widget.py
    """
    if ENABLED:
        widget.__class__ = made
    return ENABLED


class _ThreadParents(dict[int, int]):
    """The identifier of the thread that started a thread, by the identifier of the latter. It has no circles."""

    def __setitem__(self, thread: int, parent: int) -> None:
        for child, starter in list(self.items()):
            if starter == thread:
                self.pop(child, None)
        super().__setitem__(thread, parent)


def _rclpy_that_handles(number: int) -> Any:
    """Return the module `rclpy.signals` if it reports its handler of a signal as installed, else None.

    That handler is in C, and invisible to Python. It calls the previous handler, unless that is the default, and shuts
    down the contexts of rclpy. It does not end the process.
    """
    signals: Any = sys.modules.get("rclpy.signals")
    if signals is None:
        return None
    options = signals.SignalHandlerOptions
    handling = {int(signal.SIGINT): options.SIGINT, int(signal.SIGTERM): options.SIGTERM}
    current = signals.get_current_signal_handlers_options()
    return signals if number in handling and current in (handling[number], options.ALL) else None


def _set_below_rclpy(number: int, handler: Callable[[int, Any], None]) -> bool:
    """Set a handler of a signal. If rclpy has a handler, it then calls this one, which outlives `rclpy.shutdown`.

    Returns:
        False if rclpy reports its handler as installed although the program has replaced it.
    """
    rclpy = _rclpy_that_handles(number)
    options = rclpy and rclpy.get_current_signal_handlers_options()
    if rclpy:
        rclpy.uninstall_signal_handlers()
    was_replaced = _rclpy_that_handles(number) is not None
    signal.signal(number, handler)
    if rclpy:
        rclpy.install_signal_handlers(options)
    return not was_replaced


def acknowledge_at_once(sock: socket.socket) -> None:
    """Make Linux acknowledge the received bytes of a socket at once.

    The Foxglove SDK's server leaves Nagle's algorithm on: it sends nothing more until its last message is acknowledged,
    and Linux delays that by up to 40 ms. The option lasts for one acknowledgement only, so each delivery calls this.

    Needed for foxglove-sdk >=0.10: https://github.com/foxglove/foxglove-sdk/blob/main/rust/foxglove/src/websocket/server.rs
    """
    if ENABLED and _QUICKACK is not None:
        sock.setsockopt(socket.IPPROTO_TCP, _QUICKACK, 1)


def skip_large_messages(
    connection: Any, largest: int, on_skipped: Callable[[bytes, int], object], on_part: Callable[[], object]
) -> None:
    """Skip messages of a websocket that are larger than a limit, and report the start and the size of each.

    tornado closes the connection at such a message, and does not report what it was. The fix wraps the methods of one
    connection that read bytes and take a message. Without the fix, a topic of large messages ends each new connection.

    Needed for tornado >=6.5: https://github.com/tornadoweb/tornado/issues/1377

    Args:
        connection: the tornado connection.
        largest: the limit in bytes.
        on_skipped: called with the first bytes and the size of a message that is skipped.
        on_part: called after each part of a large message: the other side still sends.
    """
    if not ENABLED:
        return
    protocol = connection.protocol
    read, handle = protocol._read_bytes, protocol._handle_message  # noqa: SLF001
    protocol.params.max_message_size = sys.maxsize
    skipped = 0

    async def read_parts(count: int) -> bytes:
        nonlocal skipped
        if count <= _LONGEST_CONTROL:
            return bytes(await read(count))
        before = protocol._fragmented_message_buffer or b""  # noqa: SLF001
        is_skipped = bool(skipped) or len(before) + count > largest
        most = max(0, _START - len(before)) if is_skipped else count
        kept, left = bytearray(), count
        while left:
            part = await read(min(left, _PART))
            left -= len(part)
            kept += part[: most - len(kept)]
            if left:
                on_part()
        if is_skipped:
            skipped += count - len(kept)
        return bytes(kept)

    def handle_unless_skipped(opcode: int, data: bytes) -> Any:
        nonlocal skipped
        if not skipped or opcode not in _DATA:
            return handle(opcode, data)
        size, skipped = len(data) + skipped, 0
        on_skipped(data[:_START], size)
        return None

    protocol._read_bytes, protocol._handle_message = read_parts, handle_unless_skipped  # noqa: SLF001


_LONGEST_CONTROL = 125  # bytes in a control frame, of a websocket
_DATA = (1, 2)  # the opcodes of text and binary messages
_START, _PART = 1000, 1 << 20


async def close_when_connected(connecting: asyncio.Future[Any], seconds: float) -> None:
    """Close a tornado websocket that is still connecting.

    Cancelling tornado's ``websocket_connect`` leaves the socket open. The fix waits for the connection for some seconds
    and closes it then, with its socket. Without the fix, the socket stays open until it is garbage-collected.

    Needed for tornado >=6.5: https://github.com/tornadoweb/tornado/blob/master/tornado/websocket.py
    """
    if not ENABLED:
        return
    import asyncio

    with contextlib.suppress(Exception):  # it did not connect, so there is nothing to close
        connection: Any = await asyncio.wait_for(connecting, seconds)
        stream = connection.protocol.stream
        connection.close()
        stream.close()


def bound_decompression() -> None:
    """Bound the decompressed size of a chunk in rosbags by the size that it claims, and by `MAX_CHUNK`.

    By itself rosbags decompresses until the memory is full, so a hostile file of some kilobytes ends the kernel. The
    fix replaces the functions in its tables of decompressors: a chunk that is larger, or damaged, raises an error.

    Needed for rosbags >=0.11.9: https://gitlab.com/ternaris/rosbags/-/blob/master/src/rosbags/rosbag1/reader.py
    """
    if not ENABLED:
        return
    # Imported lazily: widgets and feeds need no reader of files.
    from rosbags.rosbag1.reader import decompressors
    from rosbags.rosbag2.storage_mcap import DECOMPRESSORS

    from ..messages.compression import MAX_CHUNK, inflate

    def bounded(compression: str) -> Callable[..., bytes]:
        def decompress(data: bytes, size: int = MAX_CHUNK) -> bytes:
            raw, whole = inflate(compression, data, min(size, MAX_CHUNK))
            if not whole:
                raise ValueError(f"a chunk in {compression} is damaged, or larger than it claims")
            return raw

        return decompress

    decompressors.update({name: bounded(name) for name in ("bz2", "lz4")})
    DECOMPRESSORS.update({name: bounded(name) for name in ("zstd", "lz4")})
