"""Fixes for other packages, and the switch that turns them off."""

from __future__ import annotations

import asyncio
import inspect
import json
import os
import platform
import re
import signal
import subprocess
import sys
import threading
import traceback
from collections.abc import Iterator
from importlib.metadata import version
from itertools import pairwise
from pathlib import Path
from types import FunctionType, SimpleNamespace
from typing import Any

import pytest
from packaging.specifiers import SpecifierSet
from packaging.version import Version
from tornado.httpserver import HTTPServer
from tornado.testing import bind_unused_port
from tornado.web import Application
from tornado.websocket import WebSocketHandler, websocket_connect

from robowidgets.runtime import platform_fixes
from robowidgets.runtime.platform_fixes import let_threads_print, message_padding, route_by_message, skip_large_messages
from robowidgets.runtime.short_traceback import without_our_frames

from ..shells import put_in_place
from ..upstream import GOES_WRONG, GOES_WRONG_SLOWLY

FIXES = {
    name: fix
    for name, fix in vars(platform_fixes).items()
    if isinstance(fix, FunctionType) and fix.__module__ == platform_fixes.__name__ and not name.startswith("_")
}
PROJECT = Path(__file__).parents[3] / "pyproject.toml"
NEEDED = re.compile(r"^Needed for (\S+) (\S+): https://\S+$", re.MULTILINE)


def needs() -> Iterator[tuple[str, str, str]]:
    """Each fix with a project that fails without it, and the affected versions."""
    for name, fix in FIXES.items():
        for project, versions in NEEDED.findall(inspect.getdoc(fix) or ""):
            yield name, project, versions


def test_each_fix_names_the_projects_that_need_it_and_each_need_is_shown() -> None:
    undo = {"release_prints"}
    assert {fix for fix, _, _ in needs()} == FIXES.keys() - undo
    assert sorted((fix, project) for fix, project, _ in needs()) == sorted([*GOES_WRONG, *GOES_WRONG_SLOWLY])


@pytest.mark.parametrize(
    ("fix", "project", "versions"),
    [
        pytest.param(
            *need, marks=[pytest.mark.slow] if need[:2] in GOES_WRONG_SLOWLY else [], id=f"{need[0]}-{need[1]}"
        )
        for need in needs()
    ],
)
def test_without_a_fix_the_versions_that_it_names_go_wrong_and_no_others(fix: str, project: str, versions: str) -> None:
    installed = platform.python_version() if project == "Python" else version(project)
    goes_wrong = (GOES_WRONG | GOES_WRONG_SLOWLY)[fix, project]()
    assert goes_wrong == SpecifierSet(versions).contains(installed, prereleases=True), (
        f"{project} {installed} {'goes wrong' if goes_wrong else 'is fixed'}: change the last lines of `{fix}`"
    )


def test_each_fix_is_needed_by_a_version_that_is_allowed() -> None:
    """A fix that is no longer needed has to go, with its test."""
    lowest: dict[str, list[Version]] = {}
    for project, least in re.findall(r'"([\w-]+)(?:\[\w+\])?>=([\d.]+)', PROJECT.read_text(encoding="utf-8")):
        lowest.setdefault(project, []).append(Version(least))
    for fix, project, versions in needs():
        cured = [Version(one.version) for one in SpecifierSet(versions) if one.operator == "<"]
        assert not cured or min(lowest[project]) < min(cured), f"no allowed version of {project} needs `{fix}`"


EVERY_FIX = """
import asyncio, json, signal, socket, sys
from types import SimpleNamespace
import IPython
from robowidgets.runtime import platform_fixes as fixes
from IPython.core.interactiveshell import InteractiveShell
from rosbags.rosbag1.reader import decompressors

class Shell(InteractiveShell):
    def __init__(self, **members):
        vars(self).update(members)

async def close_a_pending_connection():
    closed = []
    stream = SimpleNamespace(close=lambda: closed.append("socket"))
    connection = SimpleNamespace(protocol=SimpleNamespace(stream=stream), close=lambda: closed.append("websocket"))
    connecting = asyncio.get_running_loop().create_future()
    connecting.set_result(connection)
    await fixes.close_when_connected(connecting, 1.0)
    return closed == ["websocket", "socket"]

fixes.shorten_switch_interval()
comm = SimpleNamespace(_reply_subshell_for=None)
fixes.route_by_message(comm)
fixes.call_on_interrupt(lambda: None)
fixes.call_before_end(lambda: None)
stream = SimpleNamespace(_thread_to_parent={})
shell = Shell(kernel=SimpleNamespace(_stdout=stream, _stderr=stream))
IPython.get_ipython = lambda: shell
fixes.let_threads_print()
options = []
fixes.acknowledge_at_once(SimpleNamespace(setsockopt=lambda *option: options.append(option)))
out, traceback = sys.stdout, lambda *_: None
class Plain:
    pass
class Known(Plain):
    pass
fixes.capture_prints(lambda text: False)
prints_captured = sys.stdout is not out
fixes.release_prints()
shell.InteractiveTB = SimpleNamespace(structured_traceback=traceback)
fixes.change_tracebacks(lambda *_: None)
shell.showtraceback = traceback
fixes.call_before_traceback(shell, lambda: None)
widget = Plain()
fixes.share_class(widget, Known)
kernel = SimpleNamespace(saved_sigint_handler=signal.SIG_IGN)
fixes.call_on_idle_interrupt(kernel, lambda: None)
thread = SimpleNamespace()
fixes.run_beside_debugger(thread)
decompress = decompressors["bz2"]
fixes.bound_decompression()
read = lambda count: None
protocol = SimpleNamespace(_read_bytes=read, _handle_message=None, params=SimpleNamespace())
fixes.skip_large_messages(SimpleNamespace(protocol=protocol), 10, print, print)
print(json.dumps({
    "switch interval": sys.getswitchinterval() < 0.005,
    "padding": bool(fixes.message_padding()),
    "subshell": comm._reply_subshell_for is not None,
    "interrupt": signal.getsignal(signal.SIGINT) is not signal.default_int_handler,
    "end": signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL,
    "prints": type(stream._thread_to_parent) is not dict,
    "acknowledgement": bool(options) or not hasattr(socket, "TCP_QUICKACK"),
    "captured prints": prints_captured,
    "tracebacks": shell.InteractiveTB.structured_traceback is not traceback,
    "before the traceback": shell.showtraceback is not traceback,
    "class": type(widget) is Known,
    "idle interrupt": kernel.saved_sigint_handler is not signal.SIG_IGN,
    "debugger": bool(vars(thread)),
    "decompression": decompressors["bz2"] is not decompress,
    "large messages": protocol._read_bytes is not read,
    "pending connection": asyncio.run(close_a_pending_connection()),
}))
"""


