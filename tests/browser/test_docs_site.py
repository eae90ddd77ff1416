"""The documentation as a site: served as files, with widgets that answer to the pointer without a kernel."""

from __future__ import annotations

import gzip
import subprocess
import sys
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import pytest
from playwright.sync_api import Browser, Page, Response, expect

from ..conftest import ROOT
from .chromium import shoot
from .console import Console

pytest.importorskip("zensical", reason="the generator of the site is not installed: pip install --group site")

FIRST_VIEW = 1_000_000
"""Bytes, as a web server sends them that compresses."""


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_args: object) -> None:
        pass


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of the site, whose pages on the laser have run."""
    folder = tmp_path_factory.mktemp("site") / "built"
    subprocess.run(
        [sys.executable, ROOT / "scripts" / "docs_site.py", folder, "--only", "laser", "laser_layers"], check=True
    )
    # Below a path, as many hosts serve it.
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(_Quiet, directory=str(folder.parent))) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/built"
        server.shutdown()


def test_a_page_of_the_site_has_live_widgets_and_asks_no_other_host(
    site: str, browser: Browser, tmp_path: Path
) -> None:
    page = browser.new_page(viewport={"width": 1280, "height": 900}, color_scheme="dark")
    console, loaded = Console(page), list[Response]()
    page.on("response", lambda answer: loaded.append(answer))
    page.goto(f"{site}/laser.html")
    laser = page.locator(".rw-live .rw-card").first
    expect(laser).to_contain_text("/scan")
    page.wait_for_load_state("networkidle")
    assert sum(len(gzip.compress(answer.body())) for answer in loaded) < FIRST_VIEW

    point_at_a_ray(page)
    expect(laser.locator(".rw-popup:visible")).to_contain_text("ranges[")
    laser.locator(".rw-freeze").click()
    expect(laser.locator(".rw-freeze")).to_have_attribute("aria-pressed", "true")
    assert laser.get_attribute("data-rw-theme") == "dark"
    shoot(laser, "docs-site-laser")

    # The reader's choice of colours is the widgets', too.
    page.evaluate("document.body.dataset.mdColorScheme = 'default'")
    expect(laser).to_have_attribute("data-rw-theme", "light")

    page.locator("a", has_text="Layers").first.click()
    expect(page.locator("h1")).to_contain_text("Layers on a scan")
    page.locator(".md-search__button:visible").click()
    page.get_by_role("combobox").fill("footprint")
    expect(page.get_by_text("The robot to scale", exact=True).filter(visible=True).last).to_be_visible()
    assert console.errors == []


def point_at_a_ray(page: Page) -> None:
    canvas = page.locator(".rw-live canvas").first
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    assert box
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 4)
