"""Who holds a drive pad, and whether what comes from there is fresh."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any, NamedTuple

from ._dead_man import HOLD

_LONGEST_NAME = 64


class Said(NamedTuple):
    """A message of the page: what was done in which press, and where the knob is."""

    act: str
    press: str
    token: int = 0
    forward: float = 0.0
    turn: float = 0.0


def to_said(content: Any) -> Said:
    """What a message of the page says; the page is not trusted.

    ``act`` is press, hold or release; ``forward`` (ahead above 0) and ``turn`` (to the left above 0) are shares of the
    limits, within +-1.

    Raises:
        ValueError: anything else.
    """
    try:
        said = Said(**content)
    except TypeError:
        raise ValueError(f"expected a message of the pad, got {repr(content)[:200]}") from None
    if said.act not in ("press", "hold", "release"):
        raise ValueError(f"act: expected press, hold or release, got {said.act!r}")
    if not isinstance(said.press, str) or len(said.press) > _LONGEST_NAME:
        raise ValueError(f"press: expected the name of a press, got {said.press!r}")
    if type(said.token) is not int:
        raise ValueError(f"token: expected a whole number, got {said.token!r}")
    for name in ("forward", "turn"):
        share = getattr(said, name)
        if type(share) not in (int, float) or not -1 <= share <= 1:
            raise ValueError(f"{name}: expected a share of the limit within -1 and 1, got {share!r}")
    return said


class Grip:
    """The press that holds the pad, and the tokens by which it proves that it is fresh.

    Every answer to the page carries a token, and every speed from the page must carry one back that is not older than
    a speed holds. So a speed is never older than that, however long messages waited and whatever clock the page has.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._lock = threading.Lock()
        self._press = ""
        self._issued: dict[int, float] = {}
        self._last = 0

    @property
    def press(self) -> str:
        """The press that holds the pad; empty when nobody does."""
        return self._press

    def take(self, press: str) -> int:
        """Let a press hold the pad instead of any other; its first token."""
        with self._lock:
            self._press = press
            self._issued.clear()
            return self._issue()

    def renew(self, press: str, token: int) -> int | None:
        """The next token for a fresh one of the press that holds the pad; None for any other."""
        with self._lock:
            oldest = self._clock() - HOLD
            self._issued = {token: at for token, at in self._issued.items() if at > oldest}
            return self._issue() if press == self._press and token in self._issued else None

    def let_go(self) -> None:
        """Let nobody hold the pad."""
        with self._lock:
            self._press = ""
            self._issued.clear()

    def _issue(self) -> int:
        self._last += 1
        self._issued[self._last] = self._clock()
        return self._last
