"""The steps of the last minute in which a new version of a program would have decided otherwise."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from ..behaviors.kept_steps import KEPT_S, KeptStep, KeptSteps
from ..behaviors.trial import ComparedSteps, compared, steps_to_try, why_not_tried
from ..behaviors.trials import TrialJob, Trials
from ..behaviors.version import Version

TRIAL_S = 2.0
"""Seconds of work for one comparison."""
_TRIAL = "versions"


class ComparedVersions:
    """Compares each new version with the one before, in the thread of trials.

    Args:
        trials: the thread of trials.
        on_change: called when `state` has changed.

    Attributes:
        state: the result for the page, as plain values; empty before a second version.
    """

    def __init__(self, trials: Trials, on_change: Callable[[], object]) -> None:
        self._trials, self._on_change = trials, on_change
        self._lock = threading.Lock()
        self.state: dict[str, Any] = {}
        self._newest: object = None

    def compare(self, name: str, old: Version, new: Version, kept: KeptSteps, step_s: float) -> None:
        """Compare two versions of a program on the steps of the last minute.

        Args:
            name: the name of the program.
            old: the version before.
            new: the new version.
            kept: the inputs of the last steps.
            step_s: the seconds that a step takes.
        """
        head = {"key": f"{name} {new.number}", "old": old.number, "new": new.number}
        whys = (f"in version {one.number}, {why}" for one in (old, new) if (why := why_not_tried(one.function)))
        why = next(whys, "")
        steps: list[KeptStep] = []
        if not why:
            asked = tuple(dict.fromkeys((*old.asks_for, *new.asks_for)))
            most = max(1, int(TRIAL_S / 2 / max(step_s, 1e-5)))
            before = [step for step in kept.last(name, KEPT_S) if step.program[1] < new.number]
            steps, why = steps_to_try(before, asked, most)
        found = ComparedSteps()
        with self._lock:
            self._newest = found
            self.state = {**head, "why": why} if why else {}
        if not why:
            work = compared((old.function, old.asks_for), (new.function, new.asks_for), steps, found)
            self._trials.ask(_TRIAL, TrialJob(work, new.function, lambda job: self._on_over(job, head, steps, found)))
        self._on_change()

    def _on_over(self, job: TrialJob, head: dict[str, Any], steps: list[KeptStep], found: ComparedSteps) -> None:
        with self._lock:
            if self._newest is not found:
                return
            self.state = {
                **head,
                "why": job.error[:300],
                **found.packed(steps),
                "spans": found.all_spans,
                "rows": [
                    [
                        round(steps[span.first].time, 2), round(steps[span.last].time, 2), span.line,
                        span.old_value, span.new_value, span.old, span.new,
                    ]
                    for span in found.spans
                ],
            }  # fmt: skip
        self._on_change()
