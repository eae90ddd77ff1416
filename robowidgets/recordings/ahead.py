"""Pages read ahead, on the other core, while the last one is worked on."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import islice
from typing import TypeVar

THREADS = 2
"""Reading and decompressing do not hold Python's lock: two threads keep two cores busy."""

T = TypeVar("T")


def read_ahead(pages: Iterator[Callable[[], T]]) -> Iterator[T]:
    """What each page gives, in their order. Raises what reading a page raised, when its turn comes."""
    with ThreadPoolExecutor(THREADS, thread_name_prefix="robowidgets-pages") as pool:
        waiting: deque[Future[T]] = deque(pool.submit(page) for page in islice(pages, THREADS))
        try:
            while waiting:
                result = waiting.popleft().result()
                waiting.extend(pool.submit(page) for page in islice(pages, 1))
                yield result
        finally:
            for future in waiting:
                future.cancel()