@pytest.mark.slow
@pytest.mark.parametrize(("switch", "applied"), [("", True), ("on", True), ("off", False), ("OFF", False)])
def test_one_switch_in_the_environment_turns_every_fix_off(switch: str, applied: bool) -> None:
    # Where a parent ignores SIGINT, Python starts without its own handler.
    program = f"import signal\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n{EVERY_FIX}"
    environment = os.environ | {"ROBOWIDGETS_PLATFORM_FIXES": switch}
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True)
    assert set(json.loads(done.stdout).items()) == {(fix, applied) for fix in json.loads(done.stdout)}


def test_no_two_messages_in_a_row_are_padded_to_the_same_length() -> None:
    lengths = [len(message_padding()["pad"]) for _ in range(200)]
    assert all(first != second for first, second in pairwise(lengths))


def test_messages_go_to_the_subshell_that_the_page_named() -> None:
    comm: Any = SimpleNamespace(_reply_subshell_for=lambda _data, _named: None)
    route_by_message(comm)
    assert comm._reply_subshell_for({"method": "custom"}, "subshell") == "subshell"


def test_a_kernel_without_subshells_is_left_alone() -> None:
    comm = SimpleNamespace()
    route_by_message(comm)
    assert vars(comm) == {}


def test_threads_whose_identifiers_are_used_again_form_no_circle(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = SimpleNamespace(_thread_to_parent={threading.get_ident(): threading.get_ident()})
    put_in_place(monkeypatch, kernel=SimpleNamespace(_stdout=stream, _stderr=None))
    let_threads_print()
    parents = stream._thread_to_parent
    for thread, starter in ((2, 1), (3, 2), (1, 3), (2, 1), (3, 9), (1, 3)):
        parents[thread] = starter
        seen = {thread}
        while thread in parents:
            thread = parents[thread]
            assert thread not in seen
            seen.add(thread)


@pytest.mark.parametrize("part", [1000, 200_000])
def test_a_message_that_is_too_large_is_skipped_whole_and_the_next_ones_come(
    part: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In one frame, and in fragments, between which pings may come."""
    monkeypatch.setattr(platform_fixes, "_PART", part)
    skipped: list[tuple[bytes, int]] = []
    parts: list[int] = []

    class Several(WebSocketHandler):
        async def open(self, *_: str, **__: str) -> None:
            await self.write_message(b"\x01" * 300_000, binary=True)
            await self.write_message("small")
            protocol = self.ws_connection
            for opcode, final, size in ((1, False, 60_000), (0, False, 60_000), (9, True, 4), (0, True, 60_000)):
                await protocol._write_frame(final, opcode, b"a" * size)
            await self.write_message("next")

    async def hear() -> list[Any]:
        listening, port = bind_unused_port()
        server = HTTPServer(Application([("/", Several)]))
        server.add_socket(listening)
        heard: list[Any] = []
        connection = await websocket_connect(f"ws://127.0.0.1:{port}/", on_message_callback=heard.append)
        skip_large_messages(
            connection, 100_000, lambda start, size: skipped.append((start, size)), lambda: parts.append(1)
        )
        while len(heard) < 2:
            await asyncio.sleep(0.001)
        connection.close()
        server.stop()
        return heard[:2]

    assert asyncio.run(hear()) == ["small", "next"]
    assert skipped == [(b"\x01" * 1000, 300_000), (b"a" * 1000, 180_000)]
    assert bool(parts) == (part < 300_000)


def test_the_traceback_of_an_interrupted_cell_ends_at_its_line() -> None:
    called: list[bool] = []
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        platform_fixes.call_on_interrupt(lambda: called.append(True))
        with pytest.raises(KeyboardInterrupt) as raised:
            signal.raise_signal(signal.SIGINT)
    finally:
        signal.signal(signal.SIGINT, before)
    with without_our_frames(raised.value) as (_, _, of_the_user):
        assert [frame.filename for frame in traceback.extract_tb(of_the_user)] == [__file__]
    assert called == [True]
