"""What widgets and feeds share: the way to the page, cells of a notebook, speeds on their way to a robot."""
