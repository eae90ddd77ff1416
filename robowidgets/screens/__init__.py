"""One screen of several pictures, for a recording: its player, its layout, and pages in files."""
