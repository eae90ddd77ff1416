"""Every real recording gives the same samples, columns and problems as ever."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.unit.recordings.digest import DIGESTS, digest, recordings

TOLD = json.loads(DIGESTS.read_text())


@pytest.mark.slow
@pytest.mark.versions
@pytest.mark.parametrize("name", TOLD)
def test_a_real_recording_gives_the_same_results_as_ever(data: Path, name: str) -> None:
    assert digest(data / name) == TOLD[name]


def test_no_real_recording_is_left_out(data: Path) -> None:
    assert {f"{path.parent.name}/{path.name}" for path in recordings(data)} == TOLD.keys()
