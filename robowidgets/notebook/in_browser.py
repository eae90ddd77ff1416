"""Substitutes for what Python lacks in a browser: in Pyodide, and in JupyterLite, which is built on it.

`prepare` is called before anything else is imported. Other modules depend on the browser only to report what does not
work in it.
"""

from __future__ import annotations

import asyncio
import os
import sys
import sysconfig
import warnings
from collections.abc import Awaitable, Callable
from functools import wraps
from importlib.util import find_spec
from types import CodeType, ModuleType
from typing import Any

from ..runtime.stack_threads import StackThreads

IN_BROWSER = sys.platform == "emscripten"

LONG = 10.0
"""Seconds for which a cell may compute without a wait before a note says that nothing can interrupt it."""

_SAFE = 2**53
"""The largest integer that is a number in JavaScript. Larger ones have a type that does not mix with numbers."""

NO_SWITCHING = (
    "This browser cannot pause Python: it has no JavaScript Promise Integration for WebAssembly. Use a current Chrome, "
    "Edge or Firefox. Pictures show what a cell left; feeds, programs and wait() do not work"
)

LONG_CELL = (
    "This cell has computed for {seconds:.0f} s without a pause. Nothing in the browser can interrupt it: "
    "if it does not end, choose Restart Kernel in the menu Kernel. A loop that waits for something, as in "
    "`for scan in feed.scans('/scan'):` or with `time.sleep(0.1)`, leaves time to robot and pictures"
)

NO_NUMPY = (
    "robowidgets needs NumPy, which this site does not have. "
    "`make site ROBOWIDGETS_PYODIDE_NUMPY=pyodide` builds one that has it"
)
NO_RECORDINGS = (
    "recordings cannot be opened here: this browser's Python has no lz4 and no zstd to unpack them. Open them on a "
    "site that `make site` made, or where Jupyter runs on a computer; a page that recording.to_html() writes there "
    "plays in any browser"
)
NO_DATABASES = (
    "{name}: a database cannot be opened in a browser, whose Python has no SQLite: expected .mcap or .bag. "
    "`robowidgets repair {quoted}` makes an .mcap of it on a computer"
)


def no_robot(what: str) -> str:
    """Return why robots cannot be reached from a browser, and what to do instead; empty outside a browser."""
    if not IN_BROWSER:
        return ""
    return (
        f"{what} cannot be used in a browser: its Python opens no connections, and a cell that computes would hold up "
        "the zero that stops a robot, so no real robot is driven from there. feeds.simulator() has a robot that needs "
        "neither; for a real one, run Jupyter on a computer in its network"
    )


def prepare() -> StackThreads:
    """Give this Python threads, and make None and numbers mean the same in Python and in the page."""
    import js  # type: ignore[import-not-found,unused-ignore]
    import pyodide.ffi  # type: ignore[import-not-found,unused-ignore]

    host = _Pyodide(js, pyodide.ffi)
    if not host.can_switch:
        warnings.warn(NO_SWITCHING, stacklevel=3)
    threads = StackThreads(host, _LongCell())
    threads.install()
    threads.slice_time(is_users)
    clamp_timers(type(host.loop))
    kernel_comm: Any = sys.modules.get("pyodide_kernel.comm")
    if kernel_comm is not None:
        repair_comm(kernel_comm.Comm, pyodide.ffi.jsnull)
    return threads


def check_numpy() -> None:
    """Raise an error with advice if NumPy is missing. Pyodide's advice needs a browser that reaches its packages.

    Raises:
        ModuleNotFoundError: NumPy is missing; the text says what to do.
    """
    if _is_absent("numpy"):
        raise ModuleNotFoundError(NO_NUMPY, name="numpy")


