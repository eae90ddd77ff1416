"""The parts of a map: layers, their places in one frame, and their bytes for the page."""
