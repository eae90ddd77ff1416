"""Each widget's stylesheet holds all rules for the elements that its script makes."""

from __future__ import annotations

import re

import pytest

from ..conftest import ROOT

JS = ROOT / "robowidgets" / "js"
NAMES = sorted(file.stem for file in JS.glob("*_widget.ts"))


def built(name: str, kind: str) -> str:
    return (ROOT / "robowidgets" / "static" / f"{name}.{kind}").read_text(encoding="utf-8")


def selectors(name: str) -> set[str]:
    """The selectors of a stylesheet, including those within @container and @media."""
    lists = re.findall(r"([^{}]+)\{[^{}]*\}", built(name, "css"))
    return {one.strip() for several in lists for one in re.split(r",(?![^(]*\))", several)}


@pytest.mark.parametrize("name", NAMES)
def test_a_widget_lacks_no_rule_that_another_widget_has_for_its_classes(name: str) -> None:
    # A class name after a dot is looked up, not made: each script looks at the boxes around its cards.
    classes = {*re.findall(r"(?<![.\w-])rw-[\w-]+", built(name, "js")), f"rw-{name.removesuffix('_widget')}"}
    every = set().union(*(selectors(other) for other in NAMES))
    missing = [
        selector
        for selector in every - selectors(name)
        if (named := set(re.findall(r"\.(rw-[\w-]+)", selector))) and named <= classes
    ]
    assert missing == []


def test_no_rule_looks_at_what_is_in_an_element() -> None:
    """In JupyterLab, rules with `:has()` make the page check elements up to the root at each change: see `room.ts`."""
    assert [
        file.name for file in JS.rglob("*.css") if "node_modules" not in file.parts and ":has(" in file.read_text()
    ] == []


def colours(theme: str) -> dict[str, str]:
    """The colours of a theme, "light" or "dark", by the names of their variables."""
    style = (JS / "shared" / "theme.css").read_text(encoding="utf-8")
    rules = re.findall(r"^\.rw-card(?:\[data-rw-theme=\"(\w+)\"\])? \{(.*?)^\}", style, re.M | re.S)
    own = {name: dict(re.findall(r"--rw-([\w-]+): (#\w{6});", body)) for name, body in rules}
    return own[""] | own.get(theme, {})


def luminance(colour: str) -> float:
    """Relative luminance as WCAG defines it, from 0 (black) to 1 (white)."""
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
    return sum(weight * part for weight, part in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


def contrast(one: str, other: str) -> float:
    bright, dim = sorted((luminance(one), luminance(other)), reverse=True)
    return (bright + 0.05) / (dim + 0.05)


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_what_carries_a_reading_has_contrast(theme: str) -> None:
    of = colours(theme)
    assert contrast(of["guide"], of["area"]) >= 3
    assert contrast(of["guide"], of["area"]) > 2 * contrast(of["line"], of["area"]), "arcs are stronger than rays"
    assert contrast(of["muted"], of["area"]) >= 4.5
    for ink in ("free-ink", "free-muted"):
        assert contrast(of[ink], of["free"]) >= 4.5


def test_in_the_dark_free_sensors_do_not_outshine_touched_ones() -> None:
    of = colours("dark")
    assert 2 * luminance(of["free"]) < luminance(of["touch"])
