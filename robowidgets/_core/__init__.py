"""Parts shared by widgets and feeds: sending to the page, notebook cells, sending speeds to a robot."""
