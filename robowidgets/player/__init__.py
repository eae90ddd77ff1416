"""The player: a recording on the page."""
