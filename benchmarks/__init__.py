"""robowidgets compared with other libraries, with the same scan in one JupyterLab: `make bench` writes RESULTS.md."""
