"""Widgets in real headless Chromium: on a plain page, or in real JupyterLab where a kernel or the notebook matters.

Fixtures:
    plain_page: `nb = plain_page([source, ...])` runs these cells in this process and puts what they display into a page
        of its own: the real widget, the real front end, and no Jupyter. It gives a `PlainPage` (plain_page.py), which
        has the cells, what is on show and `python` of a `Notebook`, in a tenth of the time, and takes its keywords. In
        `with nb.busy():` an endless cell runs.
    notebook: `nb = notebook([source, ...])` writes a notebook with these code cells, opens it in a page of its own,
        runs it and gives a `Notebook`; keywords: `run=False`, `scale=2` (device pixels per CSS pixel), `width` and
        `height` of the window, `theme="dark"`, `touch=True` (a touch screen). A test may open several.
    static_page: `page = static_page(html_file)` opens an exported page without a server, a kernel or the network.
    lab, browser: the JupyterLab server and the Chromium of the whole run.

A `Notebook` (notebook.py):
    cells: `run(i)`, `start(i)` (back when the kernel is at work on it) and `wait(i)`, `run_all()`,
        `append(source) -> i`, `edit(i, source)`, `text(i)`, `outputs(i)`; a cell that raised raises `CellError`.
    on show: `widget(i, nth=0)` and `output(i)` are Playwright locators, `page` is the page, `theme("dark")`,
        `resize(width)` sizes the window until a widget has that many CSS pixels.
    kernel: `python(code) -> text` past the cells, `interrupt()`, `restart_kernel()`, `reload()`, `save() -> file`.

`shoot(locator, name)` (chromium.py) leaves tests/screenshots/NAME@1x.png or @2x.png when the environment has PICTURES;
`photograph` does so always, for tests that read the picture. Wait with Playwright's `expect` or
`page.wait_for_function`, never for a time; before a plain `assert` on what the page shows, call `nb.drawn()`. With
SLOW_PAGE_MS=300 in the environment animation frames are late, and a test that does not wait for its drawing fails. A
test fails when a widget threw or complained on the console of its page, or when the page asked the web for anything; a
test that expects it takes it out of `nb.console.errors`. A failed test leaves its pages in tests/screenshots/failed/
and their consoles in the report.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Literal

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, Playwright, expect, sync_playwright

from . import chromium, export
from .console import Console
from .notebook import Notebook, notebook_of
from .plain_page import PageServer, PlainPage
from .server import LabServer

DRIVER = Path(__file__).with_name("driver.js")
FAILED = pytest.StashKey[bool]()

Host = Literal["lab", "plain"]
Screen = tuple[Host, int, bool]
"""The kind of a page: the host it has loaded, its device pixels per CSS pixel, and whether it has touch."""

UNHURRIED = """
import robowidgets.behaviors.program as program_of_a_test
program_of_a_test.STEP = program_of_a_test.STEP._replace(late=60.0)
"""
"""Give the steps of programs more time, because the machine may be busy. Lateness is tested with a clock."""

SLOW_PAGE = """(() => {
    const [frame, forget] = [requestAnimationFrame, cancelAnimationFrame];
    const waiting = new Map();
    let begun = false;
    const now = performance.now.bind(performance);
    performance.now = () => {
        const early = begun ? 30 : 0;
        begun = false;
        return now() - early;
    };
    window.requestAnimationFrame = (draw) => {
        const id = frame(() => {});
        const run = (time) => {
            begun = true;
            try {
                draw(time);
            } finally {
                begun = false;
            }
        };
        const later = () => {
            waiting.delete(id);
            frame(run);
        };
        waiting.set(id, setTimeout(later, MILLISECONDS));
        return id;
    };
    window.cancelAnimationFrame = (id) => {
        forget(id);
        clearTimeout(waiting.get(id));
        waiting.delete(id);
    };
})()"""
"""Delay animation frames as if each took long: each draws one card while the others wait."""

HELD_KEYS = ("ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight", "w", "a", "s", "d", "Shift")
"""Keys that a test may leave pressed."""

SLOW_PAGE_MS = os.environ.get("SLOW_PAGE_MS", "")
"""Delay of animation frames in milliseconds, or empty. A test that reads the page before it is drawn then fails."""

PATIENCE_MS = 60_000
"""Wait long: a test fails if what it waits for never comes, not because the machine is busy."""

expect.set_options(timeout=PATIENCE_MS)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Run all tests in JupyterLab in one process: they share its server and a page that has loaded it."""
    for item in items:
        if "lab" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.xdist_group("lab"))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Any:
    report = yield
    item.stash[FAILED] = item.stash.get(FAILED, False) or report.failed
    return report


