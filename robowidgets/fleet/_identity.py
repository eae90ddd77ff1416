"""What a condition, or a function, is: a text that is the same for what computes the same."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cache, partial
from importlib.metadata import packages_distributions, version
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

    A function is told by its code, its defaults, and all it refers to; what is installed is told by its name alone.

    Raises:
        NotIdentifiedError: it refers to what may change without a trace, such as a module of the user's.
    """
    return _identity(value, ())


def _identity(value: Any, within: tuple[int, ...]) -> str:
    if isinstance(value, Enum) or type(value) in _PLAIN:
        return repr(value)
    if id(value) in within:
        return f"<{within.index(id(value))}>"  # a function that calls itself
    within = (*within, id(value))
    if isinstance(value, (tuple, list, set, frozenset)):
        inside = [_identity(one, within) for one in value]
        is_ordered = isinstance(value, (tuple, list))
        return f"{type(value).__qualname__}({', '.join(inside if is_ordered else sorted(inside))})"
    if isinstance(value, dict):
        items = (f"{_identity(key, within)}: {_identity(one, within)}" for key, one in value.items())
        return f"{{{', '.join(items)}}}"
    if isinstance(value, CodeType):
        names = (*value.co_names, *value.co_varnames, *value.co_freevars, *value.co_cellvars)
        return f"code({value.co_code.hex()}, {value.co_flags}, {names}, {_identity(value.co_consts, within)})"
    if isinstance(value, partial):
        return f"partial({_parts({'f': value.func, 'a': value.args, **value.keywords}, within)})"
    if isinstance(value, ModuleType):
        return _of_module(value.__name__)
    name, module = getattr(value, "__qualname__", ""), getattr(value, "__module__", None) or ""
    if name and "<" not in name and _version_of(module.partition(".")[0]):
        return f"{_of_module(module)}.{name}"
    if isinstance(value, FunctionType):
        return _of_function(value, within)
    if isinstance(value, MethodType):
        return f"{_identity(value.__self__, within)}.{_identity(value.__func__, within)}"
    kind = type(value)
    if getattr(kind, "is_lasting", True) is False:
        raise NotIdentifiedError(f"{value!r}")
    if is_dataclass(value) and _version_of(kind.__module__.partition(".")[0]):
        parts = {field.name: getattr(value, field.name) for field in fields(value)}
    elif kind.__module__.startswith(f"{_OURS}."):
        parts = vars(value)
    else:
        raise NotIdentifiedError(f"{value!r}")
    return f"{_of_module(kind.__module__)}.{kind.__qualname__}({_parts(parts, within)})"


def _of_function(function: FunctionType, within: tuple[int, ...]) -> str:
    closure = dict(zip(function.__code__.co_freevars, function.__closure__ or (), strict=True))
    try:
        enclosed = {name: cell.cell_contents for name, cell in closure.items()}
    except ValueError:  # a cell that has no value yet
        raise NotIdentifiedError(function.__qualname__) from None
    used = {name: function.__globals__[name] for name in _names(function.__code__) if name in function.__globals__}
    defaults = {"defaults": function.__defaults__ or (), **(function.__kwdefaults__ or {})}
    return f"{_identity(function.__code__, within)}({_parts({**used, **enclosed}, within)})({_parts(defaults, within)})"


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
    return version(packages_distributions()[package][0])
