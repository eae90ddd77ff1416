"""A page in a file: its text, its policy, its scripts, its parts of data, and its writing."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from html import escape
from numbers import Real
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

from ..notebook.progress import Progress, without_bars
from ..runtime.output_file import whole_file
from ..runtime.text import megabytes
from ..widget.front_end import STATIC, built_file
from .segments import compressed

SUFFIXES = (".html", ".htm")

MAX_SIZE = 50_000_000
"""The most bytes of a page, unless more are allowed."""

_SAMPLED = 40
"""The most segments that are packed to estimate the size of a page."""

_AROUND = 64
"""Bytes around a part."""

_BREAKS_OUT = ("</script", "<script", "<!--", "</style")
"""Texts that would end a script or a stylesheet in a page, or change its meaning."""

_MADE = "Made with robowidgets. This page loads nothing from the web, and sends nothing."
_NO_SCRIPT = "This page has not started: it needs a browser of 2023 or later that runs scripts."


MAIL_SIZE = 20_000_000
"""The size in bytes above which most mail servers refuse a file."""


class WrittenPage(type(Path())):  # type: ignore[misc]  # Python 3.10 needs the system's class of paths
    """The path of a written page. A notebook shows it as a link with its size."""

    def _repr_html_(self) -> str | None:
        if not self.is_file():
            return None
        try:
            link = quote(self.resolve().relative_to(Path.cwd()).as_posix())
        except ValueError:
            link = self.resolve().as_uri()
        size = self.stat().st_size
        mail = f" \u00b7 most mail refuses more than {megabytes(MAIL_SIZE)}" if size > MAIL_SIZE else ""
        return f'<a href="{escape(link)}" target="_blank">{escape(self.name)}</a> \u00b7 {megabytes(size)}{mail}'


class Heading(NamedTuple):
    """The texts on the page: title, facts, lines on problems, a note, and the first samples."""

    title: str
    facts: str
    problems: Sequence[str]
    note: str
    lines: Sequence[str]


class PageAssets(NamedTuple):
    """The scripts and stylesheets of a page."""

    styles: tuple[str, ...]
    scripts: tuple[str, ...]


class Page(NamedTuple):
    """A page that can be written.

    Args:
        heading: its texts.
        assets: its scripts and stylesheets, in addition to the loader.
        state: the part with its models; see `segments.compressed`.
        numbers: the numbers of its segments.
        segment: packs a segment, by its number.
        advice: a way to make it smaller, for the error if it is too large.
    """

    heading: Heading
    assets: PageAssets
    state: bytes
    numbers: range = range(0)
    segment: Callable[[int], bytes] = bytes
    advice: str = ""

    def size(self) -> int:
        """Return its size in bytes, estimated from some of its segments if there are many."""
        fixed = sum(map(len, self._pieces(())))
        step = -(-len(self.numbers) // _SAMPLED) or 1
        numbers = self.numbers[step // 2 :: step]
        with Progress(len(numbers), "Measuring the page", " parts") as bar, without_bars():
            some = []
            for number in numbers:
                some.append(len(self.segment(number)) + _AROUND)
                bar.update(1)
        return fixed + round(sum(some) / max(1, len(some)) * len(self.numbers))

    def write(self, path: Path, max_size: int | None = MAX_SIZE) -> Path:
        """Write it, completely or not at all, and return the path.

        Raises:
            ValueError: it would take more than ``max_size`` bytes (None allows any size). OSError: the file cannot be
                written.
        """
        if max_size is not None and len(self.numbers) > _SAMPLED:
            self._check(self.size(), path, max_size)
        size = 0
        try:
            with whole_file(path) as file:
                for piece in self._pieces(self._segments()):
                    file.write(piece)
                    size += len(piece)
                    if max_size is not None:
                        self._check(size, path, max_size, "more than ")
        except OSError as error:
            raise type(error)(f"{path} was not written: {error.strerror or error}") from None
        return WrittenPage(path)

    def _segments(self) -> Iterator[bytes]:
        """Yield all segments, with a progress bar."""
        with Progress(len(self.numbers), "Writing the page", " parts") as bar:
            for number in self.numbers:
                with without_bars():
                    segment = self.segment(number)
                yield segment
                bar.update(1)

    def _pieces(self, segments: Iterable[bytes]) -> Iterator[bytes]:
        """Yield the page piece by piece, with these segments.

        Its policy allows only the scripts and stylesheets in it, by their hashes, and no requests. Everything from a
        recording is escaped text in it, or packed.
        """
        heading, assets = self.heading, self.assets
        style, loader = static("export_loader.css"), static("export_loader.js")
        scripts, styles = (loader, *assets.scripts), (style, *assets.styles)
        policy = "; ".join(
            (
                "default-src 'none'",
                f"script-src {' '.join(map(_source, scripts))}",
                f"style-src {' '.join(map(_source, styles))}",
                "img-src data: blob:",
                "connect-src 'none'",
                "base-uri 'none'",
                "form-action 'none'",
            )
        )
        texts = [("style", t.encode()) for t in assets.styles] + [("script", t.encode()) for t in assets.scripts]
        packed = compressed({"texts": [[tag, len(text)] for tag, text in texts]}, [text for _, text in texts])
        yield f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(heading.title)}</title>
<link rel="icon" href="data:,">
<style>{style}</style>
</head>
<body>
<header>
<h1>{escape(heading.title)}</h1>
<p class="rw-page-facts">{escape(heading.facts)}</p>
{_lines(heading)}</header>
<main></main>
<section class="rw-page-text"><p class="rw-page-why">{_NO_SCRIPT}</p><pre>{escape(chr(10).join(heading.lines))}</pre>\
</section>
<footer class="rw-page-end"><div class="rw-page-data"></div><span>{_MADE}</span></footer>
""".encode("utf-8", "replace")  # file names may not be valid UTF-8
        yield _part("program", packed)
        yield _part("page", self.state)
        for segment in segments:
            yield _part("segment", segment)
        yield f"<script>{loader}</script>\n</body>\n</html>\n".encode()

    def _check(self, size: int, path: Path, max_size: int, about: str = "about ") -> None:
        if size > max_size:
            raise ValueError(
                f"{path.name} would take {about}{megabytes(size)}, and at most {megabytes(max_size)} are allowed: "
                f"{self.advice}, or allow more (max_size={-(-2 * size // 10**6) * 10**6:_})"
            )


