"""Time, threads and user code: the clock, the runner, limits, and how errors reach the user."""