@pytest.fixture(scope="session", autouse=True)
def unhurried_steps() -> None:
    """Apply `UNHURRIED` in this process, where the cells of plain pages run."""
    exec(UNHURRIED)


@pytest.fixture(scope="session")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LabServer]:
    server = LabServer(tmp_path_factory.mktemp("lab"))
    yield server
    server.stop()


@pytest.fixture(scope="session")
def playwright() -> Iterator[Playwright]:
    with sync_playwright() as started:
        yield started


@pytest.fixture(scope="session")
def browser(playwright: Playwright) -> Iterator[Browser]:
    started = chromium.launch(playwright, is_shell_enough=not chromium.PICTURES)
    yield started
    started.close()


@pytest.fixture(scope="session")
def contexts(browser: Browser) -> Iterator[Callable[[int, bool], BrowserContext]]:
    """Yield one browser profile per kind of screen: the pages of a run share its cache, as the pages of a user do."""
    kept: dict[tuple[int, bool], BrowserContext] = {}

    def context(scale: int, touch: bool) -> BrowserContext:
        if (scale, touch) not in kept:
            made = browser.new_context(device_scale_factor=scale, has_touch=touch)
            made.set_default_timeout(PATIENCE_MS)
            if SLOW_PAGE_MS:
                made.add_init_script(SLOW_PAGE.replace("MILLISECONDS", SLOW_PAGE_MS))
            made.add_init_script(path=DRIVER)
            kept[scale, touch] = made
        return kept[scale, touch]

    yield context
    for made in kept.values():
        made.close()


@pytest.fixture(scope="session")
def spare_pages() -> dict[Screen, list[tuple[Page, Console]]]:
    """Spare pages. Opening a new one takes most of a test's time: it starts a process and loads JupyterLab."""
    return {}


@pytest.fixture
def pages(
    request: pytest.FixtureRequest, spare_pages: dict[Screen, list[tuple[Page, Console]]]
) -> Iterator[list[tuple[Page, Console]]]:
    """The pages of a test. At its end: check consoles, save pictures of a failure, close most pages."""
    opened: list[tuple[Page, Console]] = []
    yield opened
    spare = {page for kept in spare_pages.values() for page, _ in kept}
    name = re.sub(r"\W+", "-", request.node.name).strip("-")
    failed = request.node.stash.get(FAILED, False)
    complaints = []
    for number, (page, console) in enumerate(opened):
        if failed or console.errors:
            page.screenshot(path=chromium.SCREENSHOTS / "failed" / f"{name}-{number}.png")
            request.node.add_report_section("teardown", f"console of page {number}", "\n".join(console.lines))
        complaints += console.errors
        if page not in spare:
            page.close()
    assert not complaints, "widgets complained on the console:\n" + "\n".join(complaints)


