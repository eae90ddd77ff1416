"""The cases of tests/vectors.json, which the front end's tests read too: both halves classify, index and pack alike."""

from __future__ import annotations

from math import degrees, radians
from typing import Any

import pytest

from .. import vectors
from ..vectors import to_scan

VECTORS = vectors.read()
ROUNDED = 1e-3
"""Degrees: headers give their angles in few digits."""


@pytest.mark.parametrize("case", VECTORS["scans"], ids=lambda case: case["name"])
class TestScan:
    def test_is_classified_and_counted(self, case: dict[str, Any]) -> None:
        scan = to_scan(case)
        assert list(scan.counts.values()) == case["counts"]
        assert scan.validity.tolist() == case.get("validity", scan.validity.tolist())
        nearest = scan.nearest()
        assert (nearest and nearest.index) == case["nearest"]
        if "distance" in case:
            assert scan.distance() == pytest.approx(float(case["distance"]), nan_ok=True)

    def test_is_indexed_by_angle(self, case: dict[str, Any]) -> None:
        scan = to_scan(case)
        for index, angle in case.get("angles", {}).items():
            off = degrees(scan.angles[int(index)]) - angle
            assert (off + 180) % 360 - 180 == pytest.approx(0, abs=ROUNDED)
        for angle, index in case.get("at", []):
            ray = scan.at(radians(angle))
            assert (ray and ray.index) == index, f"at {angle} degrees"


def test_frames_are_packed_byte_by_byte() -> None:
    """Otherwise the layout has changed: fix front end and docs/developers/frames.md, run `python -m tests.vectors`."""
    assert vectors.make() == VECTORS["frames"]


def test_rays_stand_by_angle_as_in_the_front_end() -> None:
    """Otherwise the rule has changed: change the front end, then run `python -m tests.vectors`."""
    assert vectors.make_rays() == VECTORS["rays"]


def test_a_range_is_classified_and_counts_as_in_the_front_end() -> None:
    """Otherwise the rule has changed: change the front end, then run `python -m tests.vectors`."""
    assert vectors.make_ranges() == VECTORS["ranges"]


def test_pixels_are_read_as_in_the_front_end() -> None:
    """Otherwise the rule has changed: change the front end, then run `python -m tests.vectors`."""
    assert vectors.make_images() == VECTORS["images"]


def test_points_are_selected_by_the_code_of_the_front_end() -> None:
    """Otherwise a text has changed: change js/cloud/text.ts, then run `python -m tests.vectors`."""
    assert vectors.make_selections() == VECTORS["selections"]


def test_rays_scatter_as_in_the_front_end() -> None:
    """Otherwise the rule has changed: change the front end, then run `python -m tests.vectors`."""
    assert vectors.make_spreads() == VECTORS["spreads"]


def test_sectors_hold_and_are_written_as_the_front_end_has_them() -> None:
    """Otherwise a rule or a text has changed: change the front end, then run `python -m tests.vectors`."""
    assert vectors.make_sectors() == VECTORS["sectors"]
    assert vectors.make_codes() == VECTORS["codes"]


def test_a_source_is_silent_when_the_front_end_says_so() -> None:
    """Otherwise a rule has changed: change js/shared/staleness.ts, then run `python -m tests.vectors`."""
    assert vectors.make_silences() == VECTORS["silences"]
    assert vectors.make_steps() == VECTORS["steps"]
    assert vectors.make_beats() == VECTORS["beats"]
