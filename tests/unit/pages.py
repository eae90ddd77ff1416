"""A page without a browser: it receives the messages of a widget, as JupyterLab would."""

from __future__ import annotations

import json
import logging
import threading
import weakref
from collections.abc import Callable
from typing import Any

from IPython.core.formatters import DisplayFormatter
from ipywidgets import Widget
from ipywidgets.widgets.widget import _put_buffers
from traitlets.log import get_logger

from robowidgets.screen_widget import ScreenWidget
from robowidgets.widget.newest_sample import NewestSample
from robowidgets.widget.observed import Observed


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
        self._widget = weakref.ref(widget)
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

    def handle_msg(self, message: dict[str, Any]) -> None:
        """Give the widget a message."""
        if widget := self._widget():
            widget._handle_msg(message)

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


def display(value: object) -> dict[str, Any]:
    """Return what Jupyter displays for a value, by media type."""
    data, _ = DisplayFormatter().format(value)
    return dict(data)


def display_html(value: object) -> str:
    """Return the HTML that Jupyter displays for a value."""
    return str(display(value)["text/html"])


def from_page(widget: Any, content: Any) -> None:
    """Give a widget a message of the page; fail if the widget raises an error, which ipywidgets only logs."""
    handler, records = logging.Handler(), list[logging.LogRecord]()
    handler.emit = records.append  # type: ignore[method-assign]
    log = get_logger()
    log.addHandler(handler)
    try:
        widget.comm.handle_msg({"content": {"data": {"method": "custom", "content": content}}, "buffers": []})
    finally:
        log.removeHandler(handler)
    for record in records:
        if record.exc_info and record.exc_info[1]:
            raise record.exc_info[1]


def synced(widget: Any, name: str) -> Any:
    """Return a trait as the page has it."""
    return widget.get_state(name)[name]


def get_newest(widget: Any) -> NewestSample[Any]:
    """Return the newest sample of a widget with its texts, sent or not."""
    newest: NewestSample[Any] = widget._newest
    return newest


def parse_sample(widget: Any, frame: bytes, *about: Any) -> Any:
    """Return the sample that a widget reads from a frame for the page."""
    return widget._unpack(frame, *about)


def get_observers(observed: Observed) -> list[Callable[[], None]]:
    """Return the functions that an object calls on its changes, such as functions of its widgets."""
    return observed._observers


def get_edition(widget: Any) -> int:
    """Return the number of changes after which a player sends the frames of a widget again."""
    edition: int = widget._edition
    return edition
