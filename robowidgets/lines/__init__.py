"""The lines of a program over a recording, on the page."""
