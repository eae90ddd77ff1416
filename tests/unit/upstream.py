"""Upstream faults without our fixes: each function returns True if the installed versions have the fault."""

from __future__ import annotations

import asyncio
import bz2
import functools
import gc
import io
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable
from contextlib import redirect_stdout
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import anywidget
import traitlets

from .waiting import wait_for


def printed_by(program: str, *, code: int = 0) -> str:
    """Run a program in a Python of its own, and return its output; fail unless it ends with this code."""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False, timeout=240)
    assert done.returncode == code, done.stderr
    return done.stdout.strip()


def a_thread_waits_long_for_the_gil() -> bool:
    is_there = "getattr(sys, '_is_gil_enabled', lambda: True)()"
    return printed_by(f"import sys; print({is_there} and sys.getswitchinterval() >= 0.005)") == "True"


SERVER = """
import asyncio, json, socket, sys, tempfile
sys.modules["rfc3987_syntax"] = None  # of jsonschema, for a format that nothing here has: half of the start
from jupyter_server.serverapp import ServerApp
from jupyter_server.services.kernels.websocket import KernelWebsocketHandler
from tornado.httpclient import AsyncHTTPClient
from tornado.ioloop import IOLoop
from tornado.websocket import websocket_connect

told, opened = asyncio.Event(), KernelWebsocketHandler.open
async def open_and_tell(self, kernel_id):
    await opened(self, kernel_id)
    stream = self.ws_connection.stream
    print("nodelay", stream.socket.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY), flush=True)
    told.set()
KernelWebsocketHandler.open = open_and_tell

folder = tempfile.mkdtemp()
app = ServerApp.instance()
options = ["open_browser=False", "token=", "disable_check_xsrf=True", "allow_root=True", f"root_dir={folder}", "port=0"]
app.initialize([f"--ServerApp.{option}" for option in options], find_extensions=False)

async def connect():
    try:
        made = await AsyncHTTPClient().fetch(f"{app.local_url}api/kernels", method="POST", body="{}")
        kernel = json.loads(made.body)["id"]
        connection = await websocket_connect(f"ws{app.local_url[4:]}api/kernels/{kernel}/channels")
        await told.wait()
        connection.close()
        await app.kernel_manager.shutdown_all()
    finally:
        app.stop()
IOLoop.current().add_callback(connect)
app.start()
"""


def the_server_of_jupyter_leaves_nagle_on() -> bool:
    *_, told = [line for line in printed_by(SERVER).splitlines() if line.startswith("nodelay")]
    return told == "nodelay 0"


KERNEL = """
import json, signal, threading
from comm import create_comm
kernel = get_ipython().kernel
shown = create_comm(target_name="nothing")
shown.send({})
route = getattr(shown, "_reply_subshell_for", None)
print(json.dumps({
    "route": route is not None and route({"method": "custom"}, "subshell") != "subshell",
    "idle": kernel.saved_sigint_handler is signal.SIG_IGN,
}))
own = lambda number, frame: None
signal.signal(signal.SIGINT, own)
"""


@functools.cache
def of_a_kernel() -> dict[str, bool]:
    from jupyter_client.manager import start_new_kernel

    manager, client = start_new_kernel()
    try:
        printed: list[str] = []

        def keep(message: dict[str, Any]) -> None:
            printed.append(message["content"].get("text", ""))

        for cell in (KERNEL, "print(json.dumps({'anew': signal.getsignal(signal.SIGINT) is not own}))"):
            client.execute_interactive(cell, output_hook=keep, timeout=240)
        found: dict[str, bool] = {}
        for line in "".join(printed).splitlines():
            found |= json.loads(line)
        return found
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)


SHELL = """
import json, types
from IPython.core.events import available_events
from IPython.core.interactiveshell import InteractiveShell
from IPython.utils.capture import capture_output

shell, happened = InteractiveShell.instance(), []
for name in available_events:
    if name.startswith("post"):
        shell.events.register(name, lambda *result, name=name: happened.append((name, *(r.success for r in result))))
show = shell.showtraceback
shell.showtraceback = lambda *args, **options: (happened.append("traceback"), show(*args, **options))
library = types.ModuleType("library")
exec("def check(value):\\n    __tracebackhide__ = True\\n    raise TypeError(value)", vars(library))
shell.push({"library": library})
with capture_output() as output:
    shell.run_cell("try: raise KeyboardInterrupt\\nexcept KeyboardInterrupt: pass")
    after_interrupt, happened[:] = list(happened), []
    shell.run_cell("1 / 0")
    after_error, happened[:] = list(happened), []
    shell.run_cell("library.check(5)")
print(json.dumps({
    "interrupt": after_interrupt == [("post_execute",), ("post_run_cell", True)],
    "traceback": after_error == ["traceback", ("post_execute",), ("post_run_cell", False)],
    "frames": "<string>:3" in output.stdout,
}))
"""


