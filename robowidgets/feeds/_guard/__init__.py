"""The guard: a process beside the kernel that sends speeds, and zero when the kernel is gone, frozen or late."""
