"""The cloud widget: points with every field that their sensor measured, from above, from the side, or in rows."""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Mapping
from keyword import iskeyword
from math import ceil, inf, isfinite, sqrt
from typing import Any, ClassVar

import numpy as np
import traitlets
from numpy.typing import NDArray

from .messages import to_cloud
from .samples import Cloud
from .samples.cloud import AXES, MAX_POINTS, to_band
from .widget.front_end import bundle
from .widget.large_frames import LargeFrameWidget
from .widget.timed_frame import FRAME_HEADER
from .widget.traits import BandTrait

VIEWS = ("above", "side", "behind", "rows")
FORMS = ("points", "cloud", "array")
DISTANCE = "distance"
"""A value that colours and bounds points, in addition to their fields."""

LIVE_POINTS = 25_000
"""Points of a live cloud that the page gets. At 10 Hz it has time left for everything else."""

STILL_POINTS = 100_000
"""Points of a single cloud that the page gets."""

_LENGTH = struct.Struct("<I")
_ALIGNED = 8
_AS = {"b": "u1", "f2": "f4", "i8": "f8", "u8": "f8"}
"""Types of NumPy that are converted for the page, which has only the types of a PointField."""


class CloudWidget(LargeFrameWidget[Cloud]):
    """A live cloud of points with every field: from above, from the side, from behind, or in its rows.

    The widget shows the points to scale on a grid of metres, x forward and up in the picture, y to the left (REP-103),
    coloured by height, distance, or any field, with a legend. Pointing at a point shows its index, its row and column,
    x, y, z, distance and every field. A box around points, or a band along the legend, shows the number of points in it
    and the code for them. Space freezes, the wheel zooms; all this works without the kernel. A cloud with more points
    than the page can draw in time is thinned, and the picture says so; indices still count the whole cloud. If a
    message cannot be read, the last picture stays, with the reason above it.

    Args:
        title: title in the header; usually the topic.
        view: "above", "side" (from the right, x to the right), "behind" (y to the left), or "rows" (the rows of the
            cloud). The view writes it, too.
        color_by: "z" (height), "distance", the name of a field, or "" for one colour. The view writes it, too.
        color_range: two values at the ends of the colours; by default the range of the points on show.
        selection: lower and upper bounds by field, such as {"z": (0.1, 0.5)}. The points within all bounds are
            selected. The view writes it, too.
        most_points: the most points of a cloud that the page gets; by default 25,000 of repeated clouds, and 100,000 of
            a single one.
        view_range: metres from the middle to the edge of the picture; by default up to the farthest point.
        paused: True while the picture is frozen.
        history: seconds for which the page keeps samples to step back through while frozen, 0 (none) to 600.
        header, footer: False to hide them, for example to use the picture in a paper.

    Raises:
        TypeError: an unknown keyword.
        traitlets.TraitError: a value out of its range.

    Source: sensor_msgs/PointCloud2, REP-103.

    Examples:
        >>> clouds = CloudWidget(title="/points", selection={"z": (0.1, 0.5)})
        >>> clouds.update([[1.0, 0.0, 0.2], [2.0, 0.5, 1.4]])
        >>> clouds.selected["x"].tolist(), clouds.code()
        ([1.0], 'points[(z >= 0.1) & (z <= 0.5) & np.isfinite(x) & np.isfinite(y)]')
    """

    _esm, _css = bundle("cloud_widget")
    _meant: ClassVar = {"color": "color_by", "axis": "view", "box": "selection"}
    _instead: ClassVar = {"points": "widget.cloud.points"}
    column = "wide"
    sample_name = "cloud"
    frame_traits = ("most_points",)

    most_bytes: int | None = None
    """The most bytes of a frame, which a player sets by the rate of the clouds; None for the limit of live clouds."""

    view = traitlets.Enum(VIEWS, "above", help="The direction of view. Python and the view write it.").tag(sync=True)
    color_by = traitlets.Unicode("z", help="Field that colours the points. Python and the view write it.").tag(
        sync=True
    )
    color_range = BandTrait(None, allow_none=True, help="Values at the ends of the colours.").tag(sync=True)
    selection = traitlets.Dict(
        key_trait=traitlets.Unicode(), help="Bounds by field. Python and the view write it."
    ).tag(sync=True)
    most_points = traitlets.Int(
        None, allow_none=True, min=1, max=MAX_POINTS, help="The most points of a cloud that the page gets."
    ).tag(sync=True)
    view_range = traitlets.Float(
        None, allow_none=True, help="Metres to the edge of the picture, above 0, or None for all. Python writes it."
    ).tag(sync=True)

    def update(self, message: Any) -> None:
        """Show a cloud in the next animation frame.

        It only stores the cloud, and may be called from any thread at any rate; the newest wins.

        Args:
            message: a sensor_msgs/PointCloud2 or PointCloud of rclpy, rospy or rosbags, a rosbridge dictionary, numbers
                of shape (N, 3), a structured array, or a `Cloud`.

        Raises:
            TypeError: not such a message. ValueError: it does not contain points. A callback (another thread; a task,
                timer or button of a notebook) raises nothing; the widget and the log show the error.
        """
        try:
            cloud = to_cloud(message)
        except (TypeError, ValueError) as error:
            self._refuse(error)
        else:
            self._show(cloud)

    @property
    def cloud(self) -> Cloud | None:
        """The whole cloud on show: the frozen one while paused, or None before the first.

        While paused it is also None if the page has stepped back to a cloud that is no longer kept in Python, which
        keeps about 64 MB.
        """
        return self._sample_on_show()

    @property
    def frozen(self) -> Cloud | None:
        """The cloud on show while frozen, which may be stepped back to; None while live."""
        return self.cloud if self.paused else None

    @property
    def selected(self) -> NDArray[Any]:
        """The points of the cloud on show within the bounds of `selection`, or all points, as a structured array.

        Raises:
            ValueError: no cloud has come, or it has no such field.
        """
        cloud = self.cloud
        if cloud is None:
            raise ValueError("selected: no cloud has come yet; update(...) shows one")
        return cloud.points[cloud.inside(**self.selection)]

    def code(self, form: str = "points") -> str:
        """Return the code that selects the points of `selection`.

        Args:
            form: "points" for an array ``points``, and an array for each field under its name; "cloud" for a `Cloud`;
                "array" for numbers of shape (N, 3). If x, y or z has no bounds, the code uses NumPy as ``np`` to skip
                points that were not measured, except with a `Cloud`.

        Raises:
            ValueError: nothing is selected, an unknown form, or an array has no such field.
        """
        return selection_code(self.selection, form)

    def frame_of(self, sample: Any) -> tuple[dict[str, Any], bytes]:
        """See `RobotWidget`. The sample is a message, or a cloud."""
        try:
            cloud = to_cloud(sample)
        except (TypeError, ValueError) as error:
            return {"error": f"{error}."}, _pack(to_cloud([]), LIVE_POINTS)
        most = LIVE_POINTS
        if self.most_bytes is not None:
            most = max(1, self.most_bytes // cloud.points.dtype.itemsize)
        return self._about_sample(cloud), _pack(cloud, self.most_points or most)

    def _about_sample(self, sample: Cloud) -> dict[str, Any]:
        about: dict[str, Any] = {"frame_id": sample.frame_id}
        if self.selection and not self.driven_by_player:
            try:
                about["selected"] = [self.selection, int(sample.inside(**self.selection).sum())]
            except ValueError:
                about["selected"] = [self.selection, 0]
        return {**about, "problems": sample.problems} if sample.problems else about

    def _pack(self, sample: Cloud) -> bytes:
        return _pack(sample, self.most_points or (LIVE_POINTS if self.rate > 0 else STILL_POINTS))

    def _size_of(self, sample: Cloud) -> int:
        return int(sample.points.nbytes)

    @traitlets.observe("selection")
    def _select(self, _change: Any) -> None:
        """Count the selected points again, even of the cloud on show, because no other may come."""
        self._say_more()

    @traitlets.observe("most_points")
    def _thin(self, _change: Any) -> None:
        self._say_more()

    @traitlets.validate("selection")
    def _bands(self, proposal: Any) -> Any:
        try:
            bands = {name: to_band(f"selection[{name!r}]", band) for name, band in proposal["value"].items()}
        except ValueError as error:
            raise traitlets.TraitError(str(error)) from None
        if not all(isfinite(bound) for band in bands.values() for bound in band):
            raise traitlets.TraitError(f"selection: expected finite bounds, got {proposal['value']!r}")
        return {name: list(band) for name, band in bands.items()}

    @traitlets.validate("view_range")
    def _metres(self, proposal: Any) -> Any:
        value = proposal["value"]
        if value is not None and not 0 < value < inf:
            raise traitlets.TraitError(f"view_range: expected metres above 0, or None, got {value!r}")
        return value


def selection_code(selection: Mapping[str, Any], form: str = "points") -> str:
    """See `CloudWidget.code`."""
    if not selection:
        raise ValueError("code: nothing is selected; selection = {'z': (0.1, 0.5)} selects points")
    if form not in FORMS:
        raise ValueError(f"form: expected {', '.join(map(repr, FORMS))}, got {form!r}")
    if form == "array" and (others := [field for field in selection if field not in AXES]):
        raise ValueError(f"form: an array of shape (N, 3) has no {', '.join(others)}")
    bands = [(field, _number_code(low), _number_code(high)) for field, (low, high) in selection.items()]
    if form == "cloud":
        named = [f"{field}=({low}, {high})" for field, low, high in bands if _is_name(field)]
        keyed = ", ".join(f"{_quoted(field)}: ({low}, {high})" for field, low, high in bands if not _is_name(field))
        named += [f"**{{{keyed}}}"] if keyed else []
        return f"cloud.points[cloud.inside({', '.join(named)})]"
    parts = [
        f"({_field_code(field, form)} >= {low}) & ({_field_code(field, form)} <= {high})" for field, low, high in bands
    ]
    # Bounds exclude NaN and infinity. Bounds of the distance exclude them in x, y and z.
    unbounded = [axis for axis in AXES if axis not in selection and DISTANCE not in selection]
    parts += [f"np.isfinite({_field_code(axis, form)})" for axis in unbounded]
    return f"points[{' & '.join(parts)}]"


def _field_code(field: str, form: str) -> str:
    if form == "array":
        return f"points[:, {AXES.index(field)}]"
    return field if _is_name(field) and field not in ("points", "np") else f"points[{_quoted(field)}]"


def _is_name(text: str) -> bool:
    """Return True if a text is an ASCII identifier for code, as in `js/shared/python.ts`."""
    return re.fullmatch(r"[A-Za-z_]\w*", text, re.ASCII) is not None and not iskeyword(text)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _number_code(value: float) -> str:
    """Return a number with all digits, and whole numbers without a point."""
    return repr(value + 0.0).removesuffix(".0")


def _pack(cloud: Cloud, most: int) -> bytes:
    """Return the facts of a cloud as JSON, and a column for each field of the points that the page gets.

    It gets every n-th row and column of a cloud in rows, else every n-th point.
    """
    count = len(cloud)
    if cloud.rows > 1:
        step = max(1, ceil(sqrt(count / most)))
        drawn = cloud.points.reshape(cloud.rows, cloud.columns)[::step, ::step].reshape(-1)
    else:
        step = max(1, ceil(count / most))
        drawn = cloud.points[::step]
    columns: list[bytes] = []
    fields: list[list[Any]] = []
    for name in cloud.fields:
        column: NDArray[Any] = drawn[name]
        kind = _AS.get(column.dtype.kind, _AS.get(column.dtype.str[1:], column.dtype.str[1:]))
        column = np.ascontiguousarray(column, np.dtype(kind).newbyteorder("<"))
        fields.append([name, kind, int(np.prod(column.shape[1:]))])
        columns.append(column.tobytes())
    facts = {
        "total": count,
        "rows": cloud.rows,
        "step": step,
        "drawn": int(drawn.size),
        "unmeasured": count - int(cloud.valid.sum()),
        "fields": fields,
    }
    text = json.dumps(facts).encode()
    parts = [_LENGTH.pack(len(text)), text]
    size = FRAME_HEADER.size + _LENGTH.size + len(text)
    for raw in columns:
        # Typed arrays of the page must start at multiples of their size.
        gap = -size % _ALIGNED
        parts += [bytes(gap), raw]
        size += gap + len(raw)
    return b"".join(parts)
