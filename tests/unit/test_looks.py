"""The widgets look as they did when their looks were kept: a change is seen in review."""

from __future__ import annotations

from difflib import unified_diff

import pytest

from .. import looks

EVERY = looks.every()


@pytest.fixture(scope="module")
def drawn() -> dict[str, str]:
    return dict(zip(EVERY, looks.draw(EVERY.values()), strict=True))


@pytest.mark.parametrize("name", EVERY)
def test_a_widget_looks_as_it_did(name: str, drawn: dict[str, str]) -> None:
    file = looks.file_of(name)
    before = file.read_text("utf-8") if file.is_file() else ""
    changes = unified_diff(before.splitlines(), drawn[name].splitlines(), "kept", "drawn", lineterm="", n=1)
    shown = "\n".join(changes)
    if shown:
        pytest.fail(f"{name} looks different. If you want that, run `python -m tests.looks`:\n{shown}", pytrace=False)


def test_each_kept_look_is_drawn() -> None:
    assert set(looks.FOLDER.glob("*/*.txt")) == {looks.file_of(name) for name in EVERY}
