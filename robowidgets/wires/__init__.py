"""The wires widget's room."""
