"""Parts shared by widgets and feeds: the base of widgets, sending to the page, notebook cells, user functions."""
