"""A page in a file: widgets and what they show, without a kernel, a server or the web."""
