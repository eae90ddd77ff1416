"""The parts of values that are kept, and their texts: short, at once, and without a call of a user's code."""

from __future__ import annotations

import enum
import math
from collections import OrderedDict, defaultdict, deque, namedtuple
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest

from robowidgets.behaviors.lines.values import Glimpse, glimpse, number_text, text_of
from robowidgets.samples import Scan

SCAN = Scan(np.array([1.0, 2.0], np.float32), angle_min=0.0, angle_increment=0.1, range_min=0.1, range_max=4.0)
Point = namedtuple("Point", "x y")


class Side(enum.Enum):
    LEFT = 1


class Hostile:
    """Whoever calls any of it fails."""

    def fail(self, *_: Any, **__: Any) -> Any:
        raise AssertionError("code of the user was called")

    __getattribute__ = __repr__ = __str__ = __len__ = __iter__ = __eq__ = __bool__ = __format__ = fail
    __hash__ = fail


class HostileMeta(type):
    def _fail(cls, *_: Any) -> Any:
        raise AssertionError("code of the user was called")

    __getattribute__ = __hash__ = __eq__ = __instancecheck__ = __subclasscheck__ = __repr__ = _fail


class Made(metaclass=HostileMeta):
    pass


class HostileList(list):  # type: ignore[type-arg]
    __iter__ = __len__ = __getitem__ = __repr__ = Hostile.fail


class HostileDict(dict):  # type: ignore[type-arg]
    items = __iter__ = __len__ = __getitem__ = __repr__ = Hostile.fail


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (MappingProxyType({"left": True}), "{'left': True}"),
        (MappingProxyType(HostileDict(left=True)), "<mappingproxy>"),
        (0.6, "0.6"),
        (-0.8, "−0.8"),
        (1 / 3, "0.3333"),
        (1e-9, "1e-09"),
        (math.inf, "inf"),
        (-math.inf, "−inf"),
        (math.nan, "NaN"),
        (3, "3"),
        (-3, "−3"),
        (True, "True"),
        (None, "None"),
        (10**5000, "an integer of 16610 bits"),
        ("front", "'front'"),
        ("<b>&", "'<b>&'"),
        ("a" * 1000, "'" + "a" * 60 + "…'"),
        ("a\nb", "'a\\nb'"),
        (1 + 2j, "(1+2j)"),
        (np.float32(0.5), "0.5"),
        (np.int64(-4), "−4"),
        (np.bool_(True), "True"),
        (np.arange(3.0), "array[0.0, 1.0, 2.0]"),
        (np.zeros((480, 640, 3)), "array of 480 × 640 × 3"),
        (np.arange(541) < 12, "12 of 541 True"),
        ([1, 2.5, "x"], "[1, 2.5, 'x']"),
        (list(range(500)), "[0, 1, 2, 3, …] of 500"),
        ((1,), "(1,)"),
        ((1, (2, (3, (4,)))), "(1, (2, <tuple>))"),
        ({1}, "{1}"),
        (frozenset({1}), "frozenset(1)"),
        (deque([1, 2]), "deque(1, 2)"),
        ({"left": 0.5, "right": None}, "{'left': 0.5, 'right': None}"),
        (dict.fromkeys(range(9)), "{0: None, 1: None, 2: None, 3: None, …} of 9"),
        (OrderedDict(a=1), "OrderedDict{'a': 1}"),
        (defaultdict(list), "defaultdict{}"),
        (Point(1, 2), "Point(1, 2)"),
        (Side.LEFT, "Side.LEFT"),
        (ValueError("no"), "ValueError('no')"),
        (KeyError(3), "KeyError()"),
        (len, "<function len>"),
        (math, "<module>"),
        (int, "<class int>"),
        (b"abc", "3 bytes"),
        (object(), "<object>"),
        (SCAN, "Scan of 2 rays"),
        (SCAN.nearest(), "ray [0]"),
    ],
    ids=lambda value: value[:30] if type(value) is str else "",
)
def test_each_value_has_a_short_text(value: Any, text: str) -> None:
    assert text_of(glimpse(value)) == text


def test_no_code_of_a_user_is_called() -> None:
    listed, table = HostileList([1, 2]), HostileDict({"a": 1})
    objects = np.empty(1, object)
    objects[0] = Hostile()
    values = [objects, Hostile(), [Hostile()], Made(), Made, listed, table]
    texts = [text_of(glimpse(values[i])) for i in range(len(values))]
    assert texts == [
        "array of 1", "<Hostile>", "[<Hostile>]", "<Made>", "<class Made>", "HostileList(1, 2)", "HostileDict{'a': 1}",
    ]  # fmt: skip


def test_numbers_have_their_unit_and_as_many_decimals_as_they_need() -> None:
    assert number_text(0.4217, "m") == "0.42 m"
    assert number_text(-1.0, "rad") == "−1.00 rad"
    assert number_text(0.42171, decimals=4) == "0.4217"
    assert text_of(3, "s") == "3 s"
    assert text_of(math.inf, "m") == "inf m"


def test_a_list_is_seen_as_it_was() -> None:
    value = [1]
    seen = glimpse(value)
    value.append(2)
    assert text_of(seen) == "[1]"


def test_a_list_in_itself_ends() -> None:
    value: list[Any] = []
    value.append(value)
    assert text_of(glimpse(value)) == "[[<list>]]"


def test_what_another_thread_changes_meanwhile_is_seen_by_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    def changed(*_: Any) -> Any:
        raise RuntimeError("dictionary changed size during iteration")

    monkeypatch.setattr("robowidgets.behaviors.lines.values.islice", changed)
    assert glimpse({1: 2}) == Glimpse("dict")
