"""When something held in a recording."""
