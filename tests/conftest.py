"""Fixtures for every test."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Generator, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[1]

# For a format that no notebook has, jsonschema builds a grammar at its import, and nbformat imports jsonschema: two
# seconds in each process that collects tests.
sys.modules.setdefault("rfc3987_syntax", None)  # type: ignore[arg-type]

# A shell starts background processes with SIGINT ignored, nohup with SIGHUP, and the programs that tests
# interrupt and end would inherit that.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


def real_recordings() -> Path:
    """The folder of real recordings, named by ROBOWIDGETS_DATA or in ../shared/data next to the checkout."""
    return Path(os.environ.get("ROBOWIDGETS_DATA") or ROOT.parent / "shared" / "data")


@pytest.fixture(scope="session")
def data() -> Path:
    """The folder of real recordings; a test that uses it is skipped if the folder is missing."""
    folder = real_recordings()
    if not folder.is_dir():
        pytest.skip(f"no real recordings here: {folder} is missing; ROBOWIDGETS_DATA may name another folder")
    return folder


def pytest_collection_finish() -> None:
    """Exclude from garbage collection what stays to the end: thousands of tests, and all modules."""
    gc.collect()
    gc.freeze()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Generator[None, Any, Any]:
    """Report a skip for want of real recordings here, not at each test: the summary then has one line for all."""
    report = yield
    if report.skipped and "data" in getattr(item, "fixturenames", ()) and isinstance(report.longrepr, tuple):
        report.longrepr = (__file__, real_recordings.__code__.co_firstlineno, report.longrepr[2])
    return report


@pytest.fixture
def start() -> Iterator[Callable[..., subprocess.Popen[Any]]]:
    """`subprocess.Popen`, whose processes and their children end with the test, whatever its outcome."""
    started: list[subprocess.Popen[Any]] = []

    def start(command: list[str], **options: Any) -> subprocess.Popen[Any]:
        started.append(subprocess.Popen(command, start_new_session=True, **options))
        return started[-1]

    yield start
    for process in started:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


@pytest.fixture
def kernel_sends(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make the kernel send speeds itself, without a guard: the test controls what this process publishes."""
    from robowidgets.feeds import _driver

    monkeypatch.setattr(_driver, "OFF", True)
