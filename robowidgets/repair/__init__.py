"""Readers for files that are damaged, or that the usual reader refuses.

They walk a file from its start, trust no index in it, take no more memory than there are bytes for, whatever it
claims, and give what can be saved as a `Source`. What was wrong stands in its ``problems``.
"""

from ._files import find_files, open_file

__all__ = ["find_files", "open_file"]
