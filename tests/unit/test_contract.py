"""The traits that the front end reads and sets match the Python widgets, by name and type.

`robowidgets/js/NAME/traits.ts` lists them for `NameWidget`; TypeScript holds the front end to the lists.
"""

from __future__ import annotations

import re
from importlib import import_module
from typing import Any

import anywidget
import pytest
import traitlets

from robowidgets import DriveWidget
from robowidgets.simulator import View

from ..conftest import ROOT

JS = ROOT / "robowidgets" / "js"
FILES = sorted((*JS.glob("*/*.ts"), *JS.glob("shared/*/*.ts")))
NAMES = sorted(file.stem.removesuffix("_widget") for file in JS.glob("*_widget.ts"))
OF_INSTANCES = {"_style": traitlets.Unicode()}
"""Traits of the front end itself, which each instance gets and the front end reads."""

PLAIN: dict[type[Any], str] = {
    traitlets.Unicode: "string",
    traitlets.Bool: "boolean",
    traitlets.Float: "number",
    traitlets.Int: "number",
    traitlets.Bytes: "DataView",
    traitlets.List: "array",
    traitlets.Tuple: "array",
    traitlets.Dict: "object",
}
OF_VALUE: dict[type[Any], str] = {str: "string", bool: "boolean", float: "number", int: "number", tuple: "array"}


def _declarations() -> tuple[dict[str, tuple[list[str], dict[str, str]]], dict[str, str]]:
    """Interfaces, by name, with their bases and the types of their fields; and the named types."""
    text = "\n".join(file.read_text(encoding="utf-8") for file in FILES)
    text = re.sub(r"/\*.*?\*/|//[^\n]*", "", text, flags=re.DOTALL)
    interfaces = {}
    for name, bases, body in re.findall(r"export interface (\w+)(?: extends ([^{]+))? \{(.*?)\n\}", text, re.DOTALL):
        fields = dict(re.findall(r"^  (\w+)\??: ([^;]+);", body, re.MULTILINE))
        interfaces[name] = (re.findall(r"\w+", bases), fields)
    return interfaces, dict(re.findall(r"export type (\w+) = ([^;]+);", text))


INTERFACES, TYPES = _declarations()


def fields(interface: str) -> dict[str, str]:
    """All fields of an interface, including inherited ones."""
    bases, own = INTERFACES[interface]
    inherited = {name: kind for base in bases for name, kind in fields(base).items()}
    return inherited | own


def fields_of(widget: str) -> dict[str, str]:
    """The traits of a widget in the front end; a sensor's widget may have no list of its own."""
    own = f"{widget.title()}Traits"
    return fields(own if own in INTERFACES else "SampleTraits")


def kinds(written: str) -> set[str]:
    """The values that a TypeScript type allows, in plain words and literals."""
    found: set[str] = set()
    for part in (part.strip() for part in written.split("|")):
        if part in ("string", "boolean", "number", "null", "DataView") or part.startswith('"'):
            found.add(part)
        elif part.endswith("]"):
            found.add("array")
        elif part in TYPES:
            found |= kinds(TYPES[part])
        elif part in INTERFACES or re.match(r"(Record|Partial)<", part):
            found.add("object")
        else:
            raise AssertionError(f"unknown type {part!r}")
    return found


def widget_class(name: str) -> type[traitlets.HasTraits]:
    """The class of a widget, by the name of its module."""
    if name == "simulator":
        return View
    found: type[traitlets.HasTraits] = getattr(import_module(f"robowidgets.{name}_widget"), f"{name.title()}Widget")
    return found


def our_traits(name: str) -> dict[str, traitlets.TraitType[Any, Any]]:
    """The synced traits of a widget without the traits of ipywidgets and anywidget."""
    theirs = anywidget.AnyWidget.class_traits(sync=True)
    return {key: trait for key, trait in widget_class(name).class_traits(sync=True).items() if key not in theirs}


def expected(trait: traitlets.TraitType[Any, Any]) -> set[str]:
    """The values that a trait allows; for our own trait types, which may allow more, the type of the default."""
    none = {"null"} if trait.allow_none else set()
    if isinstance(trait, traitlets.Enum):
        return {f'"{value}"' for value in trait.values} | none
    plain = next((kind for base, kind in PLAIN.items() if isinstance(trait, base)), None)
    if plain is None and trait.default_value is not None:
        plain = OF_VALUE.get(type(trait.default_value), "object")
    return ({plain} if plain else set()) | none


@pytest.mark.parametrize("name", NAMES)
def test_the_front_end_knows_each_trait_and_no_other(name: str) -> None:
    assert set(fields_of(name)) - OF_INSTANCES.keys() == our_traits(name).keys()


@pytest.mark.parametrize("name", NAMES)
def test_both_halves_have_the_same_types(name: str) -> None:
    front = fields_of(name)
    for key, trait in (our_traits(name) | {k: v for k, v in OF_INSTANCES.items() if k in front}).items():
        said = kinds(front[key])
        if isinstance(trait, (*PLAIN, traitlets.Enum)):
            assert said == expected(trait), f"{name}: {key} is {front[key]!r}"
        else:
            plain = {"string" if kind.startswith('"') else kind for kind in said}
            assert expected(trait) <= plain, f"{name}: {key} is {front[key]!r}"
            assert ("null" in said) == trait.allow_none, f"{name}: {key} is {front[key]!r}"


@pytest.mark.parametrize("name", NAMES)
def test_lists_hold_the_same_type_on_both_sides(name: str) -> None:
    front = fields_of(name)
    for key, trait in our_traits(name).items():
        element = getattr(trait, "_trait", None)
        if isinstance(element, traitlets.Enum):
            element = traitlets.Unicode()
        if element is not None and isinstance(trait, traitlets.List):
            assert kinds(front[key].removesuffix("[]")) == expected(element), f"{name}: {key} is {front[key]!r}"


def test_the_driver_is_sent_in_fields_that_the_front_end_knows() -> None:
    pad = DriveWidget()
    assert pad.get_state()["_state"].keys() == fields("Told").keys() | fields("DriveTold").keys()
    pad.close()


def test_no_cast_hides_a_wrong_name_from_typescript() -> None:
    casts = [
        f"{file.relative_to(JS)}: {line.strip()}"
        for file in FILES
        for line in file.read_text(encoding="utf-8").splitlines()
        if re.search(r"odel\.(get|set)\([^)]*\) as |odel as (unknown|any)", line)
    ]
    assert casts == []
