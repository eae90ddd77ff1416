"""Fixes for Python, Linux and other packages: each changes or bypasses something that is not ours.

Each function is one fix, and its docstring says what is wrong, what the fix does and what happens without it. Its last
lines name the versions that need it, with the issue or the code upstream. `tests/unit/test_platform_fixes.py` shows for
each of these lines that an installed version goes wrong without the fix: that test fails when a version is cured.

With ``ROBOWIDGETS_PLATFORM_FIXES=off`` in the environment of the kernel no fix does anything: to find out whether one
causes a problem.
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
    """Let our threads get the interpreter lock (GIL) soon, for the whole process.

    By default a thread waits 5 ms before it asks for the lock, and that wait begins anew each time the lock changes
    hands. A loop that reads a file or prints every millisecond so starves all other threads, and the page stands still.
    The fix sets 0.1 ms, unless the program has set an interval itself.

    Needed for Python >=3.10: https://bugs.python.org/issue7946
    """
    if ENABLED and sys.getswitchinterval() == _DEFAULT_SWITCH_INTERVAL:
        sys.setswitchinterval(SWITCH_INTERVAL)


def message_padding() -> dict[str, str]:
    """An extra field for a message to the page, which makes each message shorter than the one before.

    Jupyter's server leaves Nagle's algorithm on, so it holds a small message back until the previous one is
    acknowledged. Linux takes messages of equal length for full segments and delays their acknowledgement by 40 ms. So
    every third frame of the display would be missing. Messages of different length are acknowledged at once.

    Needed for jupyter_server >=2: https://github.com/jupyter-server/jupyter_server/blob/main/jupyter_server/services/kernels/websocket.py
    """
    return {"pad": next(_pads)} if ENABLED else {}


def run_beside_debugger(thread: Any) -> None:
    """Let a thread run while a debugger holds the program. Called before the thread starts.

    At a breakpoint debugpy, which JupyterLab and VS Code use, suspends all threads, and with them the one that would
    send zero. The fix marks a thread as ipykernel marks its own. Without it, a robot drives on meanwhile.

    Needed for debugpy >=1.6: https://github.com/microsoft/debugpy/issues/547
    """
    if ENABLED:
        thread.pydev_do_not_trace = thread.is_pydev_daemon_thread = True


def route_by_message(comm: Any, only: str | None = None) -> None:
    """Have a widget's comm handle messages of the page beside a running cell, so that Stop does not wait for the cell.

    JupyterLab has a subshell for widgets, a thread beside the main one, and names it in each message. ipykernel 7.1 to
    7.3 handle the message there. ipykernel 7.4 handles it in the shell from which the widget last sent something. That
    is nearly always the main one, where the message waits for the end of the cell. The fix makes one comm use the name
    in the message instead; its handlers must be safe in any thread. ipykernel 6 has no subshells. ``only`` is the key
    of the messages for which that is done; others, and changes of traits, which functions of the user may observe, stay
    where ipykernel handles them.

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

    IPython's own event comes after the traceback was made, and not at all where the cell catches the interrupt: a robot
    would drive on meanwhile. A cell with ``await`` may even go on to its end. ipykernel sets a SIGINT handler anew for
    each cell, Python's or, for a cell with ``await``, one of its own. So each cell must call this. A handler of the
    program stays. Without the fix, only the event is left.

    Needed for ipython >=8: https://github.com/ipython/ipython/blob/main/IPython/core/events.py
    Needed for ipykernel >=6: https://github.com/ipython/ipykernel/issues/328
    """
    before: Any = signal.getsignal(signal.SIGINT)

    def on_interrupt(number: int, frame: Any) -> None:
        call()
        before(number, frame)

    is_usual = before is signal.default_int_handler or getattr(before, "__module__", "") == "ipykernel.ipkernel"
    if ENABLED and is_usual:
        _set_below_rclpy(signal.SIGINT, on_interrupt)


def call_before_traceback(shell: Any, call: Callable[[], None]) -> None:
    """Call a function as soon as the running cell has raised, before IPython shows the traceback.

    IPython's own event comes after that, which may take seconds, and not at all for a script that ``%run`` runs: a
    robot would drive on meanwhile. Without the fix, only the event is left.

    Needed for ipython >=8: https://github.com/ipython/ipython/blob/main/IPython/core/interactiveshell.py
    """
    show = shell.showtraceback

    def call_and_show(*args: Any, **kwargs: Any) -> Any:
        call()
        return show(*args, **kwargs)

    if ENABLED:
        shell.showtraceback = call_and_show


def call_on_idle_interrupt(kernel: Any, call: Callable[[], None]) -> None:
    """Call a function when a kernel is interrupted that runs no cell.

    Between cells ipykernel ignores SIGINT. But a program goes on driving between cells, and who interrupts the kernel
    then wants it to stop. ipykernel restores the handler of before each cell after it; the fix replaces what it
    restores. Without the fix, only Stop and a running cell's interrupt stop a program.

    Needed for ipykernel >=6: https://github.com/ipython/ipykernel/pull/49
    """

    def on_interrupt(_number: int, _frame: Any) -> None:
        call()

    if ENABLED and getattr(kernel, "saved_sigint_handler", None) is signal.SIG_IGN:
        kernel.saved_sigint_handler = on_interrupt


def call_before_end(call: Callable[[], object]) -> None:
    """Call a function before a signal, or ipykernel, ends the process without running its exit handlers.

    SIGTERM comes from ``kill``, from a container or a service that is stopped, SIGHUP from a terminal that is closed. A
    kernel whose server is gone ends itself by ``os._exit``. In each case a robot would drive on. The function is called
    in a thread of its own, because the main thread may hold a lock that the function needs; then the process ends as it
    would have. Where rclpy handles SIGTERM, it does not end: rclpy shuts down, and the program ends itself. The main
    thread notices a signal only between two steps of Python. A handler of the program stays. Without the fix, only a
    process that ends in an orderly way calls the function.

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
    """Let any thread print and log in ipykernel 6.29 to 7.0, where that may hang for ever.

    To find the cell that a printed text belongs to, ipykernel notes which thread started which, by their identifiers.
    Python uses the identifier of an ended thread again, so the notes may form a circle, and ipykernel follows it
    without end. The fix drops the notes on an ended thread when its identifier is used again. Without the fix, a thread
    that prints or logs may hang, and so does each thread that logs after it.

    Needed for ipykernel >=6.29,<7.1: https://github.com/ipython/ipykernel/issues/1269
    """
    kernel = getattr(ipython_shell(), "kernel", None)
    for name in ("_stdout", "_stderr"):
        stream: Any = getattr(kernel, name, None)
        if ENABLED and type(getattr(stream, "_thread_to_parent", None)) is dict:
            stream._thread_to_parent = _ThreadParents()


