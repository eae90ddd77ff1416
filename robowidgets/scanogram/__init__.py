"""Many scans as one picture: ranges as small numbers in several levels of detail, and the parts that a page asks for.

It imports NumPy and samples, but neither widgets nor recordings.
"""
