"""The documentation as a site: served as files, with widgets that answer to the pointer without a kernel."""

from __future__ import annotations

import gzip
import subprocess
import sys
from collections.abc import Iterator
from functools import partial
from html.parser import HTMLParser
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from urllib.parse import parse_qs, unquote, urlsplit

import pytest
from playwright.sync_api import Browser, Page, Response, expect

from ..conftest import ROOT
from .chromium import shoot
from .console import Console

pytest.importorskip("zensical", reason="the generator of the site is not installed: pip install --group site")
pytestmark = pytest.mark.xdist_group("docs")  # the site is built once for all tests

RUN = ("laser", "laser_layers", "camera", "cloud")
"""The pages whose blocks are run."""

FIRST_VIEW = 1_000_000
"""Bytes, compressed as web servers send them."""


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_args: object) -> None:
        pass


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the site."""
    folder = tmp_path_factory.mktemp("site") / "built"
    subprocess.run(
        [
            sys.executable,
            ROOT / "scripts" / "docs_site.py",
            folder,
            "--lite",
            "--only",
            "laser",
            "laser_layers",
            "camera",
            "cloud",
        ],
        check=True,
    )
    return folder


@pytest.fixture(scope="module")
def site(folder: Path) -> Iterator[str]:
    """The address of the site."""
    # Below a path, as many hosts serve it.
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(_Quiet, directory=str(folder.parent))) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/built"
        server.shutdown()


class _Page(HTMLParser):
    """The links of a page, and the anchors in it."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links, self.names = set[str](), set[str]()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("href", "src", "data-rw-live") and tag != "base":
                self.links.add(value or "")
            elif name in ("id", "name"):
                self.names.add(value or "")


def test_every_link_of_the_site_leads_somewhere(folder: Path) -> None:
    # The page for missing addresses uses addresses from the root of the host.
    pages = {file: _Page(file.read_text("utf-8")) for file in folder.rglob("*.html") if file.name != "404.html"}
    assert len(pages) > 40
    lost = []
    for file, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            if target.is_relative_to(folder / "lite"):  # JupyterLite, with the notebooks of the site
                name = parse_qs(parts.query)["path"][0]
                there = folder / "try" / name.removeprefix("docs/") if "/" in name else ROOT / "notebooks" / name
                good = there.exists()
            elif "/pages/" in str(target):  # an exported page, whose scripts make its content
                good = target.exists()
            else:  # after the address of a picture, the fragment names the color scheme that it is for
                section, names = unquote(parts.fragment), pages[target].names if target in pages else None
                good = target.exists() and (not section or names is None or section in names)
            if not good:
                lost.append(f"{file.name}: {link}")
    assert lost == []


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

    # The widgets follow the reader's choice of colours, too.
    page.evaluate("document.body.dataset.mdColorScheme = 'default'")
    expect(laser).to_have_attribute("data-rw-theme", "light")

    page.locator("a", has_text="Layers").first.click()
    expect(page.locator("h1")).to_contain_text("Layers on a scan")
    look_at_widgets(page)
    for name in ("camera", "cloud"):
        page.goto(f"{site}/{name}.html")
        look_at_widgets(page)
    page.locator(".md-search__button:visible").click()
    page.get_by_role("combobox", name="Search").fill("footprint")
    expect(page.get_by_text("The robot to scale", exact=True).filter(visible=True).last).to_be_visible()
    assert console.errors == []


def test_the_site_opens_with_what_it_is_and_how_to_install_it(site: str, browser: Browser) -> None:
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    console = Console(page)
    page.goto(f"{site}/")
    expect(page.locator("h1")).to_contain_text("robowidgets")
    film = page.locator('img[src*="drag-to-code"]').first
    assert film.evaluate("image => image.decode().then(() => image.naturalWidth)") > 0
    expect(page.get_by_text("git clone").first).to_be_visible()
    page.get_by_role("link", name="How do I ...?").first.click()
    expect(page.locator("h1")).to_contain_text("How do I ...")
    assert console.errors == []


def look_at_widgets(page: Page) -> None:
    """Scroll to each live widget of a page: it is drawn, and none waits for what never comes."""
    places = page.locator("[data-rw-live]").all()
    assert places
    for place in places:
        place.scroll_into_view_if_needed()
        expect(place.locator(".rw-card").first).to_be_visible()
        expect(place.get_by_text("waiting for").filter(visible=True)).to_have_count(0)


def point_at_a_ray(page: Page) -> None:
    canvas = page.locator(".rw-live canvas").first
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    assert box
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 4)
