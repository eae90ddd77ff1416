"""Nodes of rclpy, and who spins them. rclpy is imported when it is used."""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

log = logging.getLogger("robowidgets")

FREE = 2.0
"""Seconds for which a program must have let go of its node before it is spun for it again."""


class Held:
    """A node that is spun while nobody else does: the program may take its own back at any time."""

    def __init__(self, node: Any) -> None:
        from rclpy.executors import SingleThreadedExecutor

        self.node = node
        self.executor = SingleThreadedExecutor(context=node.context)
        self._free_since: float | None = None

    def __enter__(self) -> Held:
        return self

    def __exit__(self, *_: object) -> None:
        if self.node.executor is self.executor:
            self.node.executor = None
        self.executor.shutdown()

    def spin_once(self, seconds: float) -> Exception | None:
        """Do what is due, or wait for it. A node that the program spins is left to it.

        Returns:
            What a callback raised, or rclpy for a message that it cannot read; both stop nothing else.
        """
        taken = self._take()
        try:
            self.executor.spin_once(timeout_sec=seconds)
        except Exception as error:
            if not self.node.context.ok():
                raise
            if taken and self.node not in self.executor.get_nodes():
                # rclpy keeps in each event of a node its place in one executor's list, and finds another's there.
                log.debug("the program spins its node again", exc_info=True)
                return None
            return error
        return None

    def _take(self) -> bool:
        """Take the node if nobody spins it; says whether it is ours."""
        spins = self.node.executor  # the last one that had it, which may have let go of it
        if spins is not None and self.node in spins.get_nodes():
            self._free_since = None
            return spins is self.executor
        now = time.monotonic()
        if self._free_since is None:
            self._free_since = now
        # `rclpy.spin_once` lets go of a node between two calls.
        if spins is not None and now - self._free_since < FREE:
            return False
        self.executor.add_node(self.node)
        return True


@contextmanager
def own_node(domain_id: int | None) -> Iterator[Held]:
    """A node of ours, in a context of its own that leaves Ctrl-C to the notebook."""
    import rclpy
    from rclpy.context import Context
    from rclpy.signals import SignalHandlerOptions

    context = Context()
    rclpy.init(args=[], context=context, domain_id=domain_id, signal_handler_options=SignalHandlerOptions.NO)
    try:
        node = rclpy.create_node(f"robowidgets_{os.getpid()}", context=context, use_global_arguments=False)
        try:
            with Held(node) as held:
                yield held
        finally:
            node.destroy_node()
    finally:
        context.try_shutdown()
