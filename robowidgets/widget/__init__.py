"""The base of widgets: their traits, and what they send to the page."""
