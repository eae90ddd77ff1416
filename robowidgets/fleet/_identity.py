"""What a condition, or a function, is: a text that is the same for what computes the same."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache, partial
from hashlib import sha256
from importlib.metadata import distribution, packages_distributions, version
from importlib.util import find_spec
from pathlib import Path
from types import CodeType, FunctionType, MethodType, ModuleType
from typing import Any

_OURS = __name__.partition(".")[0]
_PLAIN = (type(None), bool, int, float, complex, str, bytes, type(Ellipsis))


class NotIdentifiedError(Exception):
    """What it computes may depend on what cannot be told."""


def identity_of(value: Any) -> str:
    """A text for a value that is the same, in each process, for all values that compute the same.

    A function is told by its code, its defaults, and all it refers to; what is installed is told by its name and its
    version.

    Raises:
        NotIdentifiedError: it refers to what may change without a trace, such as a module of the user's.
    """
    return _identity(value, ())


def _identity(value: Any, within: tuple[int, ...]) -> str:
    kind = type(value)
    if kind in _PLAIN:
        return repr(value)
    if isinstance(value, Enum):
        return f"{_of_module(kind.__module__)}.{value!r}"
    if id(value) in within:
        return f"<{within.index(id(value))}>"  # a function that calls itself
    within = (*within, id(value))
    if isinstance(value, (tuple, list, set, frozenset)):
        inside = [_identity(one, within) for one in value]
        is_ordered = isinstance(value, (tuple, list))
        name = f"{_of_module(kind.__module__)}.{kind.__qualname__}"
        return f"{name}({', '.join(inside if is_ordered else sorted(inside))})"
    if kind is dict:
        items = (f"{_identity(key, within)}: {_identity(one, within)}" for key, one in value.items())
        return f"{{{', '.join(items)}}}"
    if isinstance(value, CodeType):
        names = (*value.co_names, *value.co_varnames, *value.co_freevars, *value.co_cellvars)
        handlers = getattr(value, "co_exceptiontable", b"")  # which part of the code is within a try, since Python 3.11
        parts = f"{value.co_code.hex()}, {handlers.hex()}, {value.co_flags}, {names}"
        return f"code({parts}, {_identity(value.co_consts, within)})"
    if kind is partial:
        return f"partial({', '.join(_identity(one, within) for one in (value.func, value.args, value.keywords))})"
    if isinstance(value, ModuleType):
        return _of_module(value.__name__)
    if isinstance(value, MethodType):
        return f"{_identity(value.__self__, within)}.{_identity(value.__func__, within)}"
    name, module = getattr(value, "__qualname__", ""), getattr(value, "__module__", None) or ""
    if name and _at(module, name) is value and _version_of(module.partition(".")[0]):
        return f"{_of_module(module)}.{name}"
    if isinstance(value, FunctionType):
        return _of_function(value, within)
    if getattr(kind, "is_lasting", True) is False:
        raise NotIdentifiedError(f"{value!r}")
    if is_dataclass(value) and not isinstance(value, type) and _version_of(kind.__module__.partition(".")[0]):
        values = {field.name: getattr(value, field.name) for field in fields(value)}
    elif kind.__module__.startswith(f"{_OURS}."):
        values = vars(value)
    else:
        raise NotIdentifiedError(f"{value!r}")
    return f"{_of_module(kind.__module__)}.{kind.__qualname__}({_parts(values, within)})"


def _at(module: str, name: str) -> Any:
    """What has this name in a module that is loaded; None for a name that somebody only gave to another thing."""
    found: Any = sys.modules.get(module)
    for part in name.split("."):
        found = getattr(found, part, None)
    return getattr(found, "__func__", found)


def _of_function(function: FunctionType, within: tuple[int, ...]) -> str:
    closure = dict(zip(function.__code__.co_freevars, function.__closure__ or (), strict=True))
    try:
        enclosed = {name: cell.cell_contents for name, cell in closure.items()}
    except ValueError:  # a cell that has no value yet
        raise NotIdentifiedError(function.__qualname__) from None
    used = {name: function.__globals__[name] for name in _names(function.__code__) if name in function.__globals__}
    defaults = function.__defaults__ or (), function.__kwdefaults__ or {}
    told = f"({_parts(used, within)})({_parts(enclosed, within)})({_identity(defaults, within)})"
    return f"{_identity(function.__code__, within)}{told}"


def _names(code: CodeType) -> set[str]:
    inner = (one for one in code.co_consts if isinstance(one, CodeType))
    return set(code.co_names).union(*map(_names, inner))


def _parts(parts: Mapping[str, Any], within: tuple[int, ...]) -> str:
    return ", ".join(f"{name}={_identity(parts[name], within)}" for name in sorted(parts))


def _of_module(name: str) -> str:
    version = _version_of(name.partition(".")[0])
    if version is None:
        raise NotIdentifiedError(name)
    return f"{name} {version}"


@cache
def _version_of(package: str) -> str | None:
    """The version of what is installed; None for what may change from run to run, as files of the user's own do."""
    if package == "builtins" or package in sys.stdlib_module_names:
        return sys.version
    if package == _OURS:
        return version(package)
    spec = find_spec(package) if package in packages_distributions() else None
    places = [] if spec is None else [*(spec.submodule_search_locations or filter(None, [spec.origin]))]
    if not any(Path(place).parent.name in ("site-packages", "dist-packages") for place in places):
        return None  # of a project that is being written, say, which was installed as editable
    return ", ".join(map(_of_distribution, sorted(set(packages_distributions()[package]))))


def _of_distribution(name: str) -> str:
    """The version of what is installed, with a digest of its files: one may be built anew under the same version."""
    files = distribution(name).read_text("RECORD") or ""
    return f"{version(name)} {sha256(files.encode()).hexdigest()[:16]}"
