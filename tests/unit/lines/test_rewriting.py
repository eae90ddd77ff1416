"""A function that is rewritten does what it did: results, order of effects, tracebacks, variables, and references."""

from __future__ import annotations

import ast
import gc
import itertools
import linecache
import sys
import traceback
import warnings
from collections.abc import Callable
from typing import Any

import pytest

from robowidgets.behaviors.lines.noting import MOST_PASSES, CallNotes, Notebook
from robowidgets.reasons.places import COMPARE, PASS, RAYS, VALUE
from robowidgets.reasons.rewriting import NotRewrittenError, rewritten, without_warnings

from .snippets import IN_PLACES, SOURCES

NUMBER = itertools.count()


class Do:
    """Notes what it is given, and returns it."""

    def __init__(self) -> None:
        self.log: list[Any] = []

    def __call__(self, value: Any) -> Any:
        self.log.append(repr(value) if isinstance(value, (int, str, tuple)) else type(value).__name__)
        return value


def made(source: str, name: str = "step") -> Any:
    """The function in a source, as in a cell."""
    file = f"<cell {next(NUMBER)}>"
    linecache.cache[file] = len(source), None, source.splitlines(keepends=True), file
    namespace: dict[str, Any] = {"known": "known", "do": Do(), "__name__": "cell", "numbers": iter([1, 2, 3, 4])}
    exec(compile(source, file, "exec", dont_inherit=True), namespace)
    namespace["result"] = namespace.pop(name) if name != "step" else namespace["step"]
    return namespace["result"]


def watched(function: Callable[..., Any]) -> tuple[Callable[..., Any], Notebook]:
    found = rewritten(function)
    notebook = Notebook(found.source)
    return found.bind(notebook.notes), notebook


def outcome(function: Callable[..., Any]) -> tuple[Any, ...]:
    """The result of a call or its error, with the place of each entry of its traceback, and its effects in order."""
    do = Do()
    result = error = None
    entries: list[Any] = []
    try:
        result = function(do)
    except BaseException as raised:
        error = type(raised), str(raised), type(raised.__cause__), type(raised.__context__)
        for entry in traceback.extract_tb(raised.__traceback__)[1:]:
            columns = (getattr(entry, "colno", 0), getattr(entry, "end_lineno", 0), getattr(entry, "end_colno", 0))
            entries.append((entry.name, entry.lineno, *columns))
    return repr(result), error, entries, do.log


@pytest.mark.parametrize("source", SOURCES, ids=[source.split("\n")[1].strip()[:40] for source in SOURCES])
def test_a_function_does_what_it_did(source: str) -> None:
    as_it_is = outcome(made(source))
    function, _ = watched(made(source))
    assert outcome(function) == as_it_is


@pytest.mark.parametrize("place", IN_PLACES)
def test_a_function_does_what_it_did_wherever_it_stands(place: str) -> None:
    as_it_is = outcome(made(IN_PLACES[place]))
    function, notebook = watched(made(IN_PLACES[place]))
    assert outcome(function) == as_it_is
    assert notebook.take().seen


def test_each_snippet_compiles_and_most_of_them_note_something() -> None:
    noting = 0
    for source in SOURCES:
        function, notebook = watched(made(source))
        outcome(function)
        noting += bool(notebook.take().seen)
    assert len(SOURCES) > 100
    assert noting > 0.95 * (len(SOURCES) - 2)  # two have nothing but a docstring


def test_the_code_has_the_lines_that_it_had() -> None:
    """A debugger stops at the same lines."""

    def lines(function: Callable[..., Any]) -> set[int | None]:
        return {line for _, _, line in function.__code__.co_lines()}

    assert [source for source in SOURCES if lines(made(source)) != lines(watched(made(source))[0])] == []


def test_the_function_itself_is_left_as_it_is() -> None:
    function = made("def step(do):\n    return do(1)\n")
    code = function.__code__
    function.mark = "mine"
    other, notebook = watched(function)
    assert function.__code__ is code
    assert other is not function
    assert other.mark == "mine"  # type: ignore[attr-defined]
    assert function(Do()) == 1
    assert notebook.take().seen == ()


