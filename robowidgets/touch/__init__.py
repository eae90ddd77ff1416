"""The touch widget's room."""
