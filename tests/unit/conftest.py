"""Fixtures for every unit test, and checks that no test leaves anything behind."""

from __future__ import annotations

import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from ..patience import be_patient
from . import lock_order

lock_order.install()

from robowidgets.behaviors import program as _program  # noqa: E402
from robowidgets.driving import command_watchdog as _watchdog  # noqa: E402
from robowidgets.feeds import Feed  # noqa: E402
from robowidgets.messages import definitions  # noqa: E402
from robowidgets.runtime.user_threads import UserThread  # noqa: E402
from robowidgets.widget import pacer as _pacer  # noqa: E402
from robowidgets.widget.pacer import Pacer  # noqa: E402

from .feeds.scripted import CMD_VEL, SCAN, Scripted  # noqa: E402
from .senders import get_timers, turn_of  # noqa: E402
from .waiting import wait_for  # noqa: E402

lock_order.note_calls()

USER_LIMITS = [
    (_program, "STEP", _program.STEP),
    (_program, "HELD", _program.HELD),
    (_watchdog, "STANDSTILL", _watchdog.STANDSTILL),
]
be_patient()  # a program that has failed takes no further step, and a test would wait in vain


class QuietEnd:
    """An unraisable hook that ignores the end of a user's thread in a finalizer: it may be ended again in the hook."""

    def __init__(self, hook: Callable[[Any], object]) -> None:
        self._hook = hook

    def __call__(self, unraisable: Any) -> None:
        if not (issubclass(unraisable.exc_type, SystemExit) and isinstance(threading.current_thread(), UserThread)):
            self._hook(unraisable)


@pytest.hookimpl(trylast=True)
def pytest_configure() -> None:
    sys.unraisablehook = QuietEnd(sys.unraisablehook)


KEPT = {"robowidgets-pacer", "robowidgets-rerun", "robowidgets-timer"}
"""Threads that exist once in a process, to its end."""


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Start with the files that take longest, so that no process ends with a long one while the others are done."""
    takes: Counter[Path] = Counter()
    for item in items:
        takes[item.path] += 20 if item.get_closest_marker("slow") else 1
    items.sort(key=lambda item: -takes[item.path])


@pytest.fixture
def user_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Set the limits that users have, for tests of late steps and of standstills."""
    for module, name, limit in USER_LIMITS:
        monkeypatch.setattr(module, name, limit)


@pytest.fixture
def pacer() -> Iterator[Pacer]:
    """A pacer of the test's own, with a thread; it sends nothing more after the test."""
    pacer = Pacer()
    yield pacer
    with turn_of(pacer):
        for sender in {*pacer._due, *get_timers(pacer)}:
            pacer.forget(sender)


@pytest.fixture
def script() -> Scripted:
    """A robot with a laser that takes speeds."""
    return Scripted(SCAN, CMD_VEL)


@pytest.fixture
def robot(script: Scripted) -> Iterator[Feed]:
    """A feed of this robot."""
    with Feed(script) as opened:
        yield opened


@pytest.fixture
def no_added_definitions(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Reset the message definitions to our own: definitions that a test adds are forgotten with it."""
    monkeypatch.setattr(definitions, "_added", {})
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    yield
    definitions.add({})  # so that definitions are looked up again


@pytest.fixture(autouse=True)
def _ends_what_it_starts() -> Iterator[None]:
    """Fail a test that leaves behind what would log into another test: a failing sender, or a thread of a feed."""
    before = {*threading.enumerate()}
    yield
    failing = [sender for sender in list(_pacer.pacer._due) if id(sender) in _pacer.pacer._failures]
    for sender in failing:
        _pacer.pacer.forget(sender)
    assert not failing, "these still failed to be sent after the test"
    started = [thread for thread in threading.enumerate() if thread not in before and thread.name not in KEPT]
    for thread in started:
        if thread.name.startswith("robowidgets"):
            wait_for(lambda one=thread: one.is_alive() or one not in threading.enumerate(), "it is started")
            thread.join(60)
            assert not thread.is_alive(), f"the test leaves a thread of ours: {thread.name}"


@pytest.fixture(autouse=True)
def _takes_locks_in_order() -> Iterator[None]:
    """Fail a test in which a thread takes locks in an order that docs/developers/threads.md does not allow."""
    yield
    problems = _order.problems()
    assert not problems, "see docs/developers/threads.md"


_order = lock_order.Checked()