@functools.cache
def of_a_shell() -> dict[str, bool]:
    found: dict[str, bool] = json.loads(printed_by(SHELL))
    return found


def a_signal_ends_python_without_its_exit_handlers() -> bool:
    end = "import atexit, os, signal; atexit.register(print, 'the end'); os.kill(os.getpid(), signal.SIGTERM)"
    return printed_by(end, code=-15) == ""


def a_kernel_without_its_server_ends_without_exit_handlers() -> bool:
    program = """
import atexit, os
from types import SimpleNamespace
from ipykernel import parentpoller
atexit.register(print, "the end")
parentpoller.os = SimpleNamespace(getppid=lambda: 1, _exit=os._exit)
parentpoller.ParentPollerUnix().run()
"""
    return printed_by(program, code=1) == ""


def a_thread_that_prints_may_follow_a_circle() -> bool:
    from ipykernel.iostream import OutStream

    class Followed(dict[int, int]):
        def __getitem__(self, thread: int) -> int:
            self.steps = getattr(self, "steps", 0) + 1
            if self.steps > 100:
                raise EndlessError
            return super().__getitem__(thread)

    class EndlessError(Exception):
        pass

    found = []

    def look() -> None:
        stream = OutStream.__new__(OutStream)
        stream._parent_header, stream._parent_header_global = ContextVar("header"), {}
        stream._thread_to_parent_header = {}
        this = threading.get_ident()
        stream._thread_to_parent = Followed({this: this})
        try:
            found.append(bool(stream.parent_header))
        except EndlessError:
            found.append(True)

    thread = threading.Thread(target=look)
    thread.start()
    thread.join()
    return found == [True]


BREAKPOINT = """
import threading, time
def count(name):
    with open({folder!r} + "/" + name, "a", buffering=1) as file:
        while True:
            print(file=file)
            time.sleep(0.005)
for name in ("marked", "plain"):
    thread = threading.Thread(target=count, args=(name,), daemon=True)
    if name == "marked":
        thread.pydev_do_not_trace = thread.is_pydev_daemon_thread = True
    thread.start()
"""


def a_breakpoint_holds_all_threads() -> bool:
    from jupyter_client.manager import start_new_kernel

    manager, client = start_new_kernel()
    folder = Path(tempfile.mkdtemp())

    def debug(command: str, **arguments: Any) -> dict[str, Any]:
        request = client.session.msg("debug_request", {"type": "request", "command": command, "seq": 1})
        request["content"]["arguments"] = arguments
        client.control_channel.send(request)
        reply: dict[str, Any] = client.get_control_msg(timeout=240)["content"]
        assert reply["success"], reply
        return dict(reply.get("body", {}))

    def counted(name: str) -> int:
        return (folder / name).stat().st_size if (folder / name).exists() else 0

    def go_on() -> int:
        before = counted("marked")
        wait_for(lambda: counted("marked") > before + 20, "the marked thread runs on")
        return counted("plain")

    try:
        code = "held = 1\nheld = 2\n"
        debug("initialize", adapterID="", pathFormat="path", linesStartAt1=True)
        debug("attach")
        source = {"path": debug("dumpCell", code=code)["sourcePath"]}
        debug("setBreakpoints", source=source, breakpoints=[{"line": 2}])
        debug("configurationDone")
        client.execute_interactive(BREAKPOINT.format(folder=str(folder)), timeout=240)
        wait_for(lambda: counted("plain") > 20, "both threads run")
        client.execute(code)
        stopped: list[str] = []

        def is_stopped() -> bool:
            message = client.get_iopub_msg(timeout=240)
            stopped.append(message["content"].get("event", ""))
            return "stopped" in stopped

        wait_for(is_stopped, "the breakpoint holds the cell")
        go_on()
        return go_on() == go_on()
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)
        shutil.rmtree(folder)


def the_server_of_foxglove_leaves_nagle_on() -> bool:
    import foxglove

    server = foxglove.start_server(host="127.0.0.1", port=0, context=foxglove.Context())
    try:
        with socket.create_connection(("127.0.0.1", server.port), 10) as client:
            client.sendall(
                b"GET / HTTP/1.1\r\nHost: here\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
                b"Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n"
            )
            assert b"101" in client.recv(1000)
            return [
                own.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
                for own in own_sockets()
                if peer_of(own) == client.getsockname()
            ] == [0]
    finally:
        server.stop()


def own_sockets() -> list[socket.socket]:
    """The sockets of this process, including sockets of libraries outside Python."""
    links = [link for link in Path("/proc/self/fd").iterdir() if link.is_symlink()]
    return [socket.socket(fileno=os.dup(int(link.name))) for link in links if link.is_socket()]


def peer_of(sock: socket.socket) -> Any:
    try:
        return sock.getpeername()
    except OSError:  # it listens, or its other side has gone
        return None


