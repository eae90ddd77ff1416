"""The signal handlers of rclpy, as in its C code.

`rclpy.init()` sets handlers of SIGINT and SIGTERM. They call the previous handler, unless it is the default, and
shut down every context of the process; they do not end it. Python does not know them: `signal.getsignal` returns the
previous handler. If a program sets its own later, it replaces theirs, but rclpy still reports them as installed.
"""

from __future__ import annotations

import signal
from collections.abc import Callable
from enum import Enum
from types import SimpleNamespace
from typing import Any

import pytest


class SignalHandlerOptions(Enum):
    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


_NUMBERS = {SignalHandlerOptions.SIGINT: signal.SIGINT, SignalHandlerOptions.SIGTERM: signal.SIGTERM}


class Signals:
    """Return the module `rclpy.signals`; `shut_down` ends every context of the process."""

    def __init__(self, shut_down: Callable[[], None], monkeypatch: pytest.MonkeyPatch) -> None:
        self._shut_down = shut_down
        self._before: dict[int, Any] = {}
        self._set, self._get = signal.signal, signal.getsignal
        monkeypatch.setattr(signal, "getsignal", self._known)
        monkeypatch.setattr(signal, "signal", self._replace)
        self.module = SimpleNamespace(
            SignalHandlerOptions=SignalHandlerOptions,
            install_signal_handlers=self.install,
            uninstall_signal_handlers=self.uninstall,
            get_current_signal_handlers_options=self.current,
        )

    def current(self) -> SignalHandlerOptions:
        return SignalHandlerOptions(sum(option.value for option, number in _NUMBERS.items() if number in self._before))

    def install(self, options: SignalHandlerOptions) -> None:
        for option, number in _NUMBERS.items():
            if option.value & options.value and number not in self._before:
                self._before[number] = self._set(number, self._on_signal)

    def uninstall(self) -> None:
        for number in list(self._before):
            if self._get(number) == self._on_signal:
                self._set(number, self._before.pop(number))

    def _on_signal(self, number: int, frame: Any) -> None:
        self._shut_down()
        before = self._before[number]
        if callable(before):
            before(number, frame)

    def _known(self, number: int) -> Any:
        return self._before[number] if self._get(number) == self._on_signal else self._get(number)

    def _replace(self, number: int, handler: Any) -> Any:
        known = self._known(number)
        self._set(number, handler)
        return known
