"""Code of an assistant, in a process of its own: the lines of a function over a recording, or a simulated drive.

The process has the rights of the user, and is killed after a while. It runs only if the user allowed code.
"""

from __future__ import annotations

import contextlib
import importlib.util
import inspect
import json
import sys
import tempfile
from collections.abc import Callable, Mapping
from math import hypot, inf, isfinite
from pathlib import Path
from typing import Any

import anyio

from ..runtime.text import many
from .answer import AnswerError, QuotingError, ToolAnswer, from_robot, name, number, seconds

TIMEOUT_S = 60.0
"""Seconds after which the process is killed."""

MAX_SECONDS = 300.0
"""The longest simulated drive in seconds."""

MAX_OUTPUT = 12_000
"""The most characters of the lines of a function."""

MAX_SOURCE = 50_000

_PLACES = 20


async def run(job: Mapping[str, Any], timeout: float = TIMEOUT_S) -> ToolAnswer:
    """Run a job in a process, which is killed if it takes too long or if its question is cancelled.

    Args:
        job: the arguments of `_lines` or `_simulate`, and its name in ``do``.
        timeout: seconds.

    Raises:
        AnswerError: the code failed, or took too long.
    """
    if len(job["source"]) > MAX_SOURCE:
        raise AnswerError(f"source: expected at most {MAX_SOURCE:,} characters, got {len(job['source']):,}")
    with anyio.move_on_after(timeout):
        done = await anyio.run_process(
            [sys.executable, "-m", __name__], input=json.dumps(job).encode(), check=False, stderr=None
        )
        try:
            text, data = json.loads(done.stdout)
        except ValueError:
            raise AnswerError(f"the process of the code ended without an answer, with code {done.returncode}") from None
        if text is None:
            raise QuotingError(data)
        return ToolAnswer(text, data)
    raise AnswerError(f"the code did not return within {timeout:g} s, and its process was killed; let it do less")


def _function(source: str, wanted: str | None, folder: Path) -> Any:
    """Return a function or class of a source text: the named one, or the last one.

    It is imported from a file, from which the values of its lines are read.
    """
    path = folder / "assistant_code.py"
    path.write_text(source, encoding="utf-8")
    spec = importlib.util.spec_from_file_location("assistant_code", path)
    if spec is None or spec.loader is None:
        raise AnswerError("source: expected Python")
    module = importlib.util.module_from_spec(spec)
    sys.modules["assistant_code"] = module
    spec.loader.exec_module(module)
    there = [
        key
        for key, value in vars(module).items()
        if (inspect.isfunction(value) or inspect.isclass(value)) and value.__module__ == "assistant_code"
    ]
    if not there or (wanted is not None and wanted not in there):
        raise AnswerError(f"function: expected one that the source defines, got {wanted!r}; it defines {there}")
    return getattr(module, wanted or there[-1])


def _lines(source: str, function: str | None, recording: str, at: float, rate: float, folder: Path) -> ToolAnswer:
    """Return the values of the lines of a function at a moment of a recording."""
    from ..recording import open as open_recording

    with open_recording(recording) as opened:
        lines = opened.lines(_function(source, function, folder), rate=rate)
        step = lines.at(at)
        text = repr(step)
        data = {
            "steps": len(lines),
            "step_s": seconds(step.seconds),
            "lines": from_robot(text, MAX_OUTPUT),
            "error_of_the_step": from_robot(step.error) if step.error else "",
            "ended_early": from_robot(lines.error) if lines.error else "",
        }  # fmt: skip
        return ToolAnswer(f"{many(len(lines), 'step')}; the lines of the step at {step.seconds:.2f} s.", data)


def _simulate(
    source: str, function: str | None, duration: float, seed: int, room: str, rate: float, folder: Path
) -> ToolAnswer:
    """Drive the simulated robot by a program, and return its places and touches."""
    from ..behaviors import simulate
    from ..simulator import Robot
    from ..simulator.rooms import room as room_of

    if not 0 < duration <= MAX_SECONDS:
        raise AnswerError(f"seconds: expected above 0 and at most {MAX_SECONDS:g}, got {duration:g}")
    program = _function(source, function, folder)
    robot = Robot(room_of(room, seed), seed=seed)
    places, driven, nearest, touches, error = [], 0.0, inf, 0, ""
    before, was_touched, wanted = robot.pose, False, 0.0
    try:
        for step in simulate(program, robot, duration, rate=rate):
            pose, touched = robot.pose, any(robot.touch().touched.values())
            driven += hypot(pose.x - before.x, pose.y - before.y)
            touches += touched and not was_touched
            before, was_touched = pose, touched
            away = robot.scan().distance()
            nearest = min(nearest, away) if isfinite(away) else nearest
            if step.time >= wanted:
                wanted += duration / _PLACES
                place = {"s": seconds(step.time), "x_m": number(pose.x), "y_m": number(pose.y)}
                places.append(place | {"yaw_rad": number(pose.yaw), "linear_m_s": number(step.drive.linear)})
    except Exception as raised:  # an error of the code is a part of the answer
        error = f"{type(raised).__name__}: {raised}"
    data = {
        "simulated_s": seconds(robot.time),
        "driven_m": number(driven),
        "touches": touches,
        "nearest_m": number(nearest),
        "places": places,
        "error": from_robot(error) if error else "",
    }
    ended = ", and ended with an error" if error else ""
    return ToolAnswer(f"{robot.time:.1f} s simulated in the room {name(room)!r}, {touches} touches{ended}.", data)


_DO: dict[str, Callable[..., ToolAnswer]] = {"lines": _lines, "simulate": _simulate}


def main() -> None:
    """Do the job on stdin, and print its answer as JSON."""
    job = json.load(sys.stdin)
    do, out = _DO[job.pop("do")], sys.stdout
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(sys.stderr):
        try:
            made = do(**job, folder=Path(folder))
            said: Any = [made.text, made.data]
        except BaseException as error:  # even a SystemExit of the code is an answer
            kind = "" if isinstance(error, AnswerError) else f"{type(error).__name__}: "
            said = [None, f"{kind}{error}"[:2000]]
    out.write(json.dumps(said))


if __name__ == "__main__":
    main()
