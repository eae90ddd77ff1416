"""Running one function on each of many recordings, in processes of this machine or with an executor."""

from __future__ import annotations

import sys
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future
from contextlib import suppress
from functools import lru_cache
from queue import Empty, SimpleQueue
from typing import Any, NamedTuple

from ..messages.decoding import one_line
from ..messages.definitions import add, all_added
from ..recordings.search.base import ConditionError
from ..repair import RecordingError
from ..runtime.clock import Clock, RealClock
from ..runtime.inform import inform
from ..runtime.urls import redacted
from ..runtime.user_threads import UserThread
from ..runtime.waiters import LOOK

LONGEST = 600.0
"""The maximum number of seconds that one recording may take."""

_START_TIMEOUT_S = 120.0
"""The maximum number of seconds that a process may take to start and to import what the job needs."""

_AHEAD = 256
"""The maximum number of recordings that wait at an executor of the user."""


class Done(NamedTuple):
    """The result of one recording, or the reason why it has none.

    ``failure``: the error if the job itself failed, not the recording; its text is the same for all recordings.
    """

    path: str
    result: Any
    problem: str = ""
    failure: str = ""


def each(
    job: Callable[[str], Any],
    paths: Iterable[str],
    executor: Any = None,
    longest: float = LONGEST,
    idle: Callable[[], None] = lambda: None,
    *,
    here: bool = False,
    clock: Clock | None = None,
) -> Generator[Done, None, None]:
    """Yield the result of a function for each of some recordings, in the order of completion.

    A recording that takes too long, fails, or ends its process becomes a problem; the others continue.

    Args:
        job: takes a path, and returns plain data. It is sent by value: it may be a lambda. Message definitions that
            were added in this process are sent along.
        paths: the recordings.
        executor: an object with ``submit``, such as an executor of `concurrent.futures`, or a Dask client; or None for
            processes of this machine, one for each core. If it breaks, processes of this machine continue.
        longest: the maximum number of seconds for each. After that, a process of this machine is killed, whatever it
            does. A thread, as with ``here`` or an executor, is abandoned, which does not end C code that holds the GIL.
        idle: called now and then while waiting for results.
        here: run the job in a thread of this process: for a few recordings this is faster than starting a process.
        clock: the time that recordings take is measured by this clock.

    Raises:
        TypeError: ``executor`` has no ``submit``, or the function refers to something that cannot be sent, such as a
            lock.
    """
    waiting = deque(paths)
    if executor is None and (here or not waiting or sys.platform == "emscripten"):
        yield from (Done(path, *_call(job, path, longest)) for path in waiting)
        return
    from cloudpickle import dumps

    try:
        task = dumps((all_added(), job))
    except Exception as error:  # the objects to which it refers may raise anything
        raise TypeError(f"condition: cannot be sent to another process: {one_line(error)}") from None
    if executor is not None:
        yield from _by_executor(_executor(executor), waiting, task, longest, idle)
        if waiting:
            inform("the executor broke, or lost workers: continuing with processes of this machine")
    if waiting:
        yield from _by_processes(waiting, task, longest, idle, clock or RealClock())


def _by_executor(
    executor: Executor, waiting: deque[str], task: bytes, longest: float, idle: Callable[[], None]
) -> Iterator[Done]:
    """Yield the results of an executor until it breaks; then the unfinished recordings wait again."""
    under_way: dict[Future[Any], str] = {}
    lost: list[str] = []
    done: SimpleQueue[Future[Any]] = SimpleQueue()
    is_whole = True
    try:
        while is_whole and (waiting or under_way):
            while waiting and len(under_way) < _AHEAD:
                path = waiting.popleft()
                try:
                    future = executor.submit(work, task, path, longest)
                except Exception:  # a broken or closed executor may raise anything
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
            except (BrokenExecutor, CancelledError):  # the process of a pool or the scheduler of a cluster ended
                lost.append(path)
                is_whole = False
            except BaseException:  # errors of a job are returned as answers: the cluster gave up this one
                lost.append(path)
            else:
                yield Done(path, *answer)
    finally:
        for future in under_way:
            future.cancel()
        waiting.extend([*lost, *under_way.values()])


def _next(done: SimpleQueue[Future[Any]], idle: Callable[[], None]) -> Future[Any]:
    """Return the next finished future. The waits are short, because an interrupt just before a wait wakes no thread."""
    # Not concurrent.futures.wait(): an interrupt may leave the lock of its Condition held for ever.
    while True:
        with suppress(Empty):
            return done.get(timeout=LOOK)
        idle()


