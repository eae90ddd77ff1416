from math import isnan, nan

import pytest

from robowidgets.widget.rate import RateMeter


def rate(*times: float, asked_after: int = 1) -> float:
    """The rate of arrivals at these times, asked after every so many of them."""
    meter, told = RateMeter(), nan
    for count, time in enumerate(times, 1):
        if count % asked_after == 0:
            told = meter.rate(count, time)
    return told


def test_the_rate_of_no_or_one_arrival_and_of_a_loop_over_a_recording_is_unknown() -> None:
    assert isnan(RateMeter().rate(0, 0.0))
    assert isnan(rate(5.0))
    assert isnan(rate(*[5.0 + i * 1e-5 for i in range(1000)]))


@pytest.mark.parametrize("hz", [0.2, 1, 10, 40, 1000, 20_000])
@pytest.mark.parametrize("asked_after", [1, 5])
def test_a_steady_rate_is_reported_whatever_it_is(hz: float, asked_after: int) -> None:
    seconds = max(4.0, 15 / hz)
    times = [100 + i / hz for i in range(round(seconds * hz))]
    assert rate(*times, asked_after=asked_after) == pytest.approx(hz, rel=0.01)


def test_after_a_pause_it_is_known_throughout() -> None:
    meter = RateMeter()
    before = [i / 10 for i in range(31)]
    after = [before[-1] + 8 + i / 10 for i in range(31)]
    told = [meter.rate(count, time) for count, time in enumerate(before + after, 1)]
    assert not any(map(isnan, told[len(before) :]))
    assert told[-1] == pytest.approx(10, rel=0.01)


def test_the_past_is_forgotten() -> None:
    slow = [i / 2 for i in range(20)]
    fast = [slow[-1] + i / 50 for i in range(1, 250)]
    assert rate(*slow, *fast) == pytest.approx(50, rel=0.01)


def sag_of(*rates: float) -> tuple[bool, float]:
    """From arrivals at rates that last for 20 s each: True if the last has sagged, and the usual rate."""
    meter, now, count = RateMeter(), 100.0, 0
    for hz in rates:
        for _ in range(round(20 * hz)):
            now, count = now + 1 / hz, count + 1
            meter.rate(count, now)
    return meter.has_sagged, meter.usual


def test_a_rate_that_falls_below_half_of_the_usual_one_has_sagged() -> None:
    assert sag_of(10, 10, 4) == (True, pytest.approx(10, rel=0.05))
    assert sag_of(10, 10, 6)[0] is False
    assert sag_of(10, 10, 4, 10)[0] is False
    assert sag_of(4, 10)[0] is False


def test_a_rate_that_lasts_becomes_the_usual_one() -> None:
    assert sag_of(10, 4, 4, 4) == (False, pytest.approx(4, rel=0.05))


def test_a_single_pause_is_not_a_sag() -> None:
    meter = RateMeter()
    times = [i / 10 for i in range(300)]
    told = []
    for count, time in enumerate([*times, *(time + 31.5 for time in times)], 1):
        meter.rate(count, time)
        told.append(meter.has_sagged)
    assert not any(told)
