"""Live data of a running robot, whatever it speaks."""
