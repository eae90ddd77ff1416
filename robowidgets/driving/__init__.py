"""Driving a robot from a page or a program: speeds and the zero after them, Stop, and the widgets that have a Stop."""
