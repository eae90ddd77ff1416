"""A user's function, rewritten so that it notes what it computes, and the verdict of a condition with its reasons."""
