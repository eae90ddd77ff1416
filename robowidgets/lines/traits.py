"""The traits of a view of a program's lines, live or over a recording."""

from __future__ import annotations

import traitlets

from ..widget.base_widget import NamedWidget
from ..widget.front_end import bundle
from ..widget.traits import Flag


class LinesTraits(NamedWidget):
    """The traits of both widgets of lines, which share a front end."""

    _esm, _css = bundle("lines_widget")

    folded = Flag(False, help="True to show only one line. Python and the view write it.").tag(sync=True)

    _code = traitlets.Dict(help="Name and version of a program, and its functions that were called.").tag(
        sync=True, echo_update=False
    )
    _drive = traitlets.Dict(help="Over a recording, its span and the graph of each line; empty without one.").tag(
        sync=True, echo_update=False
    )
    _chosen = traitlets.Dict(help="The line whose spans are marked, with their number; empty without one.").tag(
        sync=True, echo_update=False
    )
    _offer = traitlets.Unicode(help="The text of a button that computes the values; empty without one.").tag(
        sync=True, echo_update=False
    )
    _number = traitlets.Dict(help="The number that the page changes, and its effect; empty without one.").tag(
        sync=True, echo_update=False
    )
    _compared = traitlets.Dict(help="The steps in which a new version decides otherwise; empty without one.").tag(
        sync=True, echo_update=False
    )
