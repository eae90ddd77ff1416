"""Questions to a server, by the client of the SDK."""

from __future__ import annotations

import json
from collections.abc import Awaitable, Callable
from typing import Any, TypeVar

import anyio

T = TypeVar("T")


def run(question: Callable[[], Awaitable[T]]) -> T:
    """Run a coroutine function to its end."""
    return anyio.run(question)


def ask(server: Any, tool: str, **arguments: Any) -> Any:
    """The structured answer of a tool of a server in this process; AssertionError with its text if it is an error."""
    made = result(server, tool, **arguments)
    assert not made.is_error, made.content[0].text
    json.dumps(made.structured_content, allow_nan=False)
    return made.structured_content


def refusal(server: Any, tool: str, **arguments: Any) -> str:
    """The text with which a tool refuses."""
    made = result(server, tool, **arguments)
    assert made.is_error, made
    return str(made.content[0].text).removeprefix(f"Error executing tool {tool}: ")


def result(server: Any, tool: str, **arguments: Any) -> Any:
    from mcp import Client

    async def call() -> Any:
        async with Client(server) as client:
            return await client.call_tool(tool, arguments)

    return run(call)
