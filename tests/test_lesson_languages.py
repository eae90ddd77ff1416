"""The lessons in other languages: complete, with current texts, and with the same code, answers and checks."""

from __future__ import annotations

import gettext
import json
import re
from collections.abc import Iterator
from pathlib import Path
from string import Formatter
from typing import Any

import pytest

from robowidgets import lessons
from robowidgets.lessons import _progress, _texts
from scripts import translate

LANGUAGES = [language for language in lessons.languages() if language != lessons.ENGLISH]

in_each = pytest.mark.parametrize("language", LANGUAGES)


def fields(text: str) -> list[tuple[str | None, str | None]]:
    return sorted((name, form) for _, name, form, _ in Formatter().parse(text) if name is not None)


def cells(language: str, name: str) -> dict[str, Any]:
    file = translate.NOTEBOOKS / language / f"{name}.ipynb"
    return {cell["id"]: cell for cell in json.loads(file.read_text("utf-8"))["cells"]}


def wordless(line: str) -> tuple[str, list[str]]:
    """A line of code without its comment and its texts, and the fields of the texts."""
    line = re.sub(r"  # .*", "", line)
    return re.sub(r'"[^"]*"', "", line), re.findall(r"\{[^}]*\}", line)


def test_german_and_spanish_are_there() -> None:
    assert set(LANGUAGES) >= {"de", "es"}


@in_each
def test_every_text_is_translated_with_the_same_fields_and_every_file_is_what_the_script_makes(language: str) -> None:
    catalog, lacks = translate.update(translate.TEXTS / f"{language}.po", translate.all_texts())
    assert lacks == []
    made = translate.files_of(language, catalog)
    again = [file for file, content in made.items() if file.suffix != ".mo" and file.read_bytes() != content]
    assert again == [], "run scripts/translate.py"
    with (translate.TEXTS / f"{language}.mo").open("rb") as file:
        spoken = gettext.GNUTranslations(file)
    for text, _ in translate.said_by_checks():
        assert spoken.gettext(text) == catalog[text].string, "run scripts/translate.py"
        assert fields(spoken.gettext(text)) == fields(text)


@in_each
@pytest.mark.parametrize("name", translate.LESSONS)
def test_a_lesson_has_the_code_of_the_english_one(language: str, name: str) -> None:
    english, other = cells("", name), cells(language, name)
    assert list(english) == list(other)
    for cell_id, cell in english.items():
        texts = ["".join(lesson["source"]) for lesson in (cell, other[cell_id])]
        if translate.SOLUTION.search(texts[0]):
            texts = [text.split("```python\n")[1].split("```")[0] for text in texts]
        elif cell["cell_type"] != "code":
            continue
        else:
            texts[1] = texts[1].replace(f'progress("{language}")', "progress()")
        for line, of_other in zip(*(text.split("\n") for text in texts), strict=True):
            assert line == of_other or (translate.has_words(line) and wordless(line) == wordless(of_other))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.chdir(tmp_path)
    yield tmp_path
    _progress.forget()
    _texts.speak("en")


@pytest.mark.parametrize(
    ("language", "wrong", "right", "line"),
    [
        (
            "de",
            "richtig in 2 von 11 Fällen. Noch falsch:",
            "richtig in allen 11 Fällen. Gut gemacht!",
            "1 von 12 fertig",
        ),
        ("es", "bien en 2 de 11 casos. Todavía mal:", "bien en los 11 casos. ¡Muy bien!", "1 de 12 hechas"),
    ],
)
def test_a_lesson_is_checked_in_its_language_and_right_with_the_same_answers(
    folder: Path, language: str, wrong: str, right: str, line: str
) -> None:
    of = cells(language, "from_picture_to_code")
    names: dict[str, Any] = {}
    exec("".join(of["lesson-progress"]["source"]), names)
    task, solution = ("".join(of[f"{part}-4"]["source"]) for part in ("task", "solution"))
    exec(task, names)
    said = repr(names["result"])
    assert said.startswith(f"bumper_reflex: {wrong}")
    known = {text for text, _ in translate.said_by_checks()}
    assert names["result"].fault in known  # the same in all languages
    exec(solution.split("```python\n")[1].split("```")[0] + task[task.index("\nresult = ") :], names)
    assert repr(names["result"]) == f"bumper_reflex: {right}"
    assert repr(lessons.progress(language)) == line


def test_a_language_in_which_no_lesson_is_written_is_refused_with_those_that_are() -> None:
    with pytest.raises(ValueError, match="no lesson is written in the language 'xx'; there are de, en, es"):
        lessons.progress("xx")
