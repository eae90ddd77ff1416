"""The command ``robowidgets repair``: a new file with the messages of a recording, without its faults."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

from ..files import open_source
from ..files.remote import fetch
from ..recordings.ring import is_black_box, recover
from ..repair.write import write
from ..runtime.text import many, megabytes
from ._error import CommandError

_PACKED = (".gz", ".zst", ".zstd", ".active")
_SUFFIXES = (".bag", ".clf", ".db3", ".log", ".mcap")


def repair(file: Path | str, output: Path | None, *, force: bool) -> Iterator[str]:
    """Write a recording as an MCAP file, or what killed kernels have left in the folder of a black box.

    Args:
        file: the recording, its URL, or the folder of a black box.
        output: the MCAP file, or None for a file with ``_repaired`` at the end of its name: in the folder of the
            recording, or in the working directory for a URL.
        force: True to replace an existing file.

    Returns:
        Lines about the faults, and about the written file, as soon as they are known.

    Raises:
        RecordingError: nothing can be read, or the file cannot be written.
        OSError: the output already exists, or belongs to the recording.
        CommandError: the name of the output does not end in .mcap, or a folder of a black box has names of its own.
    """
    if isinstance(file, str):
        fetched = fetch(file)
        try:
            yield from repair(fetched.path, output or Path(_beside(fetched.path).name), force=force)
        finally:
            fetched.close()
        return
    recording = file.absolute().parent if file.name == "metadata.yaml" else file
    if recording.is_dir() and is_black_box(recording):
        yield from _repair_black_box(recording, output)
        return
    output = _beside(recording) if output is None else output
    _check(recording, output, force)
    with closing(open_source(recording)) as source:
        opened = source.problems
        yield from (f"! {line}" for line in opened)
        written = write(source, output)
        problems = (*(line for line in source.problems if line not in opened), *written.problems)
    yield from (f"! {line}" for line in problems)
    if not (*opened, *problems):
        yield f"Nothing is wrong with {recording}"
    amount = f"{many(written.messages, 'message')}, {written.seconds:,.1f} s, {megabytes(written.size)}"
    yield f"Wrote {output}: {amount}"


def _repair_black_box(folder: Path, output: Path | None) -> Iterator[str]:
    if output is not None:
        raise CommandError("--output: the files of a black box have names of their own; leave it out")
    written, problems = recover(folder)
    yield from (f"Wrote {path}" for path in written)
    if problems:
        raise CommandError("; ".join(problems))
    if not written:
        yield f"Nothing is left to write in {folder}: no kernel has ended without closing its black box"


def _beside(recording: Path) -> Path:
    name = recording.absolute().name
    for suffixes in (_PACKED, _SUFFIXES):
        name = next((name.removesuffix(suffix) for suffix in suffixes if name.endswith(suffix)), name)
    return recording.absolute().with_name(f"{name}_repaired.mcap")


def _check(recording: Path, output: Path, force: bool) -> None:
    target, source = Path(os.path.realpath(output)), Path(os.path.realpath(recording))
    if target == source or (recording.is_dir() and target.parent == source):
        raise FileExistsError(f"{output}: is part of the recording itself; name another file with --output")
    if output.is_dir():
        raise IsADirectoryError(f"{output}: is a folder; name a file with --output")
    if output.suffix.lower() != ".mcap":
        raise CommandError(f"--output: expected a name that ends in .mcap, got '{output}'")
    if output.exists() and not force:
        raise FileExistsError(f"{output}: already exists; replace it with --force, or name another with --output")
