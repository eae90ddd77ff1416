"""The front end of a widget: its script and stylesheet, and how they reach the page."""

from __future__ import annotations

import functools
import os
from pathlib import Path
from typing import Any

import anywidget
import traitlets

from ..runtime.platform_fixes import share_class
from ..runtime.text import nearest_name

STATIC = Path(__file__).parents[1] / "static"

THEMES = ("auto", "light", "dark", "projector", "paper")
_themes = {"default": "auto"}


def set_theme(theme: str) -> None:
    """Set the theme of all widgets that are made after this call; `theme` of a widget or screen changes it alone.

    Args:
        theme: ``"projector"``: half as large again, for the back row. ``"paper"``: black on white, areas as outlines.
            ``"light"`` or ``"dark"``. ``"auto"``: light or dark as the notebook.

    Raises:
        ValueError: not one of these.

    Examples:
        >>> import robowidgets
        >>> robowidgets.set_theme("projector")
        >>> robowidgets.LaserWidget().theme
        'projector'
        >>> robowidgets.set_theme("auto")
    """
    if theme not in THEMES:
        near = nearest_name(theme, THEMES) if isinstance(theme, str) else None
        hint = f"; did you mean {near!r}?" if near else ""
        raise ValueError(f"set_theme: expected one of {', '.join(THEMES)}, got {theme!r}{hint}")
    _themes["default"] = theme


class Script(str):
    """A script that `bundle` read: each page runs it once, for all of its widgets."""

    __slots__ = ("name",)

    name: str


def bundle(name: str, folder: Path | None = None) -> tuple[Any, Any]:
    """Return the built script and stylesheet of a widget by its name, such as "laser_widget".

    Returns:
        Their texts or, for hot reload, their paths if ROBOWIDGETS_DEV is set.

    Raises:
        ImportError: a file is missing.
    """
    script, style = (built_file((folder or STATIC) / f"{name}.{kind}") for kind in ("js", "css"))
    if os.environ.get("ROBOWIDGETS_DEV"):
        return script, style
    read = Script(script.read_text(encoding="utf-8"))
    read.name = name
    return read, style.read_text(encoding="utf-8")


def built_file(path: Path) -> Path:
    """Return the path of a file of the front end, or raise ImportError with how to build a missing one."""
    if not path.is_file():
        if path.parent != STATIC:
            raise ImportError(f"{path} is missing: `node build.mjs` in robowidgets/js builds it")
        raise ImportError(
            f"robowidgets was installed without its front end ({path.name} is missing); "
            "in a checkout run `make build`, else install it again"
        )
    return path


@functools.cache
def _run_once() -> str:
    return built_file(STATIC / "run_once.js").read_text(encoding="utf-8")


@functools.cache
def _later() -> str:
    return built_file(STATIC / "later.js").read_text(encoding="utf-8")


def owner_of_script(widget: Any) -> type:
    """Return the class that names the script of a widget."""
    return next(c for c in type(widget).__mro__ if isinstance(vars(c).get("_esm"), (str, Path)))


def kind_of(widget: Any) -> str:
    """Return the name of a widget's script without "_widget", such as "laser"."""
    script = vars(owner_of_script(widget))["_esm"]
    name = script.name if isinstance(script, Script) else getattr(script, "stem", "")
    return name.removesuffix("_widget")


_with_front_end: dict[type, type] = {}
"""The subclass of each widget class that has the front end as traits."""


class FrontEndWidget(anywidget.AnyWidget):
    """A widget whose script and stylesheet a page keeps once, for all of its kind."""

    theme = traitlets.Enum(
        THEMES, help='"auto", "light", "dark", "projector" or "paper". The theme of the screen around it comes first.'
    ).tag(sync=True)

    @traitlets.default("theme")
    def _default_theme(self) -> str:
        return _themes["default"]

    def add_traits(self, **traits: Any) -> None:
        """Give the widget the front end as traits, as anywidget does, but make the class only once.

        The page keeps the script that Jupyter runs for each widget. So this is a small script, which runs the script of
        the widget's class once.
        """
        plain = type(self)
        known = _with_front_end.get(plain)
        if known is not None and traits.keys() <= vars(known).keys() and share_class(self, known):
            return
        if "_esm" in traits:
            texts = {"_style": getattr(plain, "_css", "")}
            if isinstance(plain._esm, Script):
                texts |= {"_script": plain._esm, "_esm": _run_once(), "_css": ""}
            traits |= {name: traitlets.Unicode(str(text)).tag(sync=True) for name, text in texts.items()}
        super().add_traits(**traits)
        if isinstance(getattr(plain, "_esm", None), str):  # with hot reload the class differs from widget to widget
            _with_front_end[plain] = type(self)

    def _handle_custom_msg(self, content: Any, buffers: Any) -> None:
        """Pass a message of the page on, or answer its request for the script that it needs later."""
        if content == {"later": True}:
            self.send({"later": _later()})
        else:
            super()._handle_custom_msg(content, buffers)
