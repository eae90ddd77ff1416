"""The approximate bytes of messages and samples."""

from __future__ import annotations

from array import array
from typing import Any

import numpy as np
import pytest

from robowidgets import Scan
from robowidgets.runtime.sizes import approximate_bytes


class Image:
    """A message of rclpy: its fields are in slots, its bytes in an array."""

    __slots__ = ("_data", "_height", "_unset")

    def __init__(self) -> None:
        self._data, self._height = array("B", bytes(100_000)), 100

    def __getattr__(self, name: str) -> Any:
        raise AssertionError(f"the code of a user is called for {name}")


@pytest.mark.parametrize(
    ("value", "size"),
    [
        (b"abc" * 1000, 3000),
        (np.zeros((10, 100)), 8000),
        ({"header": {"frame_id": "laser"}, "data": [0.0] * 1000, "more": [b"x" * 500] * 20}, 18_000),
        (Scan(np.zeros(1000, np.float32), 0.0, 0.01, 0.1, 10.0), 4000),
    ],
)
def test_the_size_is_the_sum_of_the_large_parts(value: Any, size: int) -> None:
    assert size <= approximate_bytes(value) <= 1.2 * size


def test_messages_with_slots_have_their_size() -> None:
    assert approximate_bytes(Image()) == 100_000


def test_each_object_may_have_bytes_of_its_own() -> None:
    assert approximate_bytes({"header": {"frame_id": "laser"}, "data": b"x"}, 200) == 406


def test_a_value_that_contains_itself_has_a_size() -> None:
    value: dict[str, Any] = {"data": b"x" * 1000}
    value["again"] = value
    assert 1000 <= approximate_bytes(value) < 10_000
