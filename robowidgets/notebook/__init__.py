"""The notebook that the kernel runs in: its cells, progress bars, and a kernel in the browser."""