def prepare_recordings() -> None:
    """Import the readers of recordings without their support for databases, which Python in a browser lacks.

    Raises:
        ImportError: recordings cannot be decompressed here; the text says what to do.
    """
    if _is_absent("lz4"):
        raise ImportError(NO_RECORDINGS)
    absent = [name for name in ("apsw", "sqlite3") if _is_absent(name)]
    sys.modules.update((name, ModuleType(name)) for name in absent)
    try:
        import rosbags.rosbag2  # noqa: F401
    finally:
        for name in absent:
            del sys.modules[name]


def _is_absent(name: str) -> bool:
    try:
        return find_spec(name) is None
    except ModuleNotFoundError:  # Pyodide raises it for modules that it has left out of Python
        return True


class _Pyodide:
    def __init__(self, js: Any, ffi: Any) -> None:
        self.loop = asyncio.get_event_loop()
        self.can_switch = hasattr(js.WebAssembly, "Suspending")
        self.can_wait: Callable[[], bool] = ffi.can_run_sync
        self.wait: Callable[[Awaitable[Any]], Any] = ffi.run_sync


class _LongCell:
    """Prints a note once for each cell that computes for long."""

    def __init__(self) -> None:
        self._was = 0.0

    def __call__(self, seconds: float) -> None:
        was, self._was = self._was, seconds
        if was < LONG <= seconds:
            print(LONG_CELL.format(seconds=seconds), file=sys.stderr)  # noqa: T201


# Frozen modules of Python, such as `os`, are in another folder than the others.
_LIBRARIES = (
    os.path.dirname(os.__file__),
    os.path.dirname(os.path.dirname(asyncio.__file__)),
    os.path.normpath(sysconfig.get_path("purelib")),
    os.path.dirname(os.path.dirname(os.path.abspath(__file__))),
    *("<frozen", "<string>"),
)


def is_users(code: CodeType) -> bool:
    """Return True if code is the user's, in a cell or a file, and not of Python or of an installed package."""
    return not code.co_filename.startswith(_LIBRARIES)


def clamp_timers(loop: type[asyncio.AbstractEventLoop]) -> None:
    """Make the event loop of Pyodide call overdue functions at once, as the event loop of Python does.

    By itself it raises "Can't schedule in the past", so a time-out that is over before it is scheduled fails.
    """

    def call_at(self: Any, when: float, callback: Any, *args: Any, context: Any = None) -> Any:
        return self.call_later(max(0.0, when - self.time()), callback, *args, context=context)

    loop.call_at = call_at  # type: ignore[assignment,method-assign]


def repair_comm(comm: Any, null: Any) -> None:
    """Convert the messages of a comm as JSON would.

    The kernel of JupyterLite passes objects, not JSON. None would become ``undefined`` in the page, where scripts
    distinguish it from null, and a null of the page would not become None. An integer beyond 2**53 would become a type
    that cannot be added to a number.

    Args:
        comm: the class of comms of the kernel.
        null: the object that stands for the page's null in Python.
    """
    publish, handle = comm.publish_msg, comm.handle_msg

    @wraps(publish)
    def publish_msg(
        self: Any, msg_type: str, data: Any = None, metadata: Any = None, buffers: Any = None, **keys: Any
    ) -> None:
        publish(self, msg_type, to_page(data or {}, null), to_page(metadata or {}, null), buffers, **keys)

    @wraps(handle)
    def handle_msg(self: Any, msg: Any) -> None:
        handle(self, from_page(msg, null))

    comm.publish_msg, comm.handle_msg = publish_msg, handle_msg


def to_page(value: Any, null: Any) -> Any:
    """Convert a value for the page: null for None, and numbers that JavaScript can add."""
    if value is None:
        return null
    if isinstance(value, dict):
        return {key: to_page(item, null) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [to_page(item, null) for item in value]
    if isinstance(value, int) and abs(value) > _SAFE:
        return float(value)
    return value


def from_page(value: Any, null: Any) -> Any:
    """Convert a value from the page: None for null."""
    if value is null:
        return None
    if isinstance(value, dict):
        return {key: from_page(item, null) for key, item in value.items()}
    if isinstance(value, list):
        return [from_page(item, null) for item in value]
    return value
