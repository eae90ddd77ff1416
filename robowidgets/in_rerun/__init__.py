"""A recording in Rerun: what it saw in the world, beside the widgets that show the hard data."""
