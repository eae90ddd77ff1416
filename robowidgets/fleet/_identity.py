"""The text of a question with stored results: equal for equal questions."""

from __future__ import annotations

import sys
from enum import Enum
from typing import Any

_OURS = f"{__name__.partition('.')[0]}."
_PLAIN = (type(None), bool, int, float, complex, str, bytes, type(Ellipsis))


class NotIdentifiedError(Exception):
    """A question contains code or objects of the user, which may change unseen."""


def identity_of(value: Any) -> str:
    """Return a text that is equal, in each process, for equal questions.

    It accepts plain values and objects of robowidgets, such as its conditions with their arguments. Functions of the
    user are not accepted, because their results may change: they may read a file, a module or the environment.

    Raises:
        NotIdentifiedError: the value contains anything else.
    """
    kind = type(value)
    if kind in _PLAIN:
        return repr(value)
    if callable(value) and (place := _place_of(value)):
        return place
    if not (kind.__module__ == "builtins" or kind.__module__.startswith(_OURS)):
        raise NotIdentifiedError(repr(value))
    name = f"{kind.__module__}.{kind.__qualname__}"
    if isinstance(value, Enum):
        return f"{name}.{value.name}"
    if isinstance(value, (tuple, list)):
        return f"{name}({', '.join(map(identity_of, value))})"
    if isinstance(value, (set, frozenset)):
        return f"{name}({', '.join(sorted(map(identity_of, value)))})"
    if isinstance(value, dict):
        return f"{name}({', '.join(sorted(f'{identity_of(key)}: {identity_of(one)}' for key, one in value.items()))})"
    if kind.__module__ == "builtins" or not hasattr(value, "__dict__") or not getattr(kind, "is_lasting", True):
        raise NotIdentifiedError(repr(value))
    return f"{name}({identity_of(vars(value))})"


def _place_of(function: Any) -> str:
    """Return the place of a function of robowidgets or NumPy, or "" for any other object."""
    module, name = getattr(function, "__module__", None) or "", getattr(function, "__qualname__", "")
    if not (module == "numpy" or module.startswith(_OURS)):
        return ""
    found: Any = sys.modules.get(module)
    for part in name.split("."):
        found = getattr(found, part, None)
    return f"{module}.{name}" if found is function else ""
