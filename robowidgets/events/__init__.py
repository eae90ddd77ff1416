"""The events widget's room."""