@pytest.fixture
def take_page(
    request: pytest.FixtureRequest,
    contexts: Callable[[int, bool], BrowserContext],
    pages: list[tuple[Page, Console]],
    spare_pages: dict[Screen, list[tuple[Page, Console]]],
) -> Iterator[Callable[..., tuple[Page, Console]]]:
    """Return a function that gives a page for a host, a scale, touch or none, and a size: a spare one, or a new one."""
    taken: list[tuple[Screen, Page, Console]] = []

    def take(host: Host, scale: int, touch: bool, width: int, height: int) -> tuple[Page, Console]:
        screen = host, scale, touch
        if spare_pages.get(screen):
            page, console = spare_pages[screen].pop()
            console.forget()
        else:
            page = contexts(scale, touch).new_page()
            console = Console(page)
        pages.append((page, console))
        taken.append((screen, page, console))
        # Chromium takes seconds for each turn of the wheel on a page behind another.
        page.bring_to_front()
        page.set_viewport_size({"width": width, "height": height})
        return page, console

    yield take
    for screen, page, console in taken:
        # A test that failed may need its picture.
        if request.node.stash.get(FAILED, False) or console.errors:
            continue
        if screen[0] == "plain":
            page.goto("about:blank")
        # A test may have navigated a page away from JupyterLab, or left a player playing.
        elif not page.evaluate("window.driver?.closeAll()"):
            continue
        page.mouse.up()
        page.mouse.move(0, 0)
        for key in HELD_KEYS:
            page.keyboard.up(key)
        page.emulate_media(media="null", color_scheme="null", reduced_motion="null", forced_colors="null")
        spare_pages.setdefault(screen, []).append((page, console))


@pytest.fixture
def own_sessions(lab: LabServer) -> Iterator[None]:
    """End the kernels of a test with it."""
    yield
    lab.end_sessions()


@pytest.fixture
def notebook(
    lab: LabServer,
    own_sessions: None,  # ended when the notebook is closed
    take_page: Callable[..., tuple[Page, Console]],
    request: pytest.FixtureRequest,
) -> Callable[..., Notebook]:
    opened: list[Notebook] = []

    def open_notebook(
        cells: Sequence[str],
        *,
        run: bool = True,
        scale: int = 1,
        width: int = 1200,
        height: int = 900,
        theme: Literal["light", "dark"] = "light",
        touch: bool = False,
    ) -> Notebook:
        name = re.sub(r"\W+", "-", request.node.nodeid.split("::", 1)[-1]).strip("-")
        path = f"{name}-{len(opened)}.ipynb"
        (lab.files / path).write_text(notebook_of(cells))
        page, console = take_page("lab", scale, touch, width, height)
        opened.append(Notebook(page, lab, path, console))
        opened[-1].open()
        opened[-1].theme(theme)
        if any(".program(" in cell for cell in cells):
            opened[-1].python(UNHURRIED)
        if run:
            opened[-1].run_all()
        return opened[-1]

    return open_notebook


@pytest.fixture(scope="session")
def page_server() -> Iterator[PageServer]:
    server = PageServer()
    yield server
    server.stop()


@pytest.fixture
def plain_page(
    page_server: PageServer,
    take_page: Callable[..., tuple[Page, Console]],
) -> Iterator[Callable[..., PlainPage]]:
    opened: list[PlainPage] = []

    def open_page(
        cells: Sequence[str],
        *,
        run: bool = True,
        scale: int = 1,
        width: int = 1200,
        height: int = 900,
        theme: Literal["light", "dark"] = "light",
        touch: bool = False,
    ) -> PlainPage:
        page, console = take_page("plain", scale, touch, width, height)
        opened.append(PlainPage(page, console, page_server, cells))
        opened[-1].open()
        opened[-1].theme(theme)
        if run:
            opened[-1].run_all()
        return opened[-1]

    yield open_page
    for page in reversed(opened):
        page.close()


@pytest.fixture
def static_page(browser: Browser, pages: list[tuple[Page, Console]]) -> Callable[[Path], Page]:
    def open_page(file: Path) -> Page:
        page = browser.new_page()
        pages.append((page, Console(page, export.WEB)))
        export.serve(page, file)
        return page

    return open_page
