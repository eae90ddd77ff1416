"""Shared parts import no room, a room imports one other at most, and nothing imports in a circle."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path

import pytest

import robowidgets

ROOT = Path(robowidgets.__file__).parent
JS = ROOT / "js"

SHARED = (
    *("samples", "messages", "poses", "camera", "shapes", "repair", "files"),
    *("runtime", "reasons", "notebook", "widget", "kinds", "recordings", "conditions", "tracks"),
    *("in_rerun", "behaviors", "driving", "simulator"),
)
"""Values, the base of widgets, recordings, and what drives robots: they import no room."""

ROOMS = (
    *("laser", "speed", "touch", "sonar", "image", "cloud", "path", "plots", "message", "events", "wires"),
    *("scanogram", "lines", "machine", "program", "sheet", "drive", "stop", "topics", "player", "screen"),
)
"""The rooms of one picture each: its widget, and all that only this picture needs. A room imports one other at most."""

ABOVE = ("rooms", "screens", "export", "feeds", "_plot", "_compare", "recording", "__init__", "__main__")
"""The parts that put pictures together."""

LEAVES = {
    "lessons": {"__init__", "command"},
    "fleet": {"__init__", "assistants", "command"},
    "assistants": {"__init__", "command"},
    "command": {"__main__"},
}
"""Parts that only these other parts may import."""


def name_of(path: Path) -> str:
    """The module in a file, without the name of the package: ``laser.frames``, ``feeds`` for its ``__init__``."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" and len(parts) > 1 else parts)


@cache
def modules() -> dict[str, Path]:
    return {name_of(path): path for path in sorted(ROOT.rglob("*.py"))}


def statements(node: ast.Module, *, at_once: bool = False) -> Iterator[ast.Import | ast.ImportFrom]:
    """The imports in a module, including imports in functions and for type checkers, unless ``at_once``."""
    for child in node.body if at_once else ast.walk(node):
        if isinstance(child, (ast.Import, ast.ImportFrom)):
            yield child


@cache
def imports(module: str, *, at_once: bool = False) -> frozenset[str]:
    """The modules of robowidgets that a module imports."""
    path = modules()[module]
    package = path.parent.relative_to(ROOT).parts
    found = set()
    for statement in statements(ast.parse(path.read_text(encoding="utf-8")), at_once=at_once):
        if isinstance(statement, ast.Import):
            names = [alias.name.split(".") for alias in statement.names]
            found |= {known(parts[1:]) for parts in names if parts[0] == "robowidgets"}
            continue
        base = [*package[: len(package) + 1 - statement.level]] if statement.level else []
        base += (statement.module or "").split(".") if statement.module else []
        if not statement.level:
            if base[:1] != ["robowidgets"]:
                continue
            base = base[1:]
        found |= {known([*base, alias.name]) for alias in statement.names}
    return frozenset(found - {module})


def known(parts: list[str]) -> str:
    """The longest prefix of a dotted name that is a module; the package itself is ``__init__``."""
    for length in range(len(parts), 0, -1):
        if (name := ".".join(parts[:length])) in modules():
            return name
    return "__init__"


def pairs() -> list[tuple[str, str]]:
    return [(module, other) for module in modules() for other in sorted(imports(module))]


@cache
def parts() -> dict[str, set[str]]:
    """Each part with the other parts that it imports."""
    found: dict[str, set[str]] = {part_of(module): set() for module in modules()}
    for module, other in pairs():
        found[part_of(module)].add(part_of(other))
    return {part: others - {part} for part, others in found.items()}


def test_each_part_is_shared_or_a_room_or_puts_rooms_together_or_is_a_leaf() -> None:
    assert sorted(parts()) == sorted((*SHARED, *ROOMS, *ABOVE, *LEAVES))


def test_shared_parts_import_shared_parts_alone() -> None:
    assert {part: others for part in SHARED if (others := parts()[part] - {*SHARED})} == {}


def test_a_room_imports_one_other_room_at_most_and_nothing_above() -> None:
    assert {room: others for room in ROOMS if len(others := parts()[room] & {*ROOMS}) > 1} == {}
    assert {room: others for room in ROOMS if (others := parts()[room] - {*SHARED, *ROOMS})} == {}


def test_leaves_are_imported_by_their_users_alone() -> None:
    for leaf, users in LEAVES.items():
        assert {part for part, others in parts().items() if leaf in others} - users == set(), leaf


def test_no_parts_import_each_other_in_a_circle() -> None:
    refuse_circles({part: sorted(others) for part, others in parts().items()})


def test_no_modules_import_each_other_in_a_circle_for_types_neither() -> None:
    refuse_circles({module: sorted(imports(module)) for module in modules()})


def refuse_circles(graph: Mapping[str, Sequence[str]]) -> None:
    done: set[str] = set()
    path: list[str] = []

    def visit(name: str) -> None:
        if name in path:
            pytest.fail("a circle: " + " -> ".join([*path[path.index(name) :], name]))
        if name not in done:
            path.append(name)
            for other in graph[name]:
                visit(other)
            path.pop()
            done.add(name)

    for name in graph:
        visit(name)


