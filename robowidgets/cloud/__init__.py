"""The cloud widget's room."""