@pytest.mark.parametrize(
    ("source", "why"),
    [
        ("async def step(do):\n    return 1\n", "it is async"),
        ("async def step(do):\n    yield 1\n", "it is async"),
        ("def step(do):\n    yield 1\n", "it is a generator"),
        ("def step(do):\n    x = yield\n", "it is a generator"),
        (
            "import functools\ndef mine(f):\n    @functools.wraps(f)\n    def around(do): return f(do)\n"
            "    return around\n@mine\ndef step(do): return 1\n",
            "a decorator wraps it in another function",
        ),
        ("step = print\n", "it is not written in Python"),
        ("step = type('Odd', (), {})()\n", "it is not written in Python"),
        ("a, step = lambda do: 1, lambda do: 2\n", ""),
        # Python compiles the lambda in the defaults first, and Python 3.10 does not know its columns.
        (
            "step = lambda do, g=(lambda do, g=0: 7): g(do) + 1\n",
            "several functions of its name are on its line" if sys.version_info < (3, 11) else "",
        ),
    ],
)
def test_a_function_that_cannot_be_rewritten_gives_its_reason(source: str, why: str) -> None:
    if not why:
        watched(made(source))  # two lambdas on one line differ in their code
        return
    with pytest.raises(NotRewrittenError, match=why):
        rewritten(made(source))


def test_a_function_without_a_source_or_with_another_one_gives_its_reason() -> None:
    namespace: dict[str, Any] = {}
    exec("def step(do):\n    return do(1)\n", namespace)
    with pytest.raises(NotRewrittenError, match="its source is not known"):
        rewritten(namespace["step"])
    function = made("def step(do):\n    return do(1)\n")
    file = function.__code__.co_filename
    for other in ("def step(do):\n    return do(2)\n", "def other(do):\n    return 1\n", "def step(do:\n", "1\n"):
        linecache.cache[file] = len(other), None, other.splitlines(keepends=True), file
        with pytest.raises(NotRewrittenError, match="its source has changed"):
            rewritten(function)


def test_a_function_whose_lines_have_moved_is_not_rewritten() -> None:
    function = made("def step(do):\n    x = do(1)\n    return x\n")
    file = function.__code__.co_filename
    moved = "def step(do):\n    x = do(1)\n    # a comment\n    return x\n"
    linecache.cache[file] = len(moved), None, moved.splitlines(keepends=True), file
    with pytest.raises(NotRewrittenError, match="its source has changed"):
        rewritten(function)


def test_a_form_feed_and_a_line_separator_are_in_lines_and_end_none() -> None:
    source = "\f\ndef step(do):\n    x = '\u2028'\n\f\n    return x == do('y') and do(1)\n"
    function = made(source)
    linecache.cache[function.__code__.co_filename] = (
        len(source), None, [f"{line}\n" for line in source.split("\n")[:-1]], function.__code__.co_filename,
    )  # fmt: skip
    found = rewritten(function).source
    assert [text.strip() for text in found.texts] == [
        "def step(do):",
        "x = '\u2028'",
        "",
        "return x == do('y') and do(1)",
    ]
    assert {"x == do('y')", "do('y')", "do(1)"} <= {place.text for place in found.places}


def test_filters_of_warnings_stay_as_they_are_though_another_thread_changes_them() -> None:
    before = [*warnings.filters]
    other = warnings.catch_warnings()
    with without_warnings("a.py"):
        other.__enter__()
    assert warnings.filters == before
    other.__exit__(None, None, None)
    assert warnings.filters == before


def test_the_filter_of_another_thread_for_the_same_source_stays() -> None:
    with without_warnings("a.py"):
        with without_warnings("a.py"):
            pass
        with warnings.catch_warnings(record=True) as caught:
            warnings.warn_explicit("of the source", SyntaxWarning, "a.py", 1, module="a")
    assert not caught


def test_rewriting_gives_no_warning() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        function = made("def step(do):\n    return do(1 is 1) and '\\d'\n")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rewritten(function)


