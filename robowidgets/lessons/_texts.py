"""The texts of the checks, in the language of the lesson.

The code contains the English texts. `scripts/translate.py` collects them, and compiles the translations, `texts/*.po`.
"""

from __future__ import annotations

import gettext
from pathlib import Path
from typing import Any

ENGLISH = "en"
TEXTS = Path(__file__).with_name("texts")

_spoken: gettext.NullTranslations = gettext.NullTranslations()


def languages() -> list[str]:
    """Return the codes of the languages of the lessons."""
    return sorted([ENGLISH, *(file.stem for file in TEXTS.glob("*.mo"))])


def speak(language: str) -> None:
    """Set the language of `say`.

    Raises:
        ValueError: the lessons are not available in this language.
    """
    global _spoken
    if language not in languages():
        raise ValueError(f"no lesson is written in the language {language!r}; there are {', '.join(languages())}")
    if language == ENGLISH:
        _spoken = gettext.NullTranslations()
        return
    with (TEXTS / f"{language}.mo").open("rb") as file:
        _spoken = gettext.GNUTranslations(file)


def say(text: str, **values: Any) -> str:
    """Return a text in the language of the lesson.

    Args:
        text: English, as a literal, with fields as in `str.format`.
        values: the values of the fields.
    """
    return _spoken.gettext(text).format(**values)
