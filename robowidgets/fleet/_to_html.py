"""The contact sheet as one page in a file that plays each hit."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..export.html import Heading, Page, PageAssets, check_texts
from ..export.models import Models
from ..notebook.cells import close_all
from ..notebook.progress import Progress, without_bars
from ..recording import open as open_recording
from ..recordings.search.base import Condition
from ..runtime.text import many, megabytes
from ..samples.checks import not_negative
from ..screens.player import Player
from ..sheet_widget import SheetWidget
from ._hit import Hit
from ._pictures import pictures

_LINES = 12


def write(
    hits: Sequence[Hit],
    widget: SheetWidget,
    wanted: Condition | None,
    target: Path,
    around: float,
    title: str,
    note: str,
    max_size: int | None,
) -> Path:
    """See `Hits.to_html`."""
    check_texts(title, note, max_size)
    around = not_negative("around", around, "seconds")
    if not hits:
        raise ValueError(f"{target.name}: nothing was found, so there is nothing to play")
    by_file: dict[str, dict[int, Hit]] = {}
    for number, hit in enumerate(hits):
        by_file.setdefault(hit.file, {})[number] = hit
    parts: list[bytes] = []
    packed: list[bytes] = []
    places: dict[str, list[int]] = {}
    assets: list[PageAssets] = []
    size = 0
    with Progress(len(hits), "Writing the page", " moments") as bar, without_bars():
        for file, of_file in by_file.items():
            player = Player(open_recording(file), scanogram=False)
            try:
                player.marks = [(hit.start, hit.end, "") for hit in of_file.values()]
                packed += pictures(player.recording, of_file, wanted)
                end = player.duration
                moments = [
                    (max(0.0, hit.start - around), min(end, hit.end + around), hit.moment) for hit in of_file.values()
                ]
                for number, page in zip(of_file, player.pages(moments), strict=True):
                    own = [page.state, *(page.segment(one) for one in page.numbers)]
                    places[str(number)] = [len(parts), len(own) - 1]
                    parts += own
                    assets.append(page.assets)
                    size += sum(map(len, own))
                    _check(size, target, len(places), len(hits), max_size)
                    bar.update(1)
            finally:
                close_all(player)
    models = Models()
    models.add(widget, {"_pictures": b"".join(packed), "picked": None, "_opened": None, "_status": ""})
    state = models.part(
        widget.model_id, player="", scanogram=None, begin=0.0, name=target.stem, sheet=widget.model_id, moments=places
    )
    facts = f"{many(len(hits), 'moment')} in {many(len(by_file), 'file')}, each with {around:g} s around it"
    lines = [f"{hit.file}  {hit.start:.3f} to {hit.end:.3f} s" for hit in hits[:_LINES]]
    page = Page(
        Heading(title or widget.condition, facts, (), note, lines),
        _together([*assets, models.assets()]),
        state,
        range(len(parts)),
        parts.__getitem__,
        _ADVICE,
    )
    return page.write(target, max_size)


_ADVICE = "take fewer hits (hits[:50].to_html(...)), or less around each (around=1)"


def _together(assets: Sequence[PageAssets]) -> PageAssets:
    """Join the assets of all pages, each once; last the script that builds the page."""
    last = assets[-1].scripts[-1]
    styles = dict.fromkeys(style for one in assets for style in one.styles)
    scripts = dict.fromkeys(script for one in assets for script in one.scripts if script != last)
    return PageAssets(tuple(styles), (*scripts, last))


def _check(size: int, target: Path, done: int, count: int, max_size: int | None) -> None:
    """Raise ValueError as soon as it is clear that a page gets too large."""
    if max_size is not None and size > max_size:
        whole = round(size / done * count)
        raise ValueError(
            f"{target.name} would take about {megabytes(whole)}, and at most {megabytes(max_size)} are allowed: "
            f"{_ADVICE}, or allow more (max_size={-(-2 * whole // 10**6) * 10**6:_})"
        )
