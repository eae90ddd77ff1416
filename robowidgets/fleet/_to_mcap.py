"""Each hit as an MCAP file of its own."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from ..files.remote import is_url
from ..notebook.progress import Progress, without_bars
from ..recording import open as open_recording
from ..recordings.cut import cut
from ..repair import SUFFIX
from ..samples.checks import not_negative
from ._fleet_table import short
from ._hit import Hit


def write(hits: Sequence[Hit], folder: str | os.PathLike[str], around: float, overwrite: bool) -> list[Path]:
    """See `Hits.to_mcap`."""
    if not isinstance(folder, (str, os.PathLike)):
        raise TypeError(f"to_mcap(): expected the path of a folder, got {folder!r}")
    margin = round(not_negative("around", around, "seconds") * 1e9)
    target = Path(os.path.realpath(Path(os.fsdecode(folder)).expanduser()))
    if not hits:
        raise ValueError(f"to_mcap(): nothing was found, so there is nothing to write into {str(target)!r}")
    if target.exists() and not target.is_dir():
        raise NotADirectoryError(f"to_mcap(): {str(target)!r} is a file; name a folder, with a file for each hit in it")
    paths = [target / name for name in _names(hits)]
    there = [path for path in paths if path.exists()]
    if there and not overwrite:
        raise FileExistsError(
            f"to_mcap(): {str(there[0])!r} exists, {len(there)} of {len(paths)} files; "
            "name another folder, or give overwrite=True"
        )
    target.mkdir(parents=True, exist_ok=True)
    by_file: dict[str, list[tuple[Hit, Path]]] = {}
    for hit, path in zip(hits, paths, strict=True):
        by_file.setdefault(hit.file, []).append((hit, path))
    with Progress(len(hits), "Cutting", " files") as bar, without_bars():
        for file, own in by_file.items():
            with open_recording(file) as recording:
                for hit, path in own:
                    # A nanosecond later, because a span that lasts to the end includes the last sample.
                    span = hit.start_ns - margin, hit.end_ns + margin + 1
                    cut(recording.source, recording.path, "to_mcap", path, span, overwrite)
                    bar.update(1)
    return paths


def _names(hits: Sequence[Hit]) -> list[str]:
    """Return the name of the file for each hit: its recording, and its start in seconds."""
    names = short([hit.file for hit in hits])
    found: list[str] = []
    count: Counter[str] = Counter()
    for hit in hits:
        name = hit.file.rpartition("/")[2] if is_url(hit.file) else names[hit.file]
        stem = SUFFIX.sub("", name).replace(os.sep, "_").replace("/", "_")
        stem = f"{stem}_{hit.start:.3f}s"
        count[stem] += 1
        found.append(f"{stem}.mcap" if count[stem] == 1 else f"{stem}_{count[stem]}.mcap")
    return found