def test_an_exception_that_ends_a_step_leaves_its_notes() -> None:
    function, notebook = watched(made("def step(do):\n    x = do(1)\n    y = x / do(0)\n    return y\n"))
    with pytest.raises(ZeroDivisionError):
        function(Do())
    assert [(seen.place, seen.value) for seen in notebook.take().seen] == [(0, 1)]


def test_a_comparison_is_noted_with_its_sides_and_a_distance_with_its_scan_and_sector() -> None:
    source = (
        "def step(do):\n    a, b = 1, 2.5\n    if a < b and do(3) >= 4: pass\n"
        "    d = do.distance(('10deg', '20deg'))\n    e = do.distance(a)\n    return do.log.at(b)\n"
    )
    found = rewritten(made(source))
    places = {place.text: place for place in found.source.places}
    assert places["a < b"].kind == COMPARE
    assert places["a < b"].relation == "<"
    assert [operand.extra for operand in places["a < b"].operands] == [0, 1]
    assert [operand.constant for operand in places["do(3) >= 4"].operands][1] == 4
    distance = places["do.distance(('10deg', '20deg'))"]
    assert (distance.kind, distance.names, distance.relation) == (VALUE, ("d",), "distance")
    assert distance.operands[1].constant == ("10deg", "20deg")
    assert places["do.distance(a)"].operands[1].extra == 1
    assert places["do.log.at(b)"].operands[0].place is not None
    assert not [place for place in found.source.places if place.kind == RAYS]


def notes_of(source: str) -> CallNotes:
    function, notebook = watched(made(source))
    function(Do())
    return notebook.take()


def test_a_loop_notes_its_first_passes_counts_all_and_keeps_the_last() -> None:
    notes = notes_of("def step(do):\n    for i in range(1000):\n        x = 2 * i\n    return x\n")
    places = notes.source.places
    passes = [seen.value for seen in notes.seen if places[seen.place].kind == PASS]
    assert passes == list(range(MOST_PASSES))
    of_x = next(i for i, place in enumerate(places) if place.names == ("x",))
    assert notes.counts[of_x] == 1000
    assert notes.last[of_x].value == 1998


def test_lines_know_the_places_that_show_that_they_were_reached() -> None:
    source = (
        "def step(do):\n"  # 1
        "    # a comment\n"  # 2
        "    try:\n"  # 3
        "        x = do(1).missing\n"  # 4
        "        y = 2\n"  # 5
        "    except AttributeError:\n"  # 6
        "        pass\n"  # 7
        "    except ValueError:\n"  # 8
        "        z = 3\n"  # 9
        "    else:\n"  # 10
        "        z = 4\n"  # 11
        "    if do(0): return 5\n"  # 12
        "    elif do(\n"  # 13
        "        1\n"  # 14
        "    ):\n"  # 15
        "        return 6\n"  # 16
        "    def inner():\n"  # 17
        "        return 7\n"  # 18
    )
    notes = notes_of(source)
    reach = notes.source.reach
    reached = {line for line, places in reach.items() if any(place in notes.last for place in places)}
    assert reached == {3, 4, 6, 7, 12, 13, 14, 15, 16}
    assert {5, 8, 9, 10, 11, 17, 18} <= reach.keys()
    assert not reach.keys() & {1, 2}


def test_what_was_noted_does_not_keep_objects_alive() -> None:
    source = (
        "import weakref\nclass Thing: pass\ndef step(do):\n    x = Thing()\n    y = [x]\n    do.seen = weakref.ref(x)\n"
    )
    function, notebook = watched(made(source))
    do = Do()
    function(do)
    gc.collect()
    assert do.seen() is None  # type: ignore[attr-defined]
    assert len(notebook.take().seen) == 3


def test_a_source_is_parsed_again_if_python_fails_as_another_thread_parses(monkeypatch: pytest.MonkeyPatch) -> None:
    parse, failures = ast.parse, [SystemError("AST constructor recursion depth mismatch (before=42, after=71)")]

    def fails_first(*given: Any) -> ast.Module:
        if failures:
            raise failures.pop()
        return parse(*given)

    monkeypatch.setattr(ast, "parse", fails_first)
    assert rewritten(made("def step(do):\n    return do\n")).source.reach
    assert not failures
