"""What the laser widget has besides a scan: sectors, a ghost to compare with, and the footprint of the robot."""
