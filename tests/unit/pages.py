"""A page without a browser: it receives the messages of a widget, as JupyterLab would."""

from __future__ import annotations

import json
import threading
from typing import Any

from ipywidgets import Widget
from ipywidgets.widgets.widget import _put_buffers


class Page:
    """Stands in for a widget's comm, and keeps the messages and the resulting state."""

    def __init__(self, widget: Widget) -> None:
        self.state: dict[str, Any] = widget.get_state()
        self.messages: list[dict[str, Any]] = []
        self.customs: list[Any] = []
        self.history: list[dict[str, Any]] = []
        self.threads: list[str] = []
        self.sizes: list[int] = []
        self.comm_id = widget.comm.comm_id
        widget.comm.close()
        widget.comm = self

    def send(self, data: dict[str, Any], buffers: list[Any] | None = None) -> None:
        if data.get("method") == "custom":
            self.customs.append(data["content"])
            return
        self.sizes.append(len(json.dumps(data)) + sum(len(b) for b in buffers or ()))
        _put_buffers(data["state"], data["buffer_paths"], [bytes(b) for b in buffers or ()])
        self.messages.append(data["state"])
        self.state = {**self.state, **data["state"]}
        self.history.append(self.state)
        self.threads.append(threading.current_thread().name)

    def sent(self, name: str) -> list[Any]:
        """Every received value of a trait, in order."""
        return [message[name] for message in self.messages if name in message]

    def on_msg(self, callback: object) -> None:
        pass

    def close(self) -> None:
        pass
