"""One module per library: NAME, SVG (a selector for its dots, unless it draws on a canvas), and `make(ranges)`.

`make` returns the object to display with these ranges, and a function that shows other ranges. Each library draws 1040
red dots of 3 pixels on about 760 by 560 pixels, in the way that its documentation recommends for live data.
"""

NAMES = ("laser", "bare", "matplotlib_ipympl", "plotly_gl", "plotly_svg", "bqplot_gl", "bqplot_svg")
