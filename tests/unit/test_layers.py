"""Each part of robowidgets imports only parts below it, and no modules import each other."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import fields
from functools import cache
from pathlib import Path

import pytest

import robowidgets
from robowidgets._core.robot_widget import PAGES
from robowidgets.kinds import ASKED, KINDS, Kind

ROOT = Path(robowidgets.__file__).parent
JS = ROOT / "js"

LAYERS = (
    "__main__ command",
    "__init__",
    "fleet",
    "recording",
    "_compare",
    "player in_rerun export _plot",
    "feeds",
    "search doctor",
    "recordings",
    "*_widget _widget_choice _layout _together",
    "behaviors lessons",
    "driving imaging laser maps message_tree plotting scanogram",
    "camera kinds poses shapes simulator",
    "repair",
    "_core",
    "messages",
    "samples",
)
"""From top to bottom: the modules and folders of the package, ``*`` standing for any beginning of a name."""

DOCUMENTED = frozenset({"messages.dialects"})
"""Public as lists of names, though nothing else imports them."""


def name_of(path: Path) -> str:
    """The module in a file, without the name of the package: ``player._frames``, ``feeds`` for its ``__init__``."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" and len(parts) > 1 else parts)


@cache
def modules() -> dict[str, Path]:
    return {name_of(path): path for path in sorted(ROOT.rglob("*.py"))}


def statements(node: ast.AST) -> Iterator[ast.Import | ast.ImportFrom]:
    """The imports in a syntax tree, including those in functions and those for type checkers."""
    for child in ast.walk(node):
        if isinstance(child, (ast.Import, ast.ImportFrom)):
            yield child


@cache
def imports(module: str) -> frozenset[str]:
    """The modules of robowidgets that a module imports."""
    path = modules()[module]
    package = path.parent.relative_to(ROOT).parts
    found = set()
    for statement in statements(ast.parse(path.read_text(encoding="utf-8"))):
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


def layer(module: str) -> int:
    """The number of the layer of a module, 0 on top."""
    part = module.split(".")[0]
    for number, names in enumerate(LAYERS):
        if any(part.endswith(name[1:]) if name.startswith("*") else part == name for name in names.split()):
            return number
    pytest.fail(f"robowidgets.{module} belongs to no layer: give it a place in LAYERS")


def pairs() -> list[tuple[str, str]]:
    return [(module, other) for module in modules() for other in sorted(imports(module))]


def test_each_part_imports_only_from_those_below_it_for_types_too() -> None:
    assert not [(module, other) for module, other in pairs() if layer(other) < layer(module)]


def test_no_modules_import_each_other_in_a_circle_for_types_neither() -> None:
    done: set[str] = set()
    path: list[str] = []

    def visit(module: str) -> None:
        if module in path:
            pytest.fail("a circle: " + " -> ".join([*path[path.index(module) :], module]))
        if module not in done:
            path.append(module)
            for other in sorted(imports(module)):
                visit(other)
            path.pop()
            done.add(module)

    for module in modules():
        visit(module)


def test_reading_recordings_imports_neither_widgets_nor_traits() -> None:
    for module in modules():
        if module.split(".")[0] == "recordings":
            for name in reached(module):
                assert not name.endswith("_widget"), f"{module} imports {name}"
                assert not packages(name) & {"traitlets", "ipywidgets", "anywidget"}, f"{module} imports {name}"


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
    return module.split(".")[0]


def is_private(module: str) -> bool:
    """Return True if a module, or a folder that contains it, is private to its part."""
    return any(name.startswith("_") for name in module.split(".")[1:])


def test_private_modules_are_imported_by_their_own_part_alone() -> None:
    assert not [(module, other) for module, other in pairs() if is_private(other) and part_of(module) != part_of(other)]


def test_public_modules_are_imported_by_other_parts_exported_or_named_in_the_table_of_kinds() -> None:
    used = {other for module, other in pairs() if part_of(module) != part_of(other)}
    values = [value for row in (*KINDS.values(), *ASKED.values()) for value in vars(row).values()]
    values += [field.default for field in fields(Kind)]
    references = [value for value in values if isinstance(value, str) and ":" in value]
    named = {reference.partition(":")[0].removeprefix("robowidgets.") for reference in (*references, PAGES)}
    for module in modules():
        folder = module.rpartition(".")[0]
        is_public = not module.startswith("_") and not is_private(module)
        if folder and is_public and module not in used | named | DOCUMENTED:
            assert is_package(module) or module in imports(folder), f"only its own part uses robowidgets.{module}"


def is_package(module: str) -> bool:
    return modules()[module].name == "__init__.py"


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
    built = [path for path in JS.iterdir() if re.search(r"(_widget|^export_\w+|^run_once)\.(ts|css)$", path.name)]
    used = {path for entry in (*built, *JS.glob("site/*.ts")) for path in loaded_by(entry)}
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
