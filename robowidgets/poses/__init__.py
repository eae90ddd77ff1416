"""Where the frames of a robot were."""
