"""The console messages and the web requests of a page."""

from __future__ import annotations

from urllib.parse import urlsplit

from playwright.sync_api import ConsoleMessage, Error, Page, Request

# Jupyter loads the text of each bundle as a module from a blob; `anywidget` reports what they throw.
OURS = ("blob:", "anywidget", "robowidgets")


class Console:
    """The lines of a page's console, and its errors: what widgets threw, complained of or fetched.

    Args:
        page: the page, before it goes anywhere.
        web: words of the addresses that the page may ask the web for; robots are often offline.
    """

    def __init__(self, page: Page, web: tuple[str, ...] = ()) -> None:
        self.lines: list[str] = []
        self.errors: list[str] = []
        self._web = web
        page.on("console", self._on_message)
        page.on("pageerror", self._on_error)
        page.on("request", self._on_request)

    def forget(self) -> None:
        """Start again, for another test."""
        self.lines.clear()
        self.errors.clear()

    def _on_message(self, message: ConsoleMessage) -> None:
        line = f"{message.type}: {message.text} ({message.location['url']})"
        # JupyterLab: missing files; on a busy machine, plugins that start slowly, anywidget among them.
        is_labs = message.text.startswith(("Failed to load resource", "Plugin "))
        self._note(line, bad=message.type in ("error", "warning", "assert") and not is_labs)

    def _on_error(self, error: Error) -> None:
        # anywidget on a busy page: run_once.ts lets the widget receive its messages; test_laser_state checks it.
        is_late = error.message.startswith("[anywidget] Failed to initialize model")
        self._note(f"uncaught: {error.message}\n{error.stack or ''}", bad=not is_late)

    def _on_request(self, request: Request) -> None:
        address = urlsplit(request.url)
        local = address.scheme in ("blob", "data", "file") or address.hostname == "127.0.0.1"
        if not local and not any(word in request.url for word in self._web):
            self.errors.append(f"the page asked the web for {request.url}")

    def _note(self, line: str, *, bad: bool) -> None:
        self.lines.append(line)
        if bad and any(name in line for name in OURS):
            self.errors.append(line)
