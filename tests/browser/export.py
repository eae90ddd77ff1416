"""Exported notebooks: this machine serves what they fetch from the web, and nothing else."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from urllib.parse import urlsplit

from playwright.sync_api import Page, Route

MODULES = Path(__file__).with_name("node_modules")
# The same file that a browser gets from the npm package `anywidget`.
ANYWIDGET = Path(sys.prefix) / "share" / "jupyter" / "nbextensions" / "anywidget" / "index.js"
# What every exported page asks the web for: the widget manager, and formulas and diagrams, which it does without.
WEB = ("/require.js/", "/@jupyter-widgets/html-manager@", "/anywidget@", "/mathjax/", "/mermaid")
# The pages pin a build of require.js that npm does not carry, by its hash.
PIN = re.compile(r'\sintegrity="[^"]*"')


def serve(page: Page, file: Path) -> None:
    """Open an exported page from disk, as a recipient does on a machine without a network."""
    copy = file.with_suffix(".local.html")
    copy.write_text(PIN.sub("", file.read_text(encoding="utf-8")), encoding="utf-8")
    page.route(re.compile("^https?:"), _answer)
    page.goto(copy.as_uri())


def _answer(route: Route) -> None:
    local = _local(urlsplit(route.request.url).path)
    if local is not None and local.is_file():
        route.fulfill(path=local, headers={"Access-Control-Allow-Origin": "*"})
    else:
        route.abort()


def _local(path: str) -> Path | None:
    if path.endswith("/require.min.js"):
        return MODULES / "requirejs" / "require.js"
    package = re.fullmatch(r"(?:/npm)?/(@?[^@]+)@[^/]*/(.+)", path)
    if package is None:
        return None
    name, inside = package.groups()
    return ANYWIDGET if name == "anywidget" else MODULES / name / inside
