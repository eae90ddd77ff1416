"""The end of JupyterLab's process."""

from __future__ import annotations

import asyncio
import threading

import pytest

from robowidgets.command._lab import end_tasks

to_thread = pytest.importorskip("anyio").to_thread


def test_no_thread_waits_for_a_task_that_stopped_the_loop_or_was_left_behind() -> None:
    loop = asyncio.new_event_loop()
    threads: list[threading.Thread] = []

    async def stops() -> None:
        threads.append(await to_thread.run_sync(threading.current_thread))
        loop.stop()

    async def is_left() -> None:
        threads.append(await to_thread.run_sync(threading.current_thread))
        await asyncio.Event().wait()

    tasks = [loop.create_task(is_left()), loop.create_task(stops())]
    loop.run_forever()
    while len(threads) < 2:
        loop.run_until_complete(asyncio.sleep(0))
    end_tasks(loop)
    for thread in threads:
        thread.join()  # the time limit of the tests ends a hang
    assert [task.done() for task in tasks] == [True, True]
    loop.close()
