"""Detecting nodes that have ended without unregistering. A ROS 1 master lists them until ``rosnode cleanup``."""

from __future__ import annotations

import threading
from collections.abc import Callable, Collection

from ._ros1_master import Master


class Presence:
    """A check if nodes are still alive. It runs in a short-lived thread, because each node may take a while to answer.

    Args:
        master: the master that knows their addresses.
        on_change: called in that thread if the set of ended nodes has changed.

    Attributes:
        ended: the names of the nodes that have ended.
    """

    def __init__(self, master: Master, on_change: Callable[[], object]) -> None:
        self._master, self._on_change = master, on_change
        self._is_asking = False
        self.ended: frozenset[str] = frozenset()

    def look(self, nodes: Collection[str]) -> None:
        """Check these nodes, unless a check is running."""
        if not nodes:
            self.ended = frozenset()
        elif not self._is_asking:
            self._is_asking = True
            threading.Thread(target=self._ask, args=(nodes,), name="robowidgets-nodes", daemon=True).start()

    def _ask(self, nodes: Collection[str]) -> None:
        try:
            before, self.ended = self.ended, frozenset(filter(self._master.has_ended, nodes))
        finally:
            self._is_asking = False
        if self.ended != before:
            self._on_change()
