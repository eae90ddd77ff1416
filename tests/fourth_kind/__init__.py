"""A fourth kind of sensor, added as any other is: a sample, a reader, a widget with its front end, and one row."""
