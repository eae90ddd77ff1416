"""The list of all topics of a recording or a robot, beside what is shown of them."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import traitlets

from ._core.front_end import FrontEndWidget, bundle
from ._core.platform_fixes import route_by_message
from ._core.traits import Flag

log = logging.getLogger("robowidgets")


class TopicRow(NamedTuple):
    """A topic in the list.

    ``messages`` and ``rate`` are None while they are unknown. ``widget`` is the name of the row that shows it, empty
    without one; ``problem`` says why it cannot be shown, else it is empty.
    """

    name: str
    type: str
    messages: int | None = None
    rate: float | None = None
    widget: str = ""
    problem: str = ""


class TopicsWidget(FrontEndWidget):
    """A list of topics: a click shows one, or takes it off.

    Each row has name, type, rate or count, and its value where that is known. Topics with the same first part of their
    names are groups, which fold; what cannot be read stands last, with the reason. Arrow keys walk, space shows, enter
    goes to the card, `/` searches by name and type. It folds away. None of it but to show and to take off needs the
    kernel, which does both beside a running cell where it hears the page then, else when the cell ends.

    Args:
        on_toggle: called with the name of a topic and whether it is to be shown, perhaps in another thread.
        folded: whether only a rail of it is there; None: as the room allows.
    """

    _esm, _css = bundle("topics_widget")

    folded = Flag(None, allow_none=True, help="Whether it is folded away; None: by the room. The view writes it.").tag(
        sync=True
    )
    _rows = traitlets.List(traitlets.Dict(), help="Name, type, count, rate, widget and problem of each topic.").tag(
        sync=True, echo_update=False
    )
    _shown = traitlets.Dict(help="Names of the topics on show, with the titles of their widgets.").tag(
        sync=True, echo_update=False
    )
    _fixed = Flag(False, help="Whether nothing can be shown or taken off: in a page without a kernel.").tag(sync=True)
    _error = traitlets.Unicode(help="Why a topic could not be shown.").tag(sync=True, echo_update=False)

    def __init__(self, on_toggle: Callable[[str, bool], None] | None = None, **kwargs: Any) -> None:
        self._on_toggle = on_toggle
        super().__init__(**kwargs)
        self.on_msg(self._on_page)
        self.add_class("rw-topics-cell")

    def open(self) -> None:
        """Connect to the page."""
        super().open()
        route_by_message(self.comm)

    def set_rows(self, rows: Iterable[TopicRow]) -> None:
        """List topics."""
        self._rows = [row._asdict() for row in rows]

    def show(self, shown: Mapping[str, Sequence[str]]) -> None:
        """Mark the topics on show, with the titles of their widgets."""
        self._shown = {name: [*titles] for name, titles in shown.items()}

    def close(self) -> None:
        """Remove it from the page."""
        self._on_toggle = None
        super().close()

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        """Show a topic or take it off. In the main thread or a subshell's."""
        name = content.get("toggle") if isinstance(content, dict) else None
        if not isinstance(name, str) or self._on_toggle is None:
            return
        try:
            self._on_toggle(name, bool(content.get("on")))
        except Exception as error:
            log.exception("robowidgets: %s could not be shown", name)
            self._error = f"{name}: {error}"
        else:
            self._error = ""
        self.send({"done": name})
