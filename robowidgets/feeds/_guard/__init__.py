"""The guard: a process next to the kernel that sends speeds, and sends zero if the kernel is gone, frozen or late."""
