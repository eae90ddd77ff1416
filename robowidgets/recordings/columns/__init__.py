"""The samples of a topic as columns."""
