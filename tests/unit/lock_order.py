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

_make = {"Lock": threading.Lock, "RLock": threading.RLock}
_held = threading.local()
edges: dict[tuple[str, str], str] = {}
"""For each pair of locks that one thread held at once, outer first, the thread that was the first to do so."""


class NotedLock:
    """A lock of ours by its name, which is that of its class and its attribute; as such it may be in a condition."""

    def __init__(self, lock: Any, name: str) -> None:
        self._lock, self._name = lock, name

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        is_taken = self._lock.acquire(blocking, timeout)
        if is_taken:
            self._note()
        return bool(is_taken)

    def release(self) -> None:
        held = _held.__dict__.setdefault("names", [])
        if self._name in held:  # else another thread releases it, as a signal
            held.reverse()
            held.remove(self._name)
            held.reverse()
        self._lock.release()

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *_: object) -> None:
        self.release()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._lock, name)

    # -- what a condition calls on an RLock that is waited with: it is free meanwhile ----------------------------------

    def _release_save(self) -> Any:
        held = _held.__dict__.setdefault("names", [])
        count = held.count(self._name)
        _held.names = [name for name in held if name != self._name]
        return self._lock._release_save(), count

    def _acquire_restore(self, state: Any) -> None:
        self._lock._acquire_restore(state[0])
        for _ in range(state[1]):
            self._note()

    def _note(self) -> None:
        held = _held.__dict__.setdefault("names", [])
        if self._name not in held and not getattr(_held, "collects", False):
            for outer in dict.fromkeys(held):
                edges.setdefault((outer, self._name), threading.current_thread().name)
        held.append(self._name)


def _noted(kind: str) -> Any:
    def make() -> Any:
        lock, frame = _make[kind](), sys._getframe(1)
        module = frame.f_globals.get("__name__", "")
        line = linecache.getline(frame.f_code.co_filename, frame.f_lineno)
        owner = _owner(frame)
        attribute = re.match(r"\s*self\.(\w+)\b.*\b(Lock|RLock)\(" if owner else r"(\w+)\b.*\b(Lock|RLock)\(", line)
        if not module.startswith("robowidgets") or attribute is None or owner == "_RealSignal":
            return lock  # of another package; or none that anybody holds
        return NotedLock(lock, f"{owner or module.rpartition('.')[2]}.{attribute[1]}")

    return make


def _owner(frame: FrameType) -> str:
    """The name of the class whose method runs, also where the object is of a subclass; empty outside of methods."""
    owner = frame.f_locals.get("self")
    for one in type(owner).__mro__ if owner is not None else ():
        if getattr(vars(one).get(frame.f_code.co_name), "__code__", None) is frame.f_code:
            return one.__name__
    return ""


def _on_collection(phase: str, _info: object) -> None:
    """While the garbage collector runs, which may close a widget under any lock, nothing is noted in its thread."""
    _held.collects = phase == "start"


def install() -> None:
    """Have robowidgets, which is not imported yet, make locks that are noted."""
    assert "robowidgets" not in sys.modules
    gc.callbacks.append(_on_collection)
    threading.Lock, threading.RLock = _noted("Lock"), _noted("RLock")  # type: ignore[misc, assignment]


def write(path: Path) -> None:
    """Write the edges, and the threads that are alive now."""
    threads = sorted({thread.name for thread in threading.enumerate() if thread.name.startswith("robowidgets")})
    path.write_text(json.dumps({"edges": sorted([*pair, who] for pair, who in edges.items()), "threads": threads}))
