"""The rules of staleness, which are all in one module for each half."""

from __future__ import annotations

import re
from math import inf
from pathlib import Path

import pytest

import robowidgets
from robowidgets.samples import staleness
from robowidgets.samples.staleness import SilenceRule

ROOT = Path(robowidgets.__file__).parent
OURS = {ROOT / "samples" / "staleness.py", ROOT / "js" / "shared" / "staleness.ts"}
OF_ITS_OWN = re.compile(r"^ *(?:export )?(?:const )?\w*(?:SILEN|STALE|UNHEARD)\w*(?:: *\w+)? *= *[\d.]+", re.M)


def test_a_rule_counts_usual_steps_within_its_limits_in_the_unit_of_the_step() -> None:
    rule = SilenceRule(3, 1.0, 10.0)
    assert [rule.after(step) for step in (0.0, 0.1, 0.5, 2.0, 5.0, inf)] == [1.0, 1.0, 1.5, 6.0, 10.0, 10.0]
    assert [rule.after(step, 1e9) for step in (0, 5e8, 5e9)] == [1e9, 1.5e9, 1e10]
    assert [SilenceRule(10).after(step) for step in (0.0, 2.0, inf)] == [0.0, 20.0, inf]


@pytest.mark.parametrize(
    ("rule", "said"),
    [
        (staleness.LIVE, "at 10 Hz 1 s, at 1 Hz 3 s, without a rate 10 s"),
        (staleness.TO_DRIVE_BY, "at 10 Hz 0.4 s, at 1 Hz 2 s, without a rate 2 s"),
        (staleness.RECORDED, "at 10 Hz 2 s, at 1 Hz 2 s, without a rate inf s"),
        (staleness.PAUSE, "at 10 Hz 2 s, at 1 Hz 10 s, without a rate inf s"),
        (staleness.OPEN_END, "at 10 Hz 5 s, at 1 Hz 10 s, without a rate inf s"),
        (staleness.CLOCK_JUMP, "at 10 Hz 60 s, at 1 Hz 100 s, without a rate inf s"),
    ],
    ids=["live", "to drive by", "recorded", "pause", "open end", "clock jump"],
)
def test_the_rules_match_the_documentation(rule: SilenceRule, said: str) -> None:
    assert said == "at 10 Hz {:g} s, at 1 Hz {:g} s, without a rate {:g} s".format(*map(rule.after, (0.1, 1.0, inf)))


def test_no_other_module_has_a_number_of_its_own_for_silence() -> None:
    files = [*ROOT.rglob("*.py"), *(ROOT / "js").glob("[!n]*/**/*.ts"), *(ROOT / "js").glob("*.ts")]
    assert set(files) >= OURS
    found = {path: OF_ITS_OWN.findall(path.read_text(encoding="utf-8")) for path in files if path not in OURS}
    assert {path.relative_to(ROOT).as_posix(): lines for path, lines in found.items() if lines} == {}
    assert all(OF_ITS_OWN.search(path.read_text(encoding="utf-8")) for path in OURS)
