"""A recording in Rerun, which shows the scans in the world frame."""
