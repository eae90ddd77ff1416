"""robowidgets beside other libraries, on the same scan in the same JupyterLab: `make bench` writes RESULTS.md."""