def tornado_ends_a_connection_at_a_large_message_without_naming_it() -> bool:
    from tornado.httpserver import HTTPServer
    from tornado.testing import bind_unused_port
    from tornado.web import Application
    from tornado.websocket import WebSocketHandler, websocket_connect

    class Large(WebSocketHandler):
        def open(self, *_: str, **__: str) -> None:
            self.write_message("more than the other side takes")

    async def connect() -> bool:
        listening, port = bind_unused_port()
        server = HTTPServer(Application([("/", Large)]))
        server.add_socket(listening)
        connection = await websocket_connect(f"ws://127.0.0.1:{port}/", max_message_size=10)
        ended = await asyncio.wait_for(connection.read_message(), 240)
        server.stop()
        return (ended, connection.close_code) == (None, None)

    return asyncio.run(connect())


def tornado_leaves_a_cancelled_connection_open() -> bool:
    from tornado.iostream import IOStream
    from tornado.websocket import websocket_connect

    async def cancel() -> bool:
        accepted: asyncio.Queue[asyncio.StreamWriter] = asyncio.Queue()

        async def take(_reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            accepted.put_nowait(writer)

        server = await asyncio.start_server(take, "127.0.0.1", 0)
        connecting = asyncio.ensure_future(
            websocket_connect(f"ws://127.0.0.1:{server.sockets[0].getsockname()[1]}/")  # type: ignore[arg-type]
        )
        writer = await asyncio.wait_for(accepted.get(), 240)
        here = writer.get_extra_info("peername")
        connecting.cancel()
        await asyncio.wait([connecting])
        streams = [one for one in gc.get_objects() if type(one) is IOStream and not one.closed()]
        left = [stream for stream in streams if stream.socket.getsockname() == here]
        for stream in left:
            stream.close()
        writer.close()
        server.close()
        return bool(left)

    return asyncio.run(cancel())


def rosbags_decompresses_without_a_limit() -> bool:
    bomb = bz2.compress(bytes(20_000_000))
    assert len(bomb) < 1000
    program = f"from rosbags.rosbag1.reader import decompressors; print(len(decompressors['bz2']({bomb!r})))"
    return printed_by(program) == "20000000"


def python_has_one_output_for_all_threads() -> bool:
    with redirect_stdout(io.StringIO()) as output:
        thread = threading.Thread(target=sys.stdout.write, args=("from another thread",))
        thread.start()
        thread.join()
    return output.getvalue() == "from another thread"


def traitlets_makes_a_class_for_each_instance() -> bool:
    class Plain(traitlets.HasTraits):
        pass

    one, other = Plain(), Plain()
    for instance in (one, other):
        instance.add_traits(number=traitlets.Int(1))
    return type(one) is not type(other)


def anywidget_adds_traits_to_each_widget() -> bool:
    class Plain(anywidget.AnyWidget):
        _esm = "export default {}"

    one, other = Plain(), Plain()
    is_so = type(one) is not type(other)
    one.close()
    other.close()
    return is_so


GOES_WRONG: dict[tuple[str, str], Callable[[], bool]] = {
    ("shorten_switch_interval", "Python"): a_thread_waits_long_for_the_gil,
    ("call_before_end", "Python"): a_signal_ends_python_without_its_exit_handlers,
    ("let_threads_print", "ipykernel"): a_thread_that_prints_may_follow_a_circle,
    ("acknowledge_at_once", "foxglove-sdk"): the_server_of_foxglove_leaves_nagle_on,
    ("skip_large_messages", "tornado"): tornado_ends_a_connection_at_a_large_message_without_naming_it,
    ("close_when_connected", "tornado"): tornado_leaves_a_cancelled_connection_open,
    ("capture_prints", "Python"): python_has_one_output_for_all_threads,
    ("share_class", "traitlets"): traitlets_makes_a_class_for_each_instance,
    ("share_class", "anywidget"): anywidget_adds_traits_to_each_widget,
}
"""By the name of a fix and of the faulty project."""

GOES_WRONG_SLOWLY: dict[tuple[str, str], Callable[[], bool]] = {
    ("message_padding", "jupyter_server"): the_server_of_jupyter_leaves_nagle_on,
    ("run_beside_debugger", "debugpy"): a_breakpoint_holds_all_threads,
    ("route_by_message", "ipykernel"): lambda: of_a_kernel()["route"],
    ("call_on_interrupt", "ipykernel"): lambda: of_a_kernel()["anew"],
    ("call_on_idle_interrupt", "ipykernel"): lambda: of_a_kernel()["idle"],
    ("call_before_end", "ipykernel"): a_kernel_without_its_server_ends_without_exit_handlers,
    ("call_on_interrupt", "ipython"): lambda: of_a_shell()["interrupt"],
    ("call_before_traceback", "ipython"): lambda: of_a_shell()["traceback"],
    ("change_tracebacks", "ipython"): lambda: of_a_shell()["frames"],
    ("bound_decompression", "rosbags"): rosbags_decompresses_without_a_limit,
}
"""Functions that take more than a second."""
