"""Rows that tests add: gauges that share a widget, and widgets on demand."""
