"""The keys under which saved results are found again."""

from __future__ import annotations

import json
from fractions import Fraction
from functools import partial, reduce
from operator import or_
from typing import Any

import numpy as np
import pytest

from robowidgets import Sector, conditions
from robowidgets.fleet._identity import NotIdentifiedError, identity_of
from robowidgets.recordings.search.base import condition


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (conditions.nearest_below(0.3), conditions.nearest_below(0.4)),
        (conditions.nearest_below(0.3), conditions.nearest_below(0.3, "front")),
        (conditions.nearest_below(0.3, Sector(0, 1)), conditions.nearest_below(0.3, Sector(0, 2))),
        (conditions.nearest_below(0.3), ~conditions.nearest_below(0.3)),
        (conditions.touched() & conditions.gap(1.0), conditions.touched() | conditions.gap(1.0)),
        (("find", 1), ("find", "1")),
        ([1, 2], (1, 2)),
        (0.0, False),
    ],
)
def test_other_questions_have_another_text_and_equal_ones_the_same(one: Any, other: Any) -> None:
    assert identity_of(one) != identity_of(other)
    assert identity_of(one) == identity_of(one)


def test_a_condition_that_is_made_again_is_the_same_question() -> None:
    made = [
        identity_of(conditions.nearest_below(0.3, ("-20deg", "20deg")) & ~conditions.touched("left")) for _ in range(2)
    ]
    assert made[0] == made[1]


@pytest.mark.parametrize(
    "value",
    [
        condition(lambda scan: scan.distance() < 0.3),
        conditions.touched() & condition(lambda scan: scan.distance() < 0.3),
        conditions.label("door"),
        json.dumps,
        partial(json.dumps, indent=1),
        Fraction(1, 2),
        np.float64(0.3),
        object(),
        object,
    ],
    ids=lambda value: type(value).__name__,
)
def test_code_and_objects_of_others_are_not_known(value: Any) -> None:
    with pytest.raises(NotIdentifiedError):
        identity_of(value)


def test_the_text_of_joined_conditions_grows_with_their_number_alone() -> None:
    def joined(count: int) -> Any:
        return reduce(or_, [conditions.nearest_below(0.1 * i) for i in range(1, count + 1)])

    assert len(identity_of(joined(20))) < 3 * len(identity_of(joined(10)))
