"""Counts patterns of words that are hard to read in comments, docstrings, messages, docs and names of functions.

python scripts/words.py            fails if a pattern stands more often than `MOST` allows
python scripts/words.py PATH ...   lists every place in these files and folders
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import tokenize
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
SUFFIXES = {".py", ".ts", ".mjs", ".md"}
EXEMPT = ("CHANGELOG.md", "tests/unit/test_names.py", "scripts/words.py")


class Pattern(NamedTuple):
    """Words to avoid."""

    name: str
    regex: re.Pattern[str]
    better: str
    docstring_start: bool = False


def _pattern(name: str, regex: str, better: str, *, docstring_start: bool = False) -> Pattern:
    return Pattern(name, re.compile(regex, re.IGNORECASE), better, docstring_start)


PATTERNS = (
    _pattern("Whether", r"\AWhether\b", '"Return True if ...", or "True while ..."', docstring_start=True),
    _pattern("What", r"\A(What|Where|When|Who|Whose|How)\b", "the noun: The fields on show", docstring_start=True),
    _pattern("where it", r"\bwhere (it|one|none|there|they|a person|somebody|nobody)\b", '"if"'),
    _pattern(
        "is no",
        r"\b(is|are|was|were) (none|nobody|no (?!(longer|more|less|good|way|need|problem|sense|use|matter)\b))"
        r"|\bnone (has|have|comes|came|is|are|was|were|does|do)\b",
        '"is not a ...", "no sample ..."',
    ),
    _pattern(
        "that of",
        r"\b(that|those) of\b|\bof (what|which|whose|one that|ones that|those that|those who|that which)\b",
        "repeat the noun, or two sentences",
    ),
    _pattern("; None:", r"; (None|empty|0|nothing|negative|an empty \w+):", '"..., or None if ..."'),
    _pattern("beside", r"\bbesides?\b", '"next to", "near", "with", "while"'),
    _pattern("told", r"\b(told|tells? of|says? of|said|tell apart)\b", "report, contain, show"),
    _pattern(
        "somebody", r"\b(somebody|someone|nobody|a person|whoever|who(?= \w+s ))\b", "the user, a node, no subscriber"
    ),
    _pattern("as far as", r"\b(as far as|in place of|anew)\b", '"the part that", "instead of", "again"'),
    _pattern("_of", r"\A\w+_of\Z", "a function: `get_`, `make_`, `parse_`, or the noun"),
    _pattern("Have X done", r"\A(Have|Let) (?!us\b)", "the plain verb", docstring_start=True),
)


MOST = {
    "where it": 25,
    "is no": 90,
    "that of": 30,
    "; None:": 1,
    "beside": 42,
    "told": 72,
    "somebody": 42,
    "as far as": 9,
    "_of": 290,
}
"""The most places of each pattern, mostly names in code and messages in tests; none of the others."""


class Text(NamedTuple):
    """A text of a file."""

    path: str
    line: int
    text: str
    is_docstring: bool = False


def main(arguments: list[str]) -> bool:
    """Print the places or the counts, and return True if a pattern stands too often."""
    paths = [str(Path(one).resolve().relative_to(ROOT)) for one in arguments]
    found = [(pattern, *hit) for text in texts(paths) for pattern in PATTERNS for hit in hits(pattern, text)]
    if paths:
        for pattern, where, words in found:
            print(f"{where}: {words!r}, better {pattern.better}")
    counts = Counter(pattern.name for pattern, *_ in found)
    print(", ".join(f"{pattern.name!r} {counts[pattern.name]}" for pattern in PATTERNS), "sum", sum(counts.values()))
    too_many = [pattern for pattern in PATTERNS if not paths and counts[pattern.name] > MOST.get(pattern.name, 0)]
    for pattern in too_many:
        print(f"more than {MOST.get(pattern.name, 0)} of {pattern.name!r}: better {pattern.better}")
    return bool(too_many)


def hits(pattern: Pattern, text: Text) -> Iterator[tuple[str, str]]:
    """The places of a pattern in a text, and the words around it."""
    if pattern.docstring_start and not text.is_docstring:
        return
    for match in pattern.regex.finditer(text.text):
        line = text.line + text.text.count("\n", 0, match.start())
        around = text.text[max(0, match.start() - 25) : match.end() + 25]
        yield f"{text.path}:{line}", " ".join(around.split())


def texts(paths: list[str]) -> Iterator[Text]:
    """The texts of the files of the project, or of some of them."""
    listed = subprocess.run(["git", "ls-files", *paths], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    for name in listed.splitlines():
        path = ROOT / name
        if path.suffix not in SUFFIXES or name.startswith(EXEMPT) or not path.exists():
            continue
        if path.suffix == ".py":
            yield from _python(name, path)
        elif path.suffix == ".md":
            yield Text(name, 1, _without_code(path.read_text()))
        else:
            yield from _script(name, path.read_text())


def _python(name: str, path: Path) -> Iterator[Text]:
    docstrings = set()
    for node in ast.walk(ast.parse(path.read_text())):
        body = getattr(node, "body", None)
        for one in body if isinstance(body, list) else ():
            if isinstance(one, ast.Expr) and isinstance(one.value, ast.Constant) and isinstance(one.value.value, str):
                docstrings.add(one.value)
                yield Text(name, one.lineno, one.value.value, is_docstring=True)
        if isinstance(node, ast.FunctionDef) and node.name.endswith("_of"):
            yield Text(name, node.lineno, node.name)
        is_text = isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in docstrings
        if is_text and node.value.count(" ") >= 2:
            yield Text(name, node.lineno, node.value)
    with tokenize.open(path) as file:
        for token in tokenize.generate_tokens(file.readline):
            if token.type == tokenize.COMMENT:
                yield Text(name, token.start[0], token.string)


_IN_SCRIPT = re.compile(r"""/\*\*?(.*?)\*/|(?<![:"'`\w])//([^\n]*)|["'`]([^"'`\n]* [^"'`\n]* [^"'`\n]*)["'`]""", re.S)
"""Comments and texts of several words."""


def _script(name: str, code: str) -> Iterator[Text]:
    for match in _IN_SCRIPT.finditer(code):
        text = next(group for group in match.groups() if group is not None)
        text = re.sub(r"^\s*\* ?", lambda found: " " * len(found[0]), text, flags=re.M) if match[1] else text
        is_docstring = match[1] is not None
        yield Text(name, code.count("\n", 0, match.start()) + 1, text.lstrip() if is_docstring else text, is_docstring)


def _without_code(text: str) -> str:
    """The text of a page without its code, line by line."""
    text = re.sub(r"^```.*?^```", lambda block: "\n" * block[0].count("\n"), text, flags=re.M | re.S)
    return re.sub(r"`[^`\n]*`", "`_`", text)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
