"""What the checks say, in the language of the lesson.

English stands in the code. `scripts/translate.py` gathers it, and compiles its translations, `texts/*.po`.
"""

from __future__ import annotations

import gettext
from pathlib import Path
from typing import Any

ENGLISH = "en"
TEXTS = Path(__file__).with_name("texts")

_spoken: gettext.NullTranslations = gettext.NullTranslations()


def languages() -> list[str]:
    """The languages of the lessons, as their codes."""
    return sorted([ENGLISH, *(file.stem for file in TEXTS.glob("*.mo"))])


def speak(language: str) -> None:
    """Have `say` speak a language from now on.

    Raises:
        ValueError: the lessons are not written in it.
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
    """A text in the language of the lesson.

    Args:
        text: English, as a literal, with fields as of `str.format`.
        values: of the fields.
    """
    return _spoken.gettext(text).format(**values)