class _Worker:
    """A process of this machine that reads one recording at a time, and can be killed meanwhile.

    Args:
        task: the job, for `_loaded`.
        done: the queue for this worker with each of its finished futures.
        clock: the time that recordings take is measured by this clock.
    """

    def __init__(self, task: bytes, done: SimpleQueue[tuple[_Worker, Future[Any]]], clock: Clock) -> None:
        self._task, self._done, self._clock = task, done, clock
        self._pool: Any = None
        self._future: Future[Any] | None = None
        self._is_started = False
        self._since = 0.0
        self.path = ""
        """The recording that it reads, or empty while it is idle."""

    def read(self, path: str) -> None:
        """Begin with a recording, in the current process or in a new one."""
        self.path = path
        if self._pool is not None:
            self._submit(_answer_here, self._task, path)
            return
        from loky.process_executor import ProcessPoolExecutor

        # A new process, not a copy of this one, and without the user's script: it needs no __main__ guard.
        self._pool = ProcessPoolExecutor(1, timeout=None, initializer=_ignore_interrupts)
        self._is_started = False
        self._submit(_load, self._task)

    def take(self, future: Future[Any]) -> Done | None:
        """Return the result of a future, or None if it is outdated or the process has only started."""
        if future is not self._future:
            return None
        try:
            answer = future.result()
        except (BrokenExecutor, CancelledError):
            return self._killed("the process that read it ended: killed, or out of memory")
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # from a job that cannot be loaded in the process, such as an import
            return self._finish(None, *_problem_of(error))
        if self._is_started:
            return self._finish(*answer)
        self._is_started = True
        self._submit(_answer_here, self._task, self.path)
        return None

    def stop_if_late(self, longest: float) -> Done | None:
        """Kill the process if its recording takes longer than some seconds, and return that as a problem."""
        limit = longest if self._is_started else max(longest, _START_TIMEOUT_S)
        if not self.path or self._clock.now() - self._since < limit:
            return None
        return self._killed(f"took longer than {longest:g} s")

    def end(self) -> None:
        """Kill the process, whatever it does."""
        if self._pool is not None:
            self._pool.shutdown(wait=True, kill_workers=True)
        self._pool = self._future = None

    def _submit(self, function: Callable[..., Any], *arguments: Any) -> None:
        self._since = self._clock.now()
        future = self._future = self._pool.submit(function, *arguments)
        future.add_done_callback(lambda one: self._done.put((self, one)))

    def _killed(self, problem: str) -> Done:
        self.end()
        return self._finish(None, problem, problem)

    def _finish(self, result: Any, problem: str, failure: str) -> Done:
        path, self.path, self._future = self.path, "", None
        return Done(path, result, problem, failure)


def _by_processes(
    waiting: deque[str], task: bytes, longest: float, idle: Callable[[], None], clock: Clock
) -> Iterator[Done]:
    """Yield the results of processes of this machine, which end with the generator."""
    from loky import cpu_count

    done: SimpleQueue[tuple[_Worker, Future[Any]]] = SimpleQueue()
    workers = [_Worker(task, done, clock) for _ in range(min(cpu_count(), len(waiting)))]
    try:
        while True:
            for worker in workers:
                if waiting and not worker.path:
                    worker.read(waiting.popleft())
            if not any(worker.path for worker in workers):
                return
            try:
                worker, future = done.get(timeout=LOOK)
            except Empty:
                idle()
            else:
                if one := worker.take(future):
                    yield one
            for worker in workers:
                if one := worker.stop_if_late(longest):
                    yield one
    finally:
        for worker in workers:
            worker.end()


def work(task: bytes, path: str, longest: float) -> tuple[Any, str, str]:
    """Return the result of a task for a path, its problem and its failure; an executor of the user runs this."""
    return _call(_loaded(task), path, longest)


def _load(task: bytes) -> None:
    """Import what a task needs, before its time starts."""
    _loaded(task)


def _answer_here(task: bytes, path: str) -> tuple[Any, str, str]:
    return _answer(_loaded(task), path)


@lru_cache(maxsize=1)
def _loaded(task: bytes) -> Callable[[str], Any]:
    from cloudpickle import loads

    definitions: dict[str, str]
    job: Callable[[str], Any]
    definitions, job = loads(task)
    if not definitions.items() <= all_added().items():
        add(definitions)
    return job


def _call(job: Callable[[str], Any], path: str, longest: float) -> tuple[Any, str, str]:
    """Call a job in a thread, which is left behind if it takes too long."""
    answers: list[tuple[Any, str, str]] = []

    def run() -> None:
        answer = _answer(job, path)
        if not thread.is_abandoned:  # otherwise its error is the one that ends the thread
            answers.append(answer)

    thread = UserThread(run, "robowidgets: one of many recordings")
    thread.start()
    try:
        thread.join(longest)
    finally:
        if thread.is_alive():
            thread.abandon()
            thread.end()
    late = f"took longer than {longest:g} s"
    return answers[0] if answers else (None, late, late)


def _answer(job: Callable[[str], Any], path: str) -> tuple[Any, str, str]:
    """Return the result of a job for a path, its problem and its failure, which are empty if all went well."""
    try:
        return job(path), "", ""
    except BaseException as error:  # a condition may raise anything, including an exit
        return (None, *_problem_of(error))


def _problem_of(error: BaseException) -> tuple[str, str]:
    """Return the problem of an error, and also its failure if the job is to blame and not the recording."""
    if isinstance(error, ConditionError) and error.__cause__ is not None:
        return " ".join(str(error).split()), _named(error.__cause__)
    if isinstance(error, RecordingError):
        return " ".join(str(error).split()), ""
    if isinstance(error, OSError):
        return redacted(" ".join(str(error).split())), ""
    if isinstance(error, MemoryError):
        return "out of memory", ""
    return _named(error), _named(error)


def _named(error: BaseException) -> str:
    return f"{type(error).__name__}: {redacted(one_line(error))}"


def _executor(given: Any) -> Executor:
    """Return an executor, or the executor of a Dask client."""
    own: Executor = given.get_executor() if hasattr(given, "get_executor") else given
    if not callable(getattr(own, "submit", None)):
        raise TypeError(f"executor: expected an object with submit(), or a Dask client, got {given!r}")
    return own


def _ignore_interrupts() -> None:
    """Ignore interrupts: the parent process handles them, and ends the others."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)
