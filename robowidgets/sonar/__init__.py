"""The room of sonars."""
