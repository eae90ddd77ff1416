"""The room of speeds."""
