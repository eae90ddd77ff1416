"""Parts of the laser widget: sectors, a ghost to compare with, the footprint of the robot, and others."""
