"""The check-up of a recording."""
