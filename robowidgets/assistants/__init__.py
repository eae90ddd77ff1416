"""Recordings and robots for assistants, by the Model Context Protocol (extra ``mcp``): to see, and to drive if allowed.

`robowidgets mcp` serves them from a process of its own, and `assistant` from the process of a notebook.
"""

from .hand import DriveLimits
from .in_kernel import MISSING, Assistant, assistant

__all__ = ["MISSING", "Assistant", "DriveLimits", "assistant"]
