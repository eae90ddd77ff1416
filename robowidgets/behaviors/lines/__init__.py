"""Programs with the values of each line: the source of a step, rewritten so that it notes what it computes."""

from ...reasons.places import FunctionSource, NotedPlace
from ...reasons.rewriting import NotRewrittenError, Rewritten, rewritten
from .noting import CallNotes, Notebook, Noted
from .shown import lines_of, passes_of
from .values import keep, number_text, text_of

__all__ = [
    "CallNotes",
    "FunctionSource",
    "NotRewrittenError",
    "Notebook",
    "Noted",
    "NotedPlace",
    "Rewritten",
    "keep",
    "lines_of",
    "number_text",
    "passes_of",
    "rewritten",
    "text_of",
]
