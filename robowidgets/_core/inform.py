"""Telling a person what happened, where it is no fault."""

from __future__ import annotations

import logging

from .error_routing import ipython_shell

log = logging.getLogger("robowidgets")


def inform(text: str) -> None:
    """Print a text in a notebook, where all that is logged looks like an error, and log it elsewhere."""
    if ipython_shell() is not None and not log.isEnabledFor(logging.INFO):
        print(text)  # noqa: T201
    else:
        log.info(text)
