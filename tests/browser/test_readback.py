"""The benchmarks read from a picture the number that was encoded in the scan."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

from benchmarks import scan

PAGE = Path(scan.__file__).with_name("page.js")
NUMBERS = (0, 1, 2, 1000, 0x555555, 0xAAAAAA, 2**24 - 1)

DOTS = {
    "canvas": """(points) => {
        const context = document.querySelector("canvas").getContext("2d");
        context.clearRect(0, 0, 760, 560);
        context.fillStyle = "red";
        for (const [x, y] of points) context.fillRect(x - 1.5, y - 1.5, 3, 3);
    }""",
    "svg": """(points) => {
        const dots = points.map(([x, y]) => `<path class="dot" transform="translate(${x}, ${y})"/>`);
        document.querySelector("svg").innerHTML = dots.join("");
    }""",
}


def put(page: Page, kind: str, number: int) -> None:
    x, y = scan.points(scan.encode(number))
    points = [[380 + 45 * float(a), 280 - 45 * float(b)] for a, b in zip(x, y, strict=True)]
    page.evaluate(DOTS[kind], points)


@pytest.mark.parametrize("kind", ["canvas", "svg"])
def test_a_picture_says_the_number_of_its_scan(browser: Browser, kind: str) -> None:
    page = browser.new_page()
    page.add_init_script(path=PAGE)
    page.goto("about:blank")
    page.set_content('<div class="view"><canvas width="760" height="560"></canvas><svg></svg></div>')
    put(page, kind, 0)
    page.evaluate("(svg) => bench.look('.view', svg)", ".dot" if kind == "svg" else None)
    page.evaluate("bench.learn(null)")
    for bit in range(scan.BITS):
        put(page, kind, 1 << bit)
        page.evaluate("(bit) => bench.learn(bit)", bit)
    for number in NUMBERS:
        put(page, kind, number)
        assert page.evaluate("bench.read()") == [number]
    page.evaluate(DOTS[kind], [])
    assert page.evaluate("bench.read()") == [None]
    page.close()
