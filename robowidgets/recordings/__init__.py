"""Recordings of robots: files of messages, opened for reading as samples."""
