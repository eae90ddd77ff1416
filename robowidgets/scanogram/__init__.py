"""Many scans as one picture: ranges as codes in several levels of detail, and the parts that a page requests.

It imports NumPy and samples, but neither widgets nor recordings.
"""
