"""Write all looks again, as texts and pictures: `python -m tests.looks`; or those whose names begin in some ways."""

from __future__ import annotations

import sys

from . import draw, every, file_of, pictures


def main(starts: list[str]) -> None:
    """Write the looks whose names begin in one of these ways."""
    looks = {name: look for name, look in every().items() if name.startswith(tuple(starts or [""]))}
    for name, text in zip(looks, draw(looks.values()), strict=True):
        file_of(name).parent.mkdir(exist_ok=True)
        file_of(name).write_text(text, "utf-8")
    pictures.write(looks, [file_of(name).with_suffix(".png") for name in looks])


if __name__ == "__main__":
    main(sys.argv[1:])
