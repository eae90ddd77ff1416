"""A page without a browser: it receives the messages of a widget, as JupyterLab would."""

from __future__ import annotations

import json
import threading
from typing import Any

from ipywidgets import Widget
from ipywidgets.widgets.widget import _put_buffers

from robowidgets.screen_widget import ScreenWidget


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


def widgets_by_place(screen: ScreenWidget) -> dict[str, list[str]]:
    """Return the classes of the widgets on a screen, by place, as the page gets them."""
    classes = {f"anywidget:{widget.model_id}": type(widget).__name__ for widget in screen.children}
    found: dict[str, list[str]] = {}
    for room in screen.get_state()["_children"]:
        found.setdefault(room["place"], []).append(classes[room["widget"]])
    return found
