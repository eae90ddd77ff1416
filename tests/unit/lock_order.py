"""Locks that note the order in which threads take them. It is imported before robowidgets, whose locks it replaces."""

from __future__ import annotations

import gc
import json
import linecache
import re
import sys
import threading
from pathlib import Path
from types import FrameType
from typing import Any

PAGE = Path(__file__).parents[2] / "docs" / "developers" / "threads.md"
_make = {"Lock": threading.Lock, "RLock": threading.RLock}
_held = threading.local()
edges: dict[tuple[str, str], str] = {}
"""For each pair of locks that one thread held at once, outer first, the first thread that did so."""
calls: dict[tuple[str, str], str] = {}
"""For each lock, and each observer or user function called under it, the first thread that did so."""


class NotedLock:
    """A lock of ours with its name, made of its class and its attribute; it may be in a condition."""

    __slots__ = ("_lock", "_name")

    def __init__(self, lock: Any, name: str) -> None:
        self._lock, self._name = lock, name

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        is_taken = self._lock.acquire(blocking, timeout)
        if is_taken:
            self._note()
        return bool(is_taken)

    def release(self) -> None:
        self._lock.release()
        held = _names()
        if held and held[-1] == self._name:
            held.pop()
        elif self._name in held:  # otherwise another thread releases it, as a signal
            held.reverse()
            held.remove(self._name)
            held.reverse()

    def __enter__(self) -> bool:
        self._lock.acquire()
        if not sys._getframe(1).f_globals["__name__"].startswith("tests."):  # one is held to keep a thread out
            self._note()
        return True

    def __exit__(self, *_: object) -> None:
        self.release()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._lock, name)

    # -- called by a condition on an RLock that is waited with: it is free meanwhile -----------------------------------

    def _release_save(self) -> Any:
        held = _names()
        count = held.count(self._name)
        _held.names = [name for name in held if name != self._name]
        return self._lock._release_save(), count

    def _acquire_restore(self, state: Any) -> None:
        self._lock._acquire_restore(state[0])
        for _ in range(state[1]):
            self._note()

    def _note(self) -> None:
        held = _names()
        if held and self._name not in held and not getattr(_held, "collects", False):
            for outer in held:
                if (outer, self._name) not in edges:
                    edges[outer, self._name] = threading.current_thread().name
        held.append(self._name)


def _names() -> list[str]:
    """The names of the locks that the calling thread holds, outer first."""
    try:
        names: list[str] = _held.names
    except AttributeError:
        names = _held.names = []
    return names


class _Noted:
    """Makes locks, noting those for robowidgets. As an attribute of a class, unlike a function, it gets no self."""

    def __init__(self, kind: str) -> None:
        self._make = _make[kind]

    def __call__(self) -> Any:
        lock, frame = self._make(), sys._getframe(1)
        module = frame.f_globals.get("__name__", "")
        if not module.startswith("robowidgets"):
            return lock
        line = linecache.getline(frame.f_code.co_filename, frame.f_lineno)
        owner = _owner(frame)
        attribute = re.match(r"\s*self\.(\w+)\b.*\b(Lock|RLock)\(" if owner else r"(\w+)\b.*\b(Lock|RLock)\(", line)
        if attribute is None or owner == "_RealSignal":
            return lock  # no thread holds it
        return NotedLock(lock, f"{owner or module.rpartition('.')[2]}.{attribute[1]}")


def _owner(frame: FrameType) -> str:
    """The class name of the running method, also for an object of a subclass, or empty outside of methods."""
    owner = frame.f_locals.get("self")
    for one in type(owner).__mro__ if owner is not None else ():
        if getattr(vars(one).get(frame.f_code.co_name), "__code__", None) is frame.f_code:
            return one.__name__
    return ""


def _on_collection(phase: str, _info: object) -> None:
    """Note nothing in a thread while it collects garbage, which may close a widget under any lock."""
    _held.collects = phase == "start"


def install() -> bool:
    """Make robowidgets create noted locks; return False, and do nothing, if it is imported already."""
    if "robowidgets" in sys.modules:
        return False
    gc.callbacks.append(_on_collection)
    threading.Lock, threading.RLock = _Noted("Lock"), _Noted("RLock")  # type: ignore[misc, assignment]
    return True


def note_calls() -> None:
    """Note the locks under which observers and user functions are called. It imports robowidgets."""
    import traitlets

    from robowidgets.runtime.runner import Runner
    from robowidgets.widget.observed import Observed

    _note_calls(Observed, "_call_observers", lambda observed: f"observers of a {type(observed).__name__}")
    _note_calls(Runner, "_call", lambda *_: "a function of a user")

    notify = traitlets.HasTraits.notify_change

    def notify_noted(self: Any, change: Any) -> None:
        name = change["name"]
        if _names() and not name.startswith("_") and getattr(self, "comm", None) is not None:  # else it is being made
            trait = getattr(type(self), name, None)
            if getattr(trait, "this_class", int).__module__.startswith("robowidgets"):
                _note_call(f"observers of {type(self).__name__}.{name}")
        notify(self, change)

    traitlets.HasTraits.notify_change = notify_noted  # type: ignore[method-assign]


def _note_calls(owner: type, method: str, described: Any) -> None:
    call = getattr(owner, method)

    def noted(self: Any, *args: Any, **options: Any) -> Any:
        if _names():
            _note_call(described(self))
        return call(self, *args, **options)

    setattr(owner, method, noted)


def _note_call(what: str) -> None:
    if not getattr(_held, "collects", False):
        for name in _names():
            if name != "DrivingWidget._page_lock" or what not in _OURS:
                calls.setdefault((name, what), threading.current_thread().name)


_OURS = {"observers of a CommandWatchdog", "observers of a Connection"}
"""The locks that a message of a pad may reach, all of them ours."""


def listed() -> list[str]:
    """The locks in the order of the page."""
    return re.findall(r"^\d+\. `(\w+\.\w+)`", PAGE.read_text(), re.MULTILINE)


class Checked:
    """The noted order of locks, from one check to the next."""

    def __init__(self) -> None:
        self._place = {name: place for place, name in enumerate(listed())}
        self._edges = self._calls = 0

    def problems(self) -> list[str]:
        """The violations of the page that were noted since the last check."""
        if (len(edges), len(calls)) == (self._edges, self._calls):
            return []
        new, called = list(edges.items())[self._edges :], list(calls.items())[self._calls :]
        self._edges, self._calls = self._edges + len(new), self._calls + len(called)
        return [
            *problems_of((*pair, thread) for pair, thread in new),
            *(f"{thread} calls {what} while it holds {name}" for (name, what), thread in called),
        ]


def problems_of(noted: Any) -> list[str]:
    """The pairs of locks that the page does not allow, each with the thread that took them."""
    place = {name: number for number, name in enumerate(listed())}
    return [
        f"{thread} takes {inner} while it holds {outer}"
        for outer, inner, thread in noted
        if not place.get(outer, len(place)) < place.get(inner, -1)
    ]


def write(path: Path) -> None:
    """Write the edges, and the threads that are alive."""
    threads = sorted({thread.name for thread in threading.enumerate() if thread.name.startswith("robowidgets")})
    path.write_text(json.dumps({"edges": sorted([*pair, who] for pair, who in edges.items()), "threads": threads}))
