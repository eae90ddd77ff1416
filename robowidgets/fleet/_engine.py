"""One function of each of many recordings, in processes of this machine or wherever an executor runs it."""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from contextlib import contextmanager, suppress
from functools import lru_cache
from queue import Empty, SimpleQueue
from typing import Any, NamedTuple

from .._core.inform import inform
from .._core.user_threads import UserThread
from .._core.waiters import LOOK
from ..messages.decoding import one_line
from ..messages.definitions import add, all_added
from ..repair import RecordingError

LONGEST = 600.0
"""Seconds that one recording may take."""

_AHEAD = 2
"""How many recordings wait for each process: a result must not wait for all that was asked before."""
_AHEAD_ELSEWHERE = 256
_TRIES = 2


class Done(NamedTuple):
    """What came of one recording: a result, or why there is none."""

    path: str
    result: Any
    problem: str = ""


def each(
    job: Callable[[str], Any],
    paths: Iterable[str],
    executor: Any = None,
    longest: float = LONGEST,
    idle: Callable[[], None] = lambda: None,
) -> Generator[Done, None, None]:
    """What a function returns for each of some recordings, as they get done.

    A recording that takes too long, fails, or ends its process is told as a problem; the others go on.

    Args:
        job: takes a path, and returns plain data. It is sent by value: it may be a lambda. Message definitions that
            were added here go with it.
        paths: the recordings.
        executor: what has ``submit``, as those of `concurrent.futures`; or a client of Dask. None: processes of this
            machine, one for each core. Where it breaks, processes of this machine go on.
        longest: seconds that each may take.
        idle: called now and then while executors are waited for.

    Raises:
        TypeError: ``executor`` has no ``submit``, or the function refers to what cannot be sent, such as a lock.
    """
    waiting = deque(paths)
    if executor is None and (len(waiting) <= 1 or sys.platform == "emscripten"):
        yield from (Done(path, *_call(job, path, longest)) for path in waiting)
        return
    from cloudpickle import dumps

    try:
        task = dumps((all_added(), job))
    except Exception as error:  # whatever the objects that it refers to raise
        raise TypeError(f"condition: cannot be sent to another process: {one_line(error)}") from None
    suspects: list[str] = []
    if executor is not None:
        yield from _by(_executor(executor), _AHEAD_ELSEWHERE, waiting, suspects, task, longest, idle)
        if waiting or suspects:
            inform("the executor broke, or lost workers: processes of this machine go on")
        waiting.extend(suspects)  # too many wait there for a look at each in a process of its own
        suspects.clear()
    while waiting:
        with _processes() as (own, count):
            yield from _by(own, _AHEAD * count, waiting, suspects, task, longest, idle)
    # Of those that were under way when a process ended, one by one: each then ends but its own.
    for path in suspects:
        for attempt in range(1, _TRIES + 1):
            again: list[str] = []
            with _processes(1) as (own, _):
                yield from _by(own, 1, deque([path]), again, task, longest, idle)
            if not again:
                break
            if attempt == _TRIES:
                yield Done(path, None, "the process that read it ended: killed, or out of memory")


def _by(
    executor: Executor,
    ahead: int,
    waiting: deque[str],
    suspects: list[str],
    task: bytes,
    longest: float,
    idle: Callable[[], None],
) -> Iterator[Done]:
    """What an executor makes of what waits, until it breaks: what was under way then is suspect."""
    under_way: dict[Future[Any], str] = {}
    done: SimpleQueue[Future[Any]] = SimpleQueue()
    is_whole = True
    try:
        while is_whole and (waiting or under_way):
            while waiting and len(under_way) < ahead:
                path = waiting.popleft()
                try:
                    future = executor.submit(work, task, path, longest)
                except Exception:  # whatever an executor says that has broken, or was shut down
                    waiting.appendleft(path)
                    is_whole = False
                    break
                under_way[future] = path
                future.add_done_callback(done.put)
            if not under_way:
                break
            future = _next(done, idle)
            path = under_way.pop(future)
            try:
                answer = future.result()
            except KeyboardInterrupt:
                raise
            except (BrokenExecutor, CancelledError):  # a pool whose process ended, a cluster whose scheduler did
                suspects.append(path)
                is_whole = False
            except BaseException:  # what a job raises comes as an answer: a cluster gave this one up
                suspects.append(path)
            else:
                yield Done(path, *answer)
    finally:
        for future in under_way:
            future.cancel()
        suspects.extend(under_way.values())


def _next(done: SimpleQueue[Future[Any]], idle: Callable[[], None]) -> Future[Any]:
    """The future that is done next. An interrupt just before a wait wakes nobody, so it looks for one now and then."""
    # Not concurrent.futures.wait(): an interrupt may leave the lock of its Condition held for ever.
    while True:
        with suppress(Empty):
            return done.get(timeout=LOOK)
        idle()


def work(task: bytes, path: str, longest: float) -> tuple[Any, str]:
    """The result of a task for a path, and why there is none; this is what an executor runs."""
    return _call(_loaded(task), path, longest)


@lru_cache(maxsize=1)
def _loaded(task: bytes) -> Callable[[str], Any]:
    from cloudpickle import loads

    definitions: dict[str, str]
    job: Callable[[str], Any]
    definitions, job = loads(task)
    if not definitions.items() <= all_added().items():
        add(definitions)
    return job


def _call(job: Callable[[str], Any], path: str, longest: float) -> tuple[Any, str]:
    """Call a job in a thread, which is left behind where it takes too long."""
    answer: list[tuple[Any, str]] = []

    def run() -> None:
        try:
            answer.append((job(path), ""))
        except (RecordingError, OSError) as error:
            answer.append((None, " ".join(str(error).split())))
        except MemoryError:
            answer.append((None, "out of memory"))
        except (Exception, SystemExit) as error:
            if not thread.is_abandoned:  # else it is what ends the thread
                answer.append((None, f"{type(error).__name__}: {one_line(error)}"))

    thread = UserThread(run, "robowidgets: one of many recordings")
    thread.start()
    try:
        thread.join(longest)
    finally:
        if thread.is_alive():
            thread.abandon()
            thread.end()
    return answer[0] if answer else (None, f"took longer than {longest:g} s")


def _executor(given: Any) -> Executor:
    """An executor, or that of a client of Dask."""
    own: Executor = given.get_executor() if hasattr(given, "get_executor") else given
    if not callable(getattr(own, "submit", None)):
        raise TypeError(f"executor: expected what has submit(), or a client of Dask, got {given!r}")
    return own


@contextmanager
def _processes(count: int | None = None) -> Iterator[tuple[Executor, int]]:
    """Processes of this machine, and how many. They end with the block, whatever they do."""
    from loky import cpu_count
    from loky.process_executor import ProcessPoolExecutor

    count = count or cpu_count()
    # They start anew, not as copies, and run no script of the user's: it need not ask for its name.
    own = ProcessPoolExecutor(count, timeout=None, initializer=_ignore_interrupts)
    try:
        yield own, count
    finally:
        own.shutdown(wait=True, kill_workers=True)


def _ignore_interrupts() -> None:
    """An interrupt is for the process that asked: it ends the others."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)
