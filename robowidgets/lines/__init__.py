"""The lines of a program on the page: over a recording, numbers that are changed, and versions that are compared."""
