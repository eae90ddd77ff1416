"""Pages read ahead, on the other core, while the last one is worked on."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import chain, islice
from typing import TypeVar

THREADS = 2
"""Neither reading nor decompressing nor a checksum holds Python's lock: two threads keep two cores busy."""

T = TypeVar("T")


def read_ahead(pages: Iterator[Callable[[], T]]) -> Iterator[T]:
    """What each page gives, in their order. Raises what reading a page raised, when its turn comes.

    Pages that are ``slow`` are read ahead; others are read sooner than a thread is waited for.
    """
    first = next(pages, None)
    if first is None:
        return
    pages = chain((first,), pages)
    if not getattr(first, "slow", False):
        for page in pages:
            yield page()
        return
    with ThreadPoolExecutor(THREADS, thread_name_prefix="robowidgets-pages") as pool:
        # One more than threads, so that none is idle while what came first is worked on.
        waiting: deque[Future[T]] = deque(pool.submit(page) for page in islice(pages, THREADS + 1))
        try:
            while waiting:
                result = waiting.popleft().result()
                waiting.extend(pool.submit(page) for page in islice(pages, 1))
                yield result
        finally:
            for future in waiting:
                future.cancel()
