"""Collect the texts of the lessons, and write the lessons in each language with a file in `robowidgets/lessons/texts`.

Run it after a change of a lesson, of a text of a check, or of a translation. It adds new texts to each ``.po`` file,
marks texts with changed English as fuzzy, and writes the compiled ``.mo`` files and ``notebooks/LANGUAGE``. It exits
with 1 while a translation is missing. A new language begins with an empty ``.po`` file.
"""

from __future__ import annotations

import ast
import io
import json
import re
import sys
from collections.abc import Callable, Iterator
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from babel.messages.catalog import Catalog
from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po, write_po

ROOT = Path(__file__).parents[1]
CHECKS = ROOT / "robowidgets" / "lessons"
HINTS = ROOT / "robowidgets" / "samples" / "sector.py"
TEXTS = CHECKS / "texts"
NOTEBOOKS = ROOT / "notebooks"
LESSONS = ("from_picture_to_code", "from_code_to_behavior", "from_behavior_to_robot")

SPEAKS = {"say", "WrongError", "BrokenError", "ReportError", "give_hint"}
SOLUTION = re.compile(r"(?<=<summary>)\w+(?=</summary>)")
TEXT = re.compile(r'"([^"]*)"')
WORDS = re.compile(r"[A-Za-z,;] ")
FIELD = re.compile(r"\{[^}]*\}")
EPOCH = datetime(2026, 1, 1, tzinfo=timezone.utc)

Translate = Callable[[str], str]


def said_by_checks() -> Iterator[tuple[str, str]]:
    """Yield (text, file) for all texts of the checks."""
    for file in (*sorted(CHECKS.glob("*.py")), HINTS):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in SPEAKS:
                for text in literals(node.args[0]):
                    yield text, f"{file.stem}.py"


def literals(node: ast.expr) -> Iterator[str]:
    """Yield the possible texts of an argument: a literal, or the literals of an if-expression."""
    if isinstance(node, ast.IfExp):
        yield from (*literals(node.body), *literals(node.orelse))
    elif isinstance(node, ast.Constant) and isinstance(node.value, str):
        if FIELD.sub("", node.value):
            yield node.value
    elif not (isinstance(node, ast.Name) and node.id == "text"):  # the parameter of a wrapper
        raise ValueError(f"line {node.lineno}: a text for the user must be a literal in the call that shows it")


def lesson(name: str) -> dict[str, Any]:
    """Return an English lesson."""
    notebook: dict[str, Any] = json.loads((NOTEBOOKS / f"{name}.ipynb").read_text(encoding="utf-8"))
    return notebook


def translated(notebook: dict[str, Any], language: str, translate: Translate) -> dict[str, Any]:
    """Return a lesson in another language: its texts, and the comments and texts in its code."""
    cells = []
    for cell in notebook["cells"]:
        text = "".join(cell["source"])
        if SOLUTION.search(text):
            text = SOLUTION.sub(lambda found: translate(found[0]), in_code(text, translate))
        elif cell["id"] == "lesson-progress":
            text = text.replace("progress()", f'progress("{language}")')
        else:
            text = translate(text) if cell["cell_type"] == "markdown" else in_code(text, translate)
        cells.append(cell | {"source": text.splitlines(keepends=True)})
    return notebook | {"cells": cells}


def in_code(text: str, translate: Translate) -> str:
    """Return code with its lines of words translated."""
    return "\n".join(translate(line) if has_words(line) else line for line in text.split("\n"))


def has_words(line: str) -> bool:
    """Return True if a line of code has words for the reader: a comment, or a text of words that is not a move."""
    return "# " in line or any(WORDS.search(text) and "->" not in text for text in TEXT.findall(line))


def all_texts() -> Catalog:
    """Return all texts to translate, with their files."""
    catalog = empty()
    for text, file in said_by_checks():
        catalog.add(text, locations=[(file, 0)], flags=["python-brace-format"] if "{" in text else [])
    for name in LESSONS:

        def gather(text: str, name: str = name) -> str:
            catalog.add(text, locations=[(f"{name}.ipynb", 0)])
            return text

        translated(lesson(name), "en", gather)
    return catalog


def empty(language: str | None = None) -> Catalog:
    """Return a catalogue without texts. Its head is the same in each run."""
    head = f"# What the lessons say, written by scripts/translate.py for translations into: {language}"
    return Catalog(language, None, head, "robowidgets", creation_date=EPOCH, revision_date=EPOCH, fuzzy=False)


def update(file: Path, english: Catalog) -> tuple[Catalog, list[str]]:
    """Return the catalogue of a language with all texts, and the texts without a translation."""
    with file.open("rb") as opened:
        held = read_po(opened, locale=file.stem)
    held.update(english)
    catalog = empty(file.stem)
    for message in english:
        if message.id:
            of = held.get(message.id)
            flags = message.flags | ({"fuzzy"} if of is not None and of.fuzzy else set())
            catalog.add(message.id, of.string if of else "", message.locations, flags)
    return catalog, [str(message.id) for message in catalog if message.id and (not message.string or message.fuzzy)]


def files_of(language: str, catalog: Catalog) -> dict[Path, bytes]:
    """Return the content of all files of a language."""

    def translate(text: str) -> str:
        message = catalog.get(text)
        return str(message.string) if message is not None and message.string else text

    po, mo = io.BytesIO(), io.BytesIO()
    write_po(po, catalog, width=110, include_lineno=False, ignore_obsolete=True)
    spoken = empty(language)
    for message in catalog:
        if message.id and any(str(file).endswith(".py") for file, _ in message.locations):
            spoken.add(message.id, message.string, flags=message.flags)
    write_mo(mo, spoken)
    # Remove headers with Babel's version, with plurals, which no text has, and with placeholder addresses.
    text = re.sub(rb'"(Generated-By|Plural-Forms|.*EMAIL@ADDRESS|.*li\.org).*\n', b"", po.getvalue())
    made = {TEXTS / f"{language}.po": text, TEXTS / f"{language}.mo": mo.getvalue()}
    for name in LESSONS:
        notebook = translated(lesson(name), language, translate)
        text = json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"
        made[NOTEBOOKS / language / f"{name}.ipynb"] = text.encode()
    return made


def main() -> int:
    """Write all files. Return 1 while a translation is missing."""
    english, missing = all_texts(), 0
    for file in sorted(TEXTS.glob("*.po")):
        catalog, lacks = update(file, english)
        for made, content in files_of(file.stem, catalog).items():
            made.parent.mkdir(exist_ok=True)
            made.write_bytes(content)
        missing += len(lacks)
        print(f"{file.stem}: {len(lacks)} of {len(english)} texts need a translation")
        for text in lacks:
            print(f"  {text.splitlines()[0]}")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
