"""A recording in Rerun, which shows the scans in the world, beside the widgets that show the numbers."""
