"""The cloud view: points with every field that their sensor measured, from above, from the side, or in rows."""

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

from ._core.front_end import bundle
from ._core.large_frames import LargeFrameWidget
from ._core.timed_frame import FRAME_HEADER
from ._core.traits import BandTrait
from .messages import to_cloud
from .samples import Cloud
from .samples.cloud import AXES, MAX_POINTS, to_band

VIEWS = ("above", "side", "behind", "rows")
FORMS = ("points", "cloud", "array")
DISTANCE = "distance"
"""What colours and bounds points, besides their fields."""

LIVE_POINTS = 25_000
"""Points that the page gets of each cloud, for which 10 Hz leave it time for all else."""

STILL_POINTS = 100_000
"""Of a cloud that stands alone."""

_LENGTH = struct.Struct("<I")
_ALIGNED = 8
_AS = {"b": "u1", "f2": "f4", "i8": "f8", "u8": "f8"}
"""Types of NumPy that the page gets as others; it has those that a PointField may have."""


class CloudWidget(LargeFrameWidget[Cloud]):
    """A cloud of points, live: from above, from the side, from behind, or as it lies in rows, with every field.

    The reader sees the points to scale on a grid of metres, x forward and up in the picture, y to the left (REP-103),
    coloured by height, distance, or any field, with a legend. Pointing at one names its index, its row and column, x,
    y, z, distance and every field. A box drawn over points, or a band along the legend, tells how many points are in
    it, and gives the code for them. Space freezes, the wheel zooms; none of it needs the kernel. A cloud of more points
    than the page can draw in time is thinned there, which the picture says; indices stay those of the cloud. What
    cannot be understood leaves the last picture and says why above it.

    Args:
        title: what is shown, for the header; usually the topic.
        view: "above", "side" (from the right, x to the right), "behind" (y to the left), or "rows" (as it lies in
            rows). The view writes it, too.
        color_by: "z" (height), "distance", the name of a field, or "" for one colour. The view writes it, too.
        color_range: two values, between which the colours lie; None: those of the points on show.
        selection: field to its lower and upper bound, such as {"z": (0.1, 0.5)}: the points within all of them are
            selected. The view writes it, too.
        most_points: how many points the page gets of each cloud; None: 25,000 of clouds that come again and again,
            100,000 of one that stands alone.
        view_range: metres from the middle to the edge of the picture; None: as far as the points reach.
        paused: whether the picture is frozen.
        history: seconds for which the page keeps samples to step back through while frozen, 0 (none) to 600.
        header, footer: whether they are there; without them the picture alone is fit for a paper.

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
    """Of a frame of a player, which says so by how often clouds come; None: as many as of live clouds."""

    view = traitlets.Enum(VIEWS, "above", help="From where. Python and the view write it.").tag(sync=True)
    color_by = traitlets.Unicode("z", help="Field that colours the points. Python and the view write it.").tag(
        sync=True
    )
    color_range = BandTrait(None, allow_none=True, help="Values between which the colours lie.").tag(sync=True)
    selection = traitlets.Dict(
        key_trait=traitlets.Unicode(), help="Field to its bounds. Python and the view write it."
    ).tag(sync=True)
    most_points = traitlets.Int(
        None, allow_none=True, min=1, max=MAX_POINTS, help="Points that the page gets of a cloud."
    ).tag(sync=True)
    view_range = traitlets.Float(
        None, allow_none=True, help="Metres to the edge of the picture, above 0; None: all. Python writes it."
    ).tag(sync=True)

    def update(self, message: Any) -> None:
        """Show a cloud in the next animation frame.

        It only stores, and may be called from any thread at any rate; the newest wins.

        Args:
            message: a sensor_msgs/PointCloud2 or PointCloud of rclpy, rospy or rosbags, a rosbridge dictionary, numbers
                of shape (N, 3), a structured array, or a `Cloud`.

        Raises:
            TypeError: no such message. ValueError: what it holds are no points. In a callback (another thread; a task,
                timer or button of a notebook) nothing is raised; widget and log say it.
        """
        try:
            cloud = to_cloud(message)
        except (TypeError, ValueError) as error:
            self._refuse(error)
        else:
            self._show(cloud)

    @property
    def cloud(self) -> Cloud | None:
        """The cloud on show, all of it: the frozen one while paused; None before the first.

        While paused it is also None where the page has stepped back to a cloud that is no longer kept here: about the
        last 64 MB are.
        """
        return self._sample_on_show()

    @property
    def frozen(self) -> Cloud | None:
        """The cloud on show while frozen, which may be stepped back to; None while live."""
        return self.cloud if self.paused else None

    @property
    def selected(self) -> NDArray[Any]:
        """The points of the cloud on show that are within the bounds of `selection`, a structured array; all without.

        Raises:
            ValueError: no cloud came, or it has no such field.
        """
        cloud = self.cloud
        if cloud is None:
            raise ValueError("selected: no cloud came yet")
        return cloud.points[cloud.inside(**self.selection)]

    def code(self, form: str = "points") -> str:
        """The code that selects the points of `selection`.

        Args:
            form: "points", with ``points``, and with each field by its name; "cloud", of a `Cloud`; "array", of numbers
                of shape (N, 3). Where the bounds leave out x, y or z, it needs NumPy as ``np`` to leave out points that
                were not measured, except of a `Cloud`.

        Raises:
            ValueError: nothing is selected, another form, or an array has no such field.
        """
        return selection_code(self.selection, form)

    def frame_of(self, sample: Any) -> tuple[dict[str, Any], bytes]:
        """See `RobotWidget`: of a message, or a cloud."""
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
        """Count the points anew: of the cloud on show, too, which may be the only one that comes."""
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
    # Bounds leave out what is NaN or infinite; a distance has none where x, y or z is.
    unbounded = [axis for axis in AXES if axis not in selection and DISTANCE not in selection]
    parts += [f"np.isfinite({_field_code(axis, form)})" for axis in unbounded]
    return f"points[{' & '.join(parts)}]"


def _field_code(field: str, form: str) -> str:
    if form == "array":
        return f"points[:, {AXES.index(field)}]"
    return field if _is_name(field) and field not in ("points", "np") else f"points[{_quoted(field)}]"


def _is_name(text: str) -> bool:
    """Whether code may have a text as a name, in plain letters, as `js/shared/python.ts` has it."""
    return re.fullmatch(r"[A-Za-z_]\w*", text, re.ASCII) is not None and not iskeyword(text)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _number_code(value: float) -> str:
    """All digits of a number, whole ones without a point."""
    return repr(value + 0.0).removesuffix(".0")


def _pack(cloud: Cloud, most: int) -> bytes:
    """The facts of a cloud as JSON, and a column for each field of the points that the page gets.

    Of a cloud in rows these are every n-th row and column, else every n-th point.
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
        # Typed arrays of the page lie at multiples of their size.
        gap = -size % _ALIGNED
        parts += [bytes(gap), raw]
        size += gap + len(raw)
    return b"".join(parts)
