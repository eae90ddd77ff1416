"""Numbers over time: lines that grow, thinned without losing an extreme, and the bytes for the page."""
