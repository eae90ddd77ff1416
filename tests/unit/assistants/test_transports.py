"""The server over stdio and HTTP, by the client of the SDK, and what may go wrong with a client."""

from __future__ import annotations

import json
import subprocess
import sys
import urllib.error
import urllib.request
from collections.abc import Iterator
from typing import Any

import anyio
import pytest

import robowidgets
from robowidgets.assistants import code
from robowidgets.assistants.answer import AnswerError
from robowidgets.command import main

from ..feeds.bridge import Rosbridge
from ..waiting import wait_for
from .asking import run

pytest.importorskip("mcp")
FOLDER = str(robowidgets.SAMPLE.parent)


def command(*arguments: str) -> list[str]:
    return [sys.executable, "-m", "robowidgets", "mcp", *arguments]


def stdio(*arguments: str) -> Any:
    """A client of a server in a process of its own."""
    from mcp import Client, StdioServerParameters
    from mcp.client.stdio import stdio_client

    program, *rest = command(*arguments)
    return Client(stdio_client(StdioServerParameters(command=program, args=rest)))


def http_tools(url: str, token: str, tool: str, **arguments: Any) -> Any:
    """Call a tool over HTTP."""
    import httpx2
    from mcp import Client
    from mcp.client.streamable_http import streamable_http_client

    async def call() -> Any:
        headers = {"Authorization": f"Bearer {token}"}
        async with (
            httpx2.AsyncClient(headers=headers) as http,
            Client(streamable_http_client(url, http_client=http)) as client,
        ):
            return await client.call_tool(tool, arguments)

    return run(call)


@pytest.mark.slow
def test_over_stdio_a_client_lists_and_calls_tools_and_can_cancel_one() -> None:
    async def talk() -> None:
        async with stdio(FOLDER, "--code") as client:
            tools = [tool.name for tool in (await client.list_tools()).tools]
            assert tools[-2:] == ["lines", "simulate"]
            with anyio.move_on_after(0.5) as cancelled:
                await client.call_tool("simulate", {"source": "import time\ntime.sleep(600)\ndef f(): pass"})
            assert cancelled.cancelled_caught
            answer = await client.call_tool("info", {"recording": "sample.mcap"})
            assert answer.structured_content["seconds"] == 58.0
            source = "def near(scan):\n    away = scan.distance('front')\n    return away < 1.0\n"
            lines = await client.call_tool("lines", {"recording": "sample.mcap", "seconds": 3.0, "source": source})
            assert "away < 1.0" in lines.structured_content["lines"]["text"]
            assert "0.77 m" in lines.structured_content["lines"]["text"]

    run(talk)


