"""A fourth kind of sensor, added like any other: a sample, a reader, a widget with its front end, and one row."""
