"""The names of the package."""

from __future__ import annotations

import ast
import builtins
import re
import warnings
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import robowidgets
from robowidgets.feeds import FeedTopic
from robowidgets.feeds.middleware import NotConnectedYetError
from robowidgets.shapes import Arrow

from ..conftest import ROOT


def test_a_star_import_leaves_the_names_of_python_alone() -> None:
    assert not set(robowidgets.__all__) & set(dir(builtins))
    assert all(hasattr(robowidgets, name) for name in [*robowidgets.__all__, "open"])


def test_type_checkers_and_completion_know_each_name_that_is_imported_at_its_first_use() -> None:
    tree = ast.parse(Path(robowidgets.__file__).read_text(encoding="utf-8"))
    (block,) = [node for node in tree.body if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"]
    checked = {}
    for statement in block.body:
        assert isinstance(statement, ast.ImportFrom)
        module = import_module(f".{statement.module or ''}" if statement.module else "robowidgets", "robowidgets")
        checked |= {alias.name: getattr(module, alias.name) for alias in statement.names}
    assert {name: getattr(robowidgets, name) for name in checked} == checked
    assert {*robowidgets.__all__, "open"} - {"SAMPLE"} <= {*checked} <= {*dir(robowidgets)}
    assert {*dir(robowidgets)} - {*checked} <= {*vars(robowidgets)}


def test_each_public_module_is_imported_by_its_name() -> None:
    modules = {name: one for name in robowidgets.__all__ if isinstance(one := getattr(robowidgets, name), ModuleType)}
    assert {*modules} >= {"conditions", "feeds", "simulator"}
    assert {name: import_module(f"robowidgets.{name}") for name in modules} == modules


@pytest.mark.parametrize(
    ("word", "meant"),
    [("Laser", "LaserWidget"), ("Touc", "Touch"), ("simulater", "simulator"), ("laserwidget", "LaserWidget")],
)
def test_a_missing_name_suggests_an_existing_one(word: str, meant: str) -> None:
    with pytest.raises(AttributeError, match=rf"has no attribute '{word}'; did you mean '{meant}'\?$"):
        getattr(robowidgets, word)


def test_a_private_name_that_is_not_there_is_reported_plainly() -> None:
    with pytest.raises(AttributeError, match=r"has no attribute '__path_hooks__'$"):
        robowidgets.__path_hooks__  # noqa: B018


def definitions(tree: ast.Module, path: str) -> Iterator[tuple[str, str]]:
    """The classes of a module and its type aliases, each with what distinguishes it from another of the same name."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            yield node.name, f"{path}:{node.lineno}"
    for node in tree.body:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            yield node.targets[0].id, ast.unparse(node.value)


def test_a_name_stands_for_one_type() -> None:
    """Leaves out private names that no other module uses."""
    found: dict[str, set[str]] = {}
    for path in Path(robowidgets.__file__).parent.rglob("*.py"):
        if "node_modules" not in path.parts:
            for name, meant in definitions(ast.parse(path.read_text(encoding="utf-8")), str(path)):
                if re.match("[A-Z][A-Za-z]*[a-z]", name):
                    found.setdefault(name, set()).add(meant)
    assert len(found) > 200
    assert {name: meant for name, meant in found.items() if len(meant) > 1} == {}


@pytest.mark.parametrize(
    ("module", "old", "new"),
    [
        ("robowidgets", "Pose", Arrow),
        ("robowidgets.shapes", "Pose", Arrow),
        ("robowidgets.feeds", "Topic", FeedTopic),
        ("robowidgets.feeds.middleware", "NotYetError", NotConnectedYetError),
    ],
)
class TestTheOldNameOfAClass:
    def test_still_works_and_names_the_new_one_at_the_place_of_use(self, module: str, old: str, new: type) -> None:
        with pytest.warns(DeprecationWarning, match=rf"{module}\.{old} is called {module}\.{new.__name__} now") as told:
            assert getattr(import_module(module), old) is new
        assert [warning.filename for warning in told] == [__file__]

    def test_is_imported_as_before(self, module: str, old: str, new: type) -> None:
        names: dict[str, Any] = {}
        with pytest.warns(DeprecationWarning, match=new.__name__):
            exec(f"from {module} import {old}", names)
        assert names[old] is new

    def test_is_not_among_the_names_of_a_star_import(self, module: str, old: str, new: type) -> None:
        names: dict[str, Any] = {}
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            exec(f"from {module} import *", names)
        assert old not in names
        assert names[new.__name__] is new


def test_a_name_that_a_module_never_had_is_reported_plainly() -> None:
    with pytest.raises(AttributeError, match=r"module 'robowidgets.shapes' has no attribute 'Circle'$"):
        import_module("robowidgets.shapes").Circle  # noqa: B018


def test_no_test_sets_a_trace_function() -> None:
    """CPython 3.11 loops forever in every function after an error that a trace function raised."""
    refused = {"setprofile", "setprofile_all_threads", "settrace", "settrace_all_threads"}
    texts = {
        path: path.read_text(encoding="utf-8")
        for folder in ("robowidgets", "tests")
        for path in (ROOT / folder).rglob("*.py")
        if "node_modules" not in path.parts
    }
    found = [
        f"{path.relative_to(ROOT)}:{node.lineno}: {name}"
        for path, text in texts.items()
        if re.search("settrace|setprofile", text)
        for node in ast.walk(ast.parse(text))
        for name in names_in(node) & refused
    ]
    assert not found, "raise in a function that the code under test calls, or end a child process"


def names_in(node: ast.AST) -> set[str]:
    """Return the names that a node refers to or imports."""
    if isinstance(node, ast.ImportFrom):
        return {alias.name for alias in node.names}
    return {node.id} if isinstance(node, ast.Name) else {node.attr} if isinstance(node, ast.Attribute) else set()


def test_a_failed_test_is_not_repeated() -> None:
    """A test that fails one time in ten has a fault."""
    files = [ROOT / name for name in (".ci/run", "Makefile", "pyproject.toml")]
    files += [*(ROOT / "scripts").glob("*.sh"), *(ROOT / ".github" / "workflows").glob("*.yml")]
    files += [path for path in (ROOT / "tests").rglob("*.py") if path != Path(__file__)]
    found = [path for path in files if re.search("--reruns|rerunfailures|mark.flaky", path.read_text(encoding="utf-8"))]
    assert not found, "fix the tests that fail sometimes"