@pytest.mark.slow
def test_a_client_that_hangs_or_dies_leaves_a_robot_that_stands() -> None:
    with Rosbridge({"/cmd_vel": "geometry_msgs/msg/Twist"}) as bridge:
        bridge.listeners["/cmd_vel"] = ["/base"]
        said = command("--feed", "rosbridge", bridge.address, "--drive", "--lease", "1")
        with subprocess.Popen(said, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdin
            assert process.stdout

            def send(number: int | None, method: str, **params: Any) -> None:
                message = {"jsonrpc": "2.0", "method": method, "params": params} | (
                    {} if number is None else {"id": number}
                )
                process.stdin.write(json.dumps(message) + "\n")  # type: ignore[union-attr]
                process.stdin.flush()  # type: ignore[union-attr]

            send(
                1, "initialize", protocolVersion="2025-06-18", capabilities={}, clientInfo={"name": "t", "version": "1"}
            )
            assert json.loads(process.stdout.readline())["id"] == 1
            send(None, "notifications/initialized")
            send(2, "tools/call", name="robot_drive", arguments={"linear": 0.1, "angular": 0.0, "seconds": 1.0})
            answer = json.loads(process.stdout.readline())
            assert answer["result"]["structuredContent"]["sent"]["linear_m_s"] == 0.1, answer
            # From here on the client neither reads nor writes.
            speeds = lambda: [message["linear"]["x"] for _, message in bridge.published]  # noqa: E731
            wait_for(lambda: 0.1 in speeds() and speeds()[-1] == 0.0, "zero follows the lease")
            before = len(speeds())
            send(3, "tools/call", name="robot_drive", arguments={"linear": 0.1, "angular": 0.0, "seconds": 1.0})
            wait_for(lambda: 0.1 in speeds()[before:], "it drives again")
            process.kill()
            wait_for(lambda: speeds()[-1] == 0.0, "zero follows the end of the server")


@pytest.fixture
def served() -> Iterator[Any]:
    with robowidgets.assistant(recordings=robowidgets.SAMPLE) as made:
        yield made


def status_of(url: str, **headers: str) -> int:
    body = json.dumps({"jsonrpc": "2.0", "id": 1, "method": "tools/list", "params": {}}).encode()
    known = {"Content-Type": "application/json", "Accept": "application/json, text/event-stream"}
    request = urllib.request.Request(url, body, {**known, **headers})
    try:
        with urllib.request.urlopen(request) as answer:
            return int(answer.status)
    except urllib.error.HTTPError as error:
        return error.code


def test_over_http_a_client_needs_the_token(served: Any) -> None:
    answer = http_tools(served.url, served.token, "info", recording="sample.mcap")
    assert answer.structured_content["seconds"] == 58.0
    assert status_of(served.url) == 401
    assert status_of(served.url, Authorization="Bearer wrong") == 401
    assert status_of(served.url, Authorization=f"Basic {served.token}") == 401
    assert len(served.token) > 30


def test_a_page_of_another_site_is_refused_even_with_the_token(served: Any) -> None:
    token = {"Authorization": f"Bearer {served.token}"}
    assert status_of(served.url, **token, Host="evil.example") == 421
    assert status_of(served.url, **token, Origin="http://evil.example") == 403


def test_code_that_does_not_return_is_killed_and_an_error_of_it_is_told() -> None:
    async def tell(source: str, seconds: float) -> None:
        job = {"do": "simulate", "source": source, "function": None, "duration": 1.0, "seed": 1, "room": "house"}
        await code.run(job | {"rate": 10.0}, seconds)

    with pytest.raises(AnswerError, match=r"the code did not return within 0.2 s, and its process was killed"):
        run(lambda: tell("while True: pass", 0.2))
    with pytest.raises(AnswerError, match="ZeroDivisionError: division by zero"):
        run(lambda: tell("print('noise')\n1 / 0", 60.0))


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ([], "mcp: expected recordings or folders of them, or --feed, or --code"),
        ([FOLDER, "--drive"], "mcp: --drive needs --feed, the robot to drive"),
        ([FOLDER, "--max-linear", "1"], "mcp: limits need --drive, which is missing"),
        (["--feed", "nonsense"], "mcp: --feed: expected one of simulator, foxglove"),
        (["--feed", "dds", "x"], "mcp: --feed dds: expected the number of a domain, got 'x'"),
        (
            ["--feed", "simulator", "x", "y"],
            "mcp: --feed simulator: expected nothing after it, got x y; recordings come before --feed",
        ),
        ([FOLDER, "--http", "99999"], "mcp: --http: port: expected 0 to 65535, where 0 is any free one, got 99999"),
        (["--feed", "simulator", "--drive", "--lease", "99"], "mcp: lease: expected at most 30 s, got 99.0"),
        (["no/such/folder"], "no/such/folder: expected a recording, or a folder of recordings; it does not exist"),
    ],
)
def test_bad_arguments_of_the_command_get_one_line(
    arguments: list[str], text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["mcp", *arguments]) == 2
    said = capsys.readouterr()
    assert (said.out, said.err.count("\n"), text in said.err) == ("", 1, True), said.err


def test_without_the_sdk_the_command_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in [name for name in sys.modules if name.startswith("robowidgets.assistants.server") or name == "uvicorn"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.delitem(sys.modules, "robowidgets.assistants.http", raising=False)
    monkeypatch.setitem(sys.modules, "uvicorn", None)
    monkeypatch.setitem(sys.modules, "mcp", None)
    assert main(["mcp", FOLDER]) == 2
    assert 'pip install "robowidgets[mcp]"' in capsys.readouterr().err


def test_the_package_and_its_command_import_no_sdk() -> None:
    script = (
        "import sys, robowidgets, robowidgets.command; robowidgets.assistant; "
        "print([name for name in sys.modules if name.split('.')[0] in ('mcp', 'mcp_types', 'pydantic', 'uvicorn')])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
