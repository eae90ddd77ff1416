"""The poses of a robot's coordinate frames through a recording."""
