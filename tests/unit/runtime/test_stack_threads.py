"""Threads on stacks that are put aside, and the exchange of values between the page and Python, without a browser."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from robowidgets.notebook.in_browser import from_page, is_users, repair_comm, to_page

from ... import stack_cases


class Null:
    """Pyodide's value for null."""


NULL = Null()


@pytest.fixture(scope="module")
def wrong() -> dict[str, str]:
    """The failures of each case, in a process of their own: they replace the base of `threading`."""
    command = [sys.executable, stack_cases.__file__]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    told: dict[str, str] = json.loads(ended.stdout)
    return told


@pytest.mark.skipif(sys.version_info < (3, 13), reason="the threads of a browser are those of Python 3.13 or later")
@pytest.mark.parametrize("case", stack_cases.CASES)
def test_threads(wrong: dict[str, str], case: str) -> None:
    assert wrong[case] == ""


LESSON = Path(stack_cases.__file__).with_name("lesson_on_stacks.py")
LOOPS = [number for number, line in enumerate(LESSON.read_text().splitlines(), 1) if line.strip() == "while True:"]
NO_RETURN = "a step has not returned for half a second, and was abandoned"
CAME = {
    "waited": "Scan",
    "moved": "True",
    "gave way": "True",
    "error": f"line {LOOPS[0]}: {NO_RETURN}",
    "lamp": "True",
    "check": f"a hall: line {LOOPS[1]}: {NO_RETURN}. A step returns at once: it does not sleep or wait, "
    "and its loops end",
    "lines": "1.51 m [1]",
    "right": "True",
    "closed": "True",
    "a loop in the study": "True",
    "the study": "True",
}


@pytest.mark.slow
@pytest.mark.skipif(sys.version_info < (3, 13), reason="the threads of a browser are those of Python 3.13 or later")
def test_a_lesson_runs_on_them_with_its_limits() -> None:
    command = [sys.executable, LESSON]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert dict(line.split(": ", 1) for line in ended.stdout.splitlines()) == CAME, ended.stderr


@pytest.mark.parametrize(
    ("value", "there"),
    [
        (None, NULL),
        (True, True),
        (3, 3),
        (-(2**53), -(2**53)),
        (2**60, float(2**60)),
        (0.5, 0.5),
        ("a", "a"),
        (b"\0", b"\0"),
        ([None, {"a": (None, 1)}], [NULL, {"a": [NULL, 1]}]),
        ({"hovered": None, "rays": [1, None]}, {"hovered": NULL, "rays": [1, NULL]}),
    ],
)
def test_a_value_reaches_the_page_as_json_has_it(value: Any, there: Any) -> None:
    sent = to_page(value, NULL)
    assert (sent, type(sent)) == (there, type(there))


def test_the_null_of_the_page_is_none_everywhere() -> None:
    assert from_page({"pinned": NULL, "rays": [1, NULL, {"a": NULL}]}, NULL) == {
        "pinned": None,
        "rays": [1, None, {"a": None}],
    }


def test_a_comm_is_repaired_in_both_directions_and_buffers_pass() -> None:
    class Comm:
        def publish_msg(self, msg_type: str, data: Any, metadata: Any, buffers: Any = None, **keys: Any) -> None:
            self.sent = (msg_type, data, metadata, buffers, keys)

        def handle_msg(self, msg: Any) -> None:
            self.got = msg

    repair_comm(Comm, NULL)
    comm = Comm()
    comm.publish_msg("comm_open", data={"state": {"a": None}}, buffers=[b"1"], target_name="jupyter.widget")
    assert comm.sent == ("comm_open", {"state": {"a": NULL}}, {}, [b"1"], {"target_name": "jupyter.widget"})
    comm.handle_msg({"content": {"data": {"state": {"a": NULL}}}, "buffers": [b"1"]})
    assert comm.got == {"content": {"data": {"state": {"a": None}}}, "buffers": [b"1"]}


def test_code_of_cells_and_files_is_the_users_and_code_of_python_and_packages_is_not() -> None:
    users = compile("", "<ipython-input-1-abc>", "exec"), compile("", str(Path.home() / "my.py"), "exec")
    others = json.dumps.__code__, pytest.fixture.__code__, to_page.__code__, compile("", "<frozen os>", "exec")
    assert [is_users(code) for code in (*users, *others)] == [True, True, False, False, False, False]
