"""What Python lacks in a browser, where it is WebAssembly: in Pyodide, and in JupyterLite, which is built on that.

`prepare` is called before anything else is imported. Nothing else in the package knows of browsers, but where something
cannot be there and says so.
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

from .stack_threads import StackThreads

IN_BROWSER = sys.platform == "emscripten"

LONG = 10.0
"""Seconds for which a cell may compute without a wait before it is told that nothing can interrupt it."""

_SAFE = 2**53
"""The integers up to here are numbers of JavaScript; those beyond are of a type that does not mix with them."""

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
    "robowidgets needs NumPy, which this site has not. "
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
    """Why robots cannot be reached from here, and what to do instead; empty where this is no browser."""
    if not IN_BROWSER:
        return ""
    return (
        f"{what} cannot be used in a browser: its Python opens no connections, and a cell that computes would hold up "
        "the zero that stops a robot, so no real robot is driven from there. feeds.simulator() has a robot that needs "
        "neither; for a real one, run Jupyter on a computer in its network"
    )


def prepare() -> StackThreads:
    """Give this Python threads, and have it and the page mean the same by None and by numbers."""
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
    """Say so where there is no NumPy, rather than Pyodide, whose advice is for a browser that reaches its packages.

    Raises:
        ModuleNotFoundError: there is none, and what to do.
    """
    if _is_absent("numpy"):
        raise ModuleNotFoundError(NO_NUMPY, name="numpy")


def prepare_recordings() -> None:
    """Import the readers of recordings, without the databases that they can read and Python in a browser cannot.

    Raises:
        ImportError: nothing unpacks recordings here, and what to do.
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
    except ModuleNotFoundError:  # Pyodide says so of what it has left out of Python
        return True


class _Pyodide:
    def __init__(self, js: Any, ffi: Any) -> None:
        self.loop = asyncio.get_event_loop()
        self.can_switch = hasattr(js.WebAssembly, "Suspending")
        self.can_wait: Callable[[], bool] = ffi.can_run_sync
        self.wait: Callable[[Awaitable[Any]], Any] = ffi.run_sync


class _LongCell:
    """Says once that a cell computes for long; again for the next one."""

    def __init__(self) -> None:
        self._was = 0.0

    def __call__(self, seconds: float) -> None:
        was, self._was = self._was, seconds
        if was < LONG <= seconds:
            print(LONG_CELL.format(seconds=seconds), file=sys.stderr)  # noqa: T201


# The modules of Python that are frozen, as `os` is, lie elsewhere than the others do.
_LIBRARIES = (
    os.path.dirname(os.__file__),
    os.path.dirname(os.path.dirname(asyncio.__file__)),
    os.path.normpath(sysconfig.get_path("purelib")),
    os.path.dirname(os.path.dirname(os.path.abspath(__file__))),
    *("<frozen", "<string>"),
)


def is_users(code: CodeType) -> bool:
    """Whether code is of the user, in a cell or a file: neither Python's nor installed."""
    return not code.co_filename.startswith(_LIBRARIES)


def clamp_timers(loop: type[asyncio.AbstractEventLoop]) -> None:
    """Have the event loop of Pyodide call at once what is due already, as that of Python does.

    It raises "Can't schedule in the past": so a time-out fails whose time is over before the loop knows of it.
    """

    def call_at(self: Any, when: float, callback: Any, *args: Any, context: Any = None) -> Any:
        return self.call_later(max(0.0, when - self.time()), callback, *args, context=context)

    loop.call_at = call_at  # type: ignore[assignment,method-assign]


def repair_comm(comm: Any, null: Any) -> None:
    """Have the messages of a comm be what they are by way of JSON.

    The kernel of JupyterLite passes objects, not JSON: None would be ``undefined`` for the page, whose scripts tell
    that from null, and a null of the page another object than None. An integer beyond 2**53 would be one that cannot be
    added to a number.

    Args:
        comm: the class of comms of the kernel.
        null: what Python has for the page's null.
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
    """A value as JSON has it: with null for None, and numbers that JavaScript can add."""
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
    """A value of the page with None for its null."""
    if value is null:
        return None
    if isinstance(value, dict):
        return {key: from_page(item, null) for key, item in value.items()}
    if isinstance(value, list):
        return [from_page(item, null) for item in value]
    return value
