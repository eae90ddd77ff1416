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
    """The selectors of a stylesheet, also those within @container and @media."""
    lists = re.findall(r"([^{}]+)\{[^{}]*\}", built(name, "css"))
    return {one.strip() for several in lists for one in re.split(r",(?![^(]*\))", several)}


@pytest.mark.parametrize("name", NAMES)
def test_a_widget_lacks_no_rule_that_another_widget_has_for_its_classes(name: str) -> None:
    classes = {*re.findall(r"rw-[\w-]+", built(name, "js")), f"rw-{name.removesuffix('_widget')}"}
    every = set().union(*(selectors(other) for other in NAMES))
    missing = [
        selector
        for selector in every - selectors(name)
        if (named := set(re.findall(r"\.(rw-[\w-]+)", selector))) and named <= classes
    ]
    assert missing == []
