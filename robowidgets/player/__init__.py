"""A recording on the page."""
