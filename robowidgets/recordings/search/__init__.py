"""Finding the spans of time in which a condition is true."""
