"""Detecting a foxglove server or a rosbridge at an address, in case the user has confused the two."""

from __future__ import annotations

import asyncio
import json
from contextlib import suppress
from typing import Any

from ..runtime.platform_fixes import close_when_connected

FOXGLOVE = ["foxglove.sdk.v1", "foxglove.websocket.v1"]
"""The names of the foxglove protocol."""

ANSWER_TIMEOUT_S = 1.0
"""Seconds to wait for an answer."""

_GOODBYE = 0.5


async def is_foxglove(address: str) -> bool:
    """Return True if a foxglove server listens at an address."""
    with suppress(Exception):  # any error of tornado or of the server
        return await asyncio.wait_for(_knows_foxglove(address), ANSWER_TIMEOUT_S)
    return False


async def is_rosbridge(address: str) -> bool:
    """Return True if a rosbridge listens at an address."""
    with suppress(Exception):
        return await asyncio.wait_for(_answers_as_rosbridge(address), ANSWER_TIMEOUT_S)
    return False


async def _knows_foxglove(address: str) -> bool:
    connection = await _connected(address, FOXGLOVE)
    try:
        return connection.selected_subprotocol in FOXGLOVE
    finally:
        connection.close()


async def _answers_as_rosbridge(address: str) -> bool:
    connection = await _connected(address, None)
    try:
        # A rosbridge answers even if rosapi is not running.
        service = "/rosapi/topics"
        asked = {"op": "call_service", "service": service, "id": "who", "args": {}}
        await connection.write_message(json.dumps(asked))
        answer = json.loads(await connection.read_message())
        return (answer["op"], answer["service"]) == ("service_response", service)
    finally:
        connection.close()


async def _connected(address: str, subprotocols: list[str] | None) -> Any:
    from tornado.websocket import websocket_connect

    connecting = asyncio.ensure_future(websocket_connect(address, subprotocols=subprotocols))
    try:
        return await asyncio.shield(connecting)
    except asyncio.CancelledError:
        await close_when_connected(connecting, _GOODBYE)
        raise