def test_reading_recordings_imports_neither_widgets_nor_traits() -> None:
    for module in modules():
        if part_of(module) == "recordings" and not module.startswith("recordings.search"):
            for name in reached(module):
                assert not is_widget(name), f"{module} imports {name}"
                assert not packages(name) & {"traitlets", "ipywidgets", "anywidget"}, f"{module} imports {name}"


def test_rows_import_their_classes_when_they_are_first_used() -> None:
    """Otherwise `robowidgets.kinds`, which recordings need, would import all widgets."""
    seen: set[str] = set()
    left = ["rooms"]
    while left:
        if (name := left.pop()) not in seen:
            seen.add(name)
            left += {*imports(name, at_once=True), *([package] if (package := name.rpartition(".")[0]) else [])}
    assert {part_of(name) + ".row" for name in parts()["rooms"] & {*ROOMS}} <= seen
    heavy = {"recordings", "tracks", "in_rerun", "simulator", "widget"}
    assert [name for name in sorted(seen) if is_widget(name) or part_of(name) in heavy] == []
    assert [name for name in sorted(seen) if packages(name) & {"traitlets", "ipywidgets", "anywidget"}] == []


def is_widget(module: str) -> bool:
    return "." not in module and module.endswith("_widget")


def reached(module: str) -> set[str]:
    """A module and all that it imports, directly or not."""
    seen: set[str] = set()
    left = [module]
    while left:
        if (name := left.pop()) not in seen:
            seen.add(name)
            left += imports(name)
    return seen


@cache
def packages(module: str) -> set[str]:
    """The packages that a module imports itself."""
    found = set()
    for statement in statements(ast.parse(modules()[module].read_text(encoding="utf-8"))):
        names = [statement.module or ""] if isinstance(statement, ast.ImportFrom) else [a.name for a in statement.names]
        found |= {name.split(".")[0] for name in names}
    return found


def part_of(module: str) -> str:
    """The part of a module: its folder; of a widget, the room of that name. `robowidgets.plot` is a function."""
    part = module.split(".")[0].removesuffix("_widget")
    return "plots" if part == "plot" else part


def is_private(module: str) -> bool:
    """Return True if a module, or a folder that contains it, is private to its part."""
    return any(name.startswith("_") for name in module.split(".")[1:])


def test_private_modules_are_imported_by_their_own_part_alone() -> None:
    assert not [(module, other) for module, other in pairs() if is_private(other) and part_of(module) != part_of(other)]


def front_end_imports() -> Iterator[tuple[str, str]]:
    """Each file in a folder of the front end, with the project's files that it imports."""
    for path in (*JS.glob("*/*.ts"), *JS.glob("shared/*/*.ts"), *JS.glob("*/*.css")):
        for name in re.findall(r'(?:from|import) "(\.[^"]+)"', path.read_text(encoding="utf-8")):
            yield path.relative_to(JS).as_posix(), (path.parent / name).resolve().relative_to(JS).as_posix()


def test_a_folder_of_the_front_end_imports_from_itself_and_shared_alone() -> None:
    """The scripts of exported pages and of the documentation, ``export/`` and ``site/``, consist of the widgets."""
    pairs = [(file, other) for file, other in front_end_imports() if not file.startswith(("export/", "site/"))]
    assert pairs
    assert [pair for pair in pairs if pair[1].split("/")[0] not in (pair[0].split("/")[0], "shared")] == []


def loaded_by(entry: Path) -> set[Path]:
    """A file of the front end and all that it imports, directly or not."""
    seen: set[Path] = set()
    left = [entry.resolve()]
    while left:
        if (path := left.pop()) not in seen:
            seen.add(path)
            names = re.findall(r'(?:from|import) "(\.[^"]+)"', path.read_text(encoding="utf-8"))
            left += [(path.parent / name).resolve() for name in names]
    return seen


def test_each_file_of_the_front_end_is_in_a_script_or_a_stylesheet() -> None:
    entry = r"(_widget|^export_\w+|^run_once|^later)\.(ts|css)$"
    built = [path for path in JS.iterdir() if re.search(entry, path.name)]
    used = {path for file in (*built, *JS.glob("site/*.ts")) for path in loaded_by(file)}
    files = [*JS.glob("*/*.ts"), *JS.glob("shared/*/*.ts"), *JS.glob("*/*.css")]
    assert [path.relative_to(JS).as_posix() for path in files if path.resolve() not in used] == []


def test_each_layer_of_the_laser_is_made() -> None:
    view = (JS / "laser" / "view.ts").read_text(encoding="utf-8")
    classes = [
        name
        for path in (JS / "laser").glob("*.ts")
        for name in re.findall(r"export class (\w+) implements Layer\b", path.read_text(encoding="utf-8"))
    ]
    assert classes
    assert [name for name in classes if f"new {name}(" not in view] == []
