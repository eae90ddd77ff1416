"""A page in a file: widgets with their data, without a kernel, a server or a network."""
