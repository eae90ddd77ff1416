from math import isnan

import pytest

from robowidgets._rate import RateMeter


def meter(*times: float) -> RateMeter:
    made = RateMeter()
    for time in times:
        made.arrive(time)
    return made


def test_nothing_is_said_of_nothing_of_one_arrival_or_of_a_loop_over_a_recording() -> None:
    assert isnan(meter().rate)
    assert isnan(meter(5.0).rate)
    assert isnan(meter(*[5.0 + i * 1e-5 for i in range(1000)]).rate)


@pytest.mark.parametrize("rate", [0.2, 1, 10, 40, 1000, 20_000])
def test_a_steady_rate_is_told_whatever_it_is(rate: float) -> None:
    seconds = max(4.0, 5 / rate)
    assert meter(*[100 + i / rate for i in range(round(seconds * rate))]).rate == pytest.approx(rate, rel=0.01)


def test_the_past_is_forgotten() -> None:
    slow = [i / 2 for i in range(20)]
    fast = [slow[-1] + i / 50 for i in range(1, 250)]
    assert meter(*slow, *fast).rate == pytest.approx(50, rel=0.01)