def check_texts(title: Any, note: Any, max_size: Any = None) -> None:
    """Raise TypeError for a title or a note that is not a text, or a size that is neither a number nor None.

    A size that is not above 0 raises ValueError.
    """
    for name, value in (("title", title), ("note", note)):
        if not isinstance(value, str | None):
            raise TypeError(f"to_html(): expected {name} as a text, got {value!r}")
    if max_size is not None and (isinstance(max_size, bool) or not isinstance(max_size, Real)):
        raise TypeError(f"to_html(): expected max_size in bytes, such as 50_000_000, or None, got {max_size!r}")
    if max_size is not None and not float(max_size) > 0:
        raise ValueError(f"to_html(): expected max_size above 0, got {max_size!r}")


def static(name: str) -> str:
    """Return a built file of exported pages.

    Raises:
        ImportError: the file is missing.
    """
    return inlined(built_file(STATIC / name).read_text(encoding="utf-8"), name)


def inlined(text: str, name: str) -> str:
    """Return a script or stylesheet that can be put into a page unchanged, or raise ValueError with its name."""
    found = next((word for word in _BREAKS_OUT if word in text.lower()), None)
    if found:
        raise ValueError(f"{name} contains {found!r}, which no script or stylesheet of an exported page may")
    return text


def _lines(heading: Heading) -> str:
    problems = "".join(f'<p class="rw-page-problems">⚠ {escape(line)}</p>\n' for line in heading.problems)
    return problems + (f'<p class="rw-page-note">{escape(heading.note)}</p>\n' if heading.note else "")


def _part(kind: str, packed: bytes) -> bytes:
    return b'<script type="text/plain" data-part="%b">%b</script>\n' % (kind.encode(), packed)


def _source(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
