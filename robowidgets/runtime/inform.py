"""Notes to the user on events that are not errors."""

from __future__ import annotations

import logging

from .error_routing import ipython_shell

log = logging.getLogger("robowidgets")


def inform(text: str) -> None:
    """Print a text in a notebook, which shows each log line like an error; log it elsewhere."""
    if ipython_shell() is not None and not log.isEnabledFor(logging.INFO):
        print(text)  # noqa: T201
    else:
        log.info(text)
