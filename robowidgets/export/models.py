"""The states of the widgets on a page, and their scripts."""

from __future__ import annotations

from collections.abc import Mapping
from re import search
from typing import Any

from ..widget.front_end import bundle, owner_of_script
from .html import PageAssets, inlined, static
from .segments import compressed

_BUILT_IN = (
    "laser_widget",
    "path_widget",
    "player_widget",
    "scanogram_widget",
    "screen_widget",
    "speed_widget",
    "touch_widget",
)
"""The widgets in the script of each page."""

_OF_HOST = ("layout", "tabbable", "tooltip", "_anywidget_id", "_css", "_esm", "_script", "_style")


class Models:
    """Widgets that a page shows: their states, and their scripts."""

    def __init__(self) -> None:
        self._models: list[dict[str, Any]] = []
        self._buffers: list[tuple[str, str, bytes]] = []
        self._foreign: dict[str, tuple[str, str]] = {}
        self._keys: dict[str, str] = {}

    def add(self, widget: Any, changes: Mapping[str, Any]) -> None:
        """Add a widget in its current state, except for some traits.

        Raises:
            ValueError: its script cannot be put into a page.
        """
        state = {name: value for name, value in widget.get_state().items() if name not in _OF_HOST}
        state |= changes
        binary = {name for name, value in state.items() if isinstance(value, (bytes, memoryview))}
        ours = {name: value for name, value in state.items() if not name.startswith(("_model_", "_view_"))}
        plain = {name: value for name, value in ours.items() if name not in binary}
        self._models.append({"id": widget.model_id, "widget": self._script_of(widget), "state": plain})
        self._buffers += [(widget.model_id, name, bytes(state[name])) for name in sorted(binary)]

    def part(self, root: str, **facts: Any) -> bytes:
        """Return the part of the page with all models, the id of the model to show, and more facts."""
        buffers = [[model, name, len(value)] for model, name, value in self._buffers]
        texts = {"models": self._models, "buffers": buffers, "root": root, "keys": self._keys}
        return compressed({**texts, **facts}, [value for _, _, value in self._buffers])

    def assets(self) -> PageAssets:
        """Return the scripts and stylesheets of these widgets."""
        styles = [static("export_page.css"), *(css for _, css in self._foreign.values() if css)]
        # The script that builds the page comes last, because it needs the others.
        scripts = [*(script for script, _ in self._foreign.values()), static("export_page.js")]
        return PageAssets(tuple(styles), tuple(scripts))

    def _script_of(self, widget: Any) -> str:
        """Return the name of the widget's script, and include the script if it is not in each page."""
        owner = owner_of_script(widget)
        name = owner.__module__.rpartition(".")[2]
        if name in _BUILT_IN and vars(owner)["_esm"] == bundle(name)[0]:
            return name
        script = str(vars(owner)["_esm"])
        key = search(r'export default globalThis\[Symbol\.for\("(robowidgets \w+)"\)\]', script)
        if key is None:
            raise ValueError(
                f"{type(widget).__name__}: its script is not one that robowidgets/js/build.mjs builds, so it cannot be "
                "put into a page; leave its topic out"
            )
        self._keys[name] = key[1]
        self._foreign[name] = inlined(script, name), inlined(str(getattr(owner, "_css", "")), name)
        return name
