"""What tells whether a recording has changed."""

from __future__ import annotations

from pathlib import Path
from threading import Barrier

import pytest

import robowidgets
from robowidgets.fleet._kept import states_of
from robowidgets.recordings import remote
from robowidgets.repair import RecordingError


def test_servers_are_asked_at_once_and_each_answer_is_that_of_its_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    together = Barrier(4)  # breaks unless four are asked at once

    def state_of(url: str) -> str:
        together.wait(60)
        if url.endswith("3"):
            raise RecordingError("no permission")
        if url.endswith("2"):
            raise ZeroDivisionError("of a driver")
        return f"state of {url}"

    monkeypatch.setattr(remote, "state_of", state_of)
    urls = [f"s3://bucket/{number}" for number in range(4)]
    missing = tmp_path / "missing.bag"
    found = states_of([*urls, Path(robowidgets.SAMPLE), missing])
    assert list(found) == [*urls, str(robowidgets.SAMPLE), str(missing)]
    assert [found[url].text for url in urls] == [*(f"state of {url}" for url in urls[:2]), None, None]
    assert found[urls[3]].problem == "no permission"
    assert found[urls[2]].problem == "cannot be looked at: ZeroDivisionError: of a driver"
    assert str(robowidgets.SAMPLE.stat().st_size) in (found[str(robowidgets.SAMPLE)].text or "")