def capture_prints(take: Callable[[str], bool]) -> None:
    """Pass what the calling thread prints to a function; it returns whether nothing else is to show it.

    ``sys.stdout`` belongs to the process: Python has no other output for one thread. The fix puts a stream in its place
    that looks at the thread. IPython and pytest replace ``sys.stdout`` at any time; so this looks again each time that
    it is called. Without the fix, a program's page does not show its prints.

    Needed for Python >=3.10: https://docs.python.org/3/library/contextlib.html#contextlib.redirect_stdout
    """
    if not ENABLED:
        return
    with _printing:
        _takes[threading.current_thread()] = take
        if not isinstance(sys.stdout, _Router):
            sys.stdout = _router_of(sys.stdout)


def release_prints() -> None:
    """Undo `capture_prints` for the calling thread, and for those that have ended.

    After the last one, ``sys.stdout`` is what it was.
    """
    with _printing:
        _takes.pop(threading.current_thread(), None)
        for ended in [thread for thread in _takes if not thread.is_alive()]:
            del _takes[ended]
        if not _takes and isinstance(sys.stdout, _Router):
            sys.stdout = sys.stdout.inner


class _Router:
    """Stands in for ``sys.stdout``: passes on what is printed, and shows it to what takes the prints of the thread."""

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
"""By thread: what takes its prints."""
_routers: deque[_Router] = deque(maxlen=50)
"""The last that were made, one for each stream. They stay, because ``print`` may hold no reference to ``sys.stdout``
while it writes there: one that went away meanwhile, when the last program ended, would take the process with it."""
_printing = threading.Lock()


