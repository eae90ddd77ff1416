"""A gas sensor for robowidgets: its concentration on one topic, its status on another."""
