"""Messages of a page that drives or stops a robot: their check, their age, and the press that holds a pad."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any, NamedTuple

from .command_watchdog import ASSISTANT, HOLD, PROGRAM

_ACTS = ("press", "hold", "release", "stop", "allow", "beat")
_LONGEST_NAME = 64


class PadMessage(NamedTuple):
    """A message of the page: the act, the press (or view) that sent it, and the position of the knob."""

    act: str
    press: str
    token: int = 0
    forward: float = 0.0
    turn: float = 0.0
    lateral: float = 0.0


def to_pad_message(content: Any) -> PadMessage:
    """Check a message of the page, which is untrusted.

    ``act`` is press, hold or release; or stop, allow (driving again) or beat (the page is alive), which need no press.
    ``forward`` (ahead above 0), ``turn`` and ``lateral`` (to the left above 0) are shares of the limits, within +-1.

    Raises:
        ValueError: the message is not valid.
    """
    try:
        message = PadMessage(**content)
    except TypeError:
        raise ValueError(f"expected a message of the pad, got {repr(content)[:200]}") from None
    if message.act not in _ACTS:
        raise ValueError(f"act: expected {', '.join(_ACTS[:-1])} or {_ACTS[-1]}, got {message.act!r}")
    name = message.press
    if not isinstance(name, str) or name in ("", PROGRAM, ASSISTANT) or len(name) > _LONGEST_NAME:
        raise ValueError(f"press: expected the name of a press, got {name!r}")
    if type(message.token) is not int:
        raise ValueError(f"token: expected a whole number, got {message.token!r}")
    for field in ("forward", "turn", "lateral"):
        share = getattr(message, field)
        if type(share) not in (int, float) or not -1 <= share <= 1:
            raise ValueError(f"{field}: expected a share of the limit within -1 and 1, got {share!r}")
    return message


class Tokens:
    """Numbers that the page receives and returns with its next message, as a proof of the age of the message.

    A message is as fresh as the token in it, so the clock of the page does not matter.
    """

    def __init__(self, lifetime: float, clock: Callable[[], float] = time.monotonic) -> None:
        self._lifetime, self._clock = lifetime, clock
        self._lock = threading.Lock()
        self._issued: dict[int, float] = {}
        self._last = 0

    def issue(self) -> int:
        """Return a new token."""
        with self._lock:
            self._forget_old()
            self._last += 1
            self._issued[self._last] = self._clock()
            return self._last

    def is_fresh(self, token: int) -> bool:
        """Return True if a token was issued within the lifetime."""
        with self._lock:
            self._forget_old()
            return token in self._issued

    def _forget_old(self) -> None:
        oldest = self._clock() - self._lifetime
        self._issued = {token: at for token, at in self._issued.items() if at > oldest}


class PressLease:
    """The press that holds a pad, and the reason why the previous one ended.

    Each speed of a press must carry a fresh token. So no speed is older than `HOLD`, even if messages were delayed.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._tokens = Tokens(HOLD, clock)
        self._ended = ("", "")
        self.press = ""
        """The press that holds the pad, or empty."""

    def take(self, press: str) -> int:
        """Give the pad to a press instead of any other. Return its first token."""
        self.press, self._tokens = press, Tokens(HOLD, self._clock)
        return self._tokens.issue()

    def renew(self, press: str, token: int) -> int | None:
        """Return the next token for a fresh token of the press that holds the pad, or None for any other."""
        return self._tokens.issue() if press == self.press and self._tokens.is_fresh(token) else None

    def end(self, why: str) -> str:
        """End the press that holds the pad, for a reason. Return its name, or empty if no press held the pad."""
        press, self.press = self.press, ""
        if press:
            self._ended = (press, why)
        return press

    def why_over(self, press: str) -> str:
        """Return the reason why a press no longer holds the pad."""
        if press == self._ended[0]:
            return self._ended[1]
        return "taken" if self.press not in ("", press) else "late"
