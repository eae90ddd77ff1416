"""What a map is made of: layers, placed in one frame, and their bytes for the page."""
