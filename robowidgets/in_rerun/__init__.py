"""A recording in Rerun, with its scans in the world frame."""