def change_tracebacks(change: Callable[[BaseException, TracebackType | None], _Changed]) -> None:
    """Have IPython, if it is running, show each traceback as a context manager gives it.

    IPython asks only errors of other classes than Python's own how they are shown, and always shows the last frame,
    even one that is marked as hidden. The fix wraps what makes the traceback. Without it, a wrong argument is shown
    with the lines of robowidgets and traitlets that found it.

    Needed for ipython >=8: https://github.com/ipython/ipython/issues/12565
    """
    shows = getattr(ipython_shell(), "InteractiveTB", None)  # a nicety, which a shell may do without
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
    """Give a widget the class, with further traits, that another of its class was given; returns whether it was done.

    anywidget adds the front end to each widget as traits, for which traitlets makes a class of its own each time. That
    doubles the time of making a widget. Without the fix, each has its own.

    Needed for traitlets >=5: https://github.com/ipython/traitlets/issues/500
    Needed for anywidget >=0.11: https://github.com/manzt/anywidget/blob/main/anywidget/widget.py
    """
    if ENABLED:
        widget.__class__ = made
    return ENABLED


class _ThreadParents(dict[int, int]):
    """By the identifier of a thread, that of the thread which started it. It has no circles."""

    def __setitem__(self, thread: int, parent: int) -> None:
        for child, starter in list(self.items()):
            if starter == thread:
                self.pop(child, None)
        super().__setitem__(thread, parent)


def _rclpy_that_handles(number: int) -> Any:
    """The module `rclpy.signals`, if it calls its handler of a signal installed; else None.

    That handler is in C, and Python does not know of it. It calls the one before it, unless that is the default, and
    shuts down the contexts of rclpy; it does not end the process.
    """
    signals: Any = sys.modules.get("rclpy.signals")
    if signals is None:
        return None
    options = signals.SignalHandlerOptions
    handling = {int(signal.SIGINT): options.SIGINT, int(signal.SIGTERM): options.SIGTERM}
    current = signals.get_current_signal_handlers_options()
    return signals if number in handling and current in (handling[number], options.ALL) else None


def _set_below_rclpy(number: int, handler: Callable[[int, Any], None]) -> bool:
    """Set a handler of a signal; that of rclpy, where there is one, calls it then, and `rclpy.shutdown` leaves it.

    Returns:
        False if rclpy takes its handler for installed, though the program has replaced it.
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
    """Have Linux acknowledge what a socket has received, now.

    The Foxglove SDK's server leaves Nagle's algorithm on: it sends no more until its last message is acknowledged, and
    Linux delays that by up to 40 ms. The option lasts for one acknowledgement only, so each delivery calls this.

    Needed for foxglove-sdk >=0.10: https://github.com/foxglove/foxglove-sdk/blob/main/rust/foxglove/src/websocket/server.rs
    """
    if ENABLED and _QUICKACK is not None:
        sock.setsockopt(socket.IPPROTO_TCP, _QUICKACK, 1)


def skip_large_messages(
    connection: Any, largest: int, on_skipped: Callable[[bytes, int], object], on_part: Callable[[], object]
) -> None:
    """Skip the messages of a websocket that are larger than a limit, and report the start and the size of each.

    tornado closes the connection at such a message, and does not tell what it was. The fix wraps the methods by which
    the protocol of one connection reads bytes and takes a message. Without the fix, a topic of large messages ends each
    new connection.

    Needed for tornado >=6.5: https://github.com/tornadoweb/tornado/issues/1377

    Args:
        connection: the connection of tornado.
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

    with contextlib.suppress(Exception):  # whatever keeps it from connecting; there is nothing to close then
        connection: Any = await asyncio.wait_for(connecting, seconds)
        stream = connection.protocol.stream
        connection.close()
        stream.close()


def bound_decompression() -> None:
    """Let rosbags decompress a chunk into no more bytes than it claims, or than a chunk may have.

    By itself rosbags decompresses for as long as there is memory, so a hostile file of some kilobytes ends the kernel.
    The fix replaces the functions in its tables of decompressors; a chunk that is larger, or damaged, raises.

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
