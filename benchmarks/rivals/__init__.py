"""One module per library: NAME, how the page finds its dots (SVG: a selector; canvases need none), and `make(ranges)`,
which gives what to display, with these ranges on show, and the function that shows others.

Each draws 1040 red dots of 3 pixels on about 760 by 560 pixels, in the way its documentation advises for live data.
"""

NAMES = ("laser", "bare", "matplotlib_ipympl", "plotly_gl", "plotly_svg", "bqplot_gl", "bqplot_svg")
