"""Many scans as one picture: ranges as small numbers, the same coarser and coarser, and the parts that a page asks for.

It knows NumPy and samples, neither a page nor a recording.
"""
