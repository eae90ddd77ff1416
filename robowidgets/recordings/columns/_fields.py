"""The fields of the messages of a topic as columns, whatever their type."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from ...messages.field_names import find, no_such_field, type_of, within
from ...messages.layout import FieldPath, Leaf, as_rows
from ...repair import RecordingError
from ..topics import Moment, TimedMessage
from . import tables
from ._messages import MessageChunk
from ._store import Store
from .series import Series

if TYPE_CHECKING:
    from typing_extensions import Self

_TEXT_BYTES = 60
"""Approximate bytes of a text in addition to its characters."""

FieldRows = tuple[NDArray[np.int64], Any]
"""Rows of a series, and the values of a field in them: shape (N, T), or a list of texts for each row."""


class UnknownFieldError(RecordingError, KeyError):
    """The messages of a topic have no such field."""

    __str__ = Exception.__str__


class Fields(Series[Any]):
    """The messages of a topic, with every field as a column; see `Series` for the ways to select from them.

    By name: ``fields["linear_acceleration.x"]`` is the column of a field, named as in the definition;
    ``fields[["orientation", "header.stamp"]]`` has fewer columns. ``fields[3].message`` is a message.

    ==========================  =====================================================================================
    field                       column
    ==========================  =====================================================================================
    number, flag                shape (N,), in its own type
    time, duration              shape (N,), int64, nanoseconds; ``"header.stamp.sec"`` is a part of it
    text                        shape (N,), of ``str``
    array of N numbers          shape (N, T); ``"covariance[7]"`` is one of them, shape (N,)
    array of any length         shape (N, T) if all messages have the same length, else (N,) with an array for each
    field of messages in one    ``"transforms[].header.frame_id"`` is the field of all, and
                                ``"transforms[0].header.frame_id"`` of one; shapes as for arrays
    ==========================  =====================================================================================

    If a message has no such value, a float is NaN, a text None, and an integer or a flag masked.

    Examples:
        >>> fields = recording.fields("/imu")  # doctest: +SKIP
        >>> fields["linear_acceleration.x"].max()  # doctest: +SKIP
    """

    def __init__(
        self,
        store: Store,
        start_ns: int,
        rows: NDArray[np.int64] | None = None,
        names: Sequence[str] | None = None,
    ) -> None:
        super().__init__(store, start_ns, rows)
        self._names = tuple(leaf.name for leaf in self._leaves) if names is None else tuple(names)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the fields, in the order of the definition."""
        return self._names

    @property
    def types(self) -> dict[str, str]:
        """The type of each field: ``float64``, ``float64[36]``, ``time``, ``string[]``."""
        leaves = self._leaves
        return {name: type_of(leaves[self._place(name).leaf]) for name in self._names}

    @overload
    def __getitem__(self, which: slice | NDArray[np.bool_] | list[str]) -> Self: ...
    @overload
    def __getitem__(self, which: str) -> NDArray[Any]: ...
    @overload
    def __getitem__(self, which: int) -> TimedMessage: ...
    def __getitem__(self, which: Any) -> Any:
        if isinstance(which, str):
            return self._columns([which])[which]
        if isinstance(which, (list, tuple)) and which and all(isinstance(name, str) for name in which):
            return self._with_names(which)
        return super().__getitem__(which)

    def numbers(self, name: str) -> Iterator[NDArray[np.float64]]:
        """Yield a field chunk by chunk as numbers, NaN for missing ones, so that a recording of any size fits.

        The order within a chunk is any.

        Raises:
            TypeError: the field is a text or a time, or has several values in a message.
        """
        place = self._place(name)
        leaf = self._leaves[place.leaf]
        if leaf.dtype is None or (leaf.dtype.names is not None and not place.part):
            raise TypeError(f"{self.topic}.{name} is a {leaf.type}, not a number")
        if _has_lists(leaf, place):
            raise TypeError(f"{self.topic}.{name} has several values in a message: name one, such as '{name}[0]'")
        for chunk in self.chunks():
            for _, (rows, values) in self._parts(chunk, {name: place}):
                has_one = values.shape[1] > 0
                yield values[:, 0].astype(np.float64) if has_one else np.full(len(rows), np.nan)

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """Return the columns by name; times as ``times_ns``, ``seconds`` and ``stamps_ns``.

        A field with one of these three names gets an underscore after it.

        Raises:
            RecordingError: the columns would be larger than `Recording.memory`.
        """
        columns = self._columns(self._names)
        return {**super().to_numpy(), **{_as_column(name): column for name, column in columns.items()}}

    def _columns_of_table(self) -> Mapping[str, tables.Column]:
        """Return the columns. An array of variable length is a column of lists even if all lengths are equal."""
        columns = self.to_numpy()
        lists = {}
        for name in self._names:
            place = self._place(name)
            leaf = self._leaves[place.leaf]
            if _has_lists(leaf, place) and not leaf.is_fixed:
                dtype = np.dtype(object) if leaf.dtype is None else _dtype(leaf, place)
                lists[_as_column(name)] = tables.Lists(columns[_as_column(name)], dtype)
        return {**columns, **lists}

    @property
    def _leaves(self) -> Sequence[Leaf]:
        leaves: Sequence[Leaf] = next(iter(self._store.decoders.values())).leaves  # type: ignore[attr-defined]
        return leaves

    def _with(self, rows: NDArray[np.int64]) -> Self:
        return type(self)(self._store, self._start_ns, rows, self._names)

    def _with_names(self, names: Iterable[str]) -> Self:
        found: list[str] = []
        for name in names:
            inner = within(self._leaves, name)
            if not inner:
                self._place(name)  # raises if the name is not part of a field either
            found += [leaf.name for leaf in inner] or [name]
        return type(self)(self._store, self._start_ns, self._rows, list(dict.fromkeys(found)))

    def _place(self, name: str) -> FieldPath:
        place = find(self._leaves, name)
        if place is None:
            raise UnknownFieldError(f"{self.topic}: {no_such_field(self._leaves, name)}")
        return place

    def _moment(self, time_ns: int, sample: Any) -> Moment:
        return TimedMessage(self.topic, time_ns, sample, (time_ns - self._start_ns) / 1e9)

    def _columns(self, names: Iterable[str]) -> dict[str, NDArray[Any]]:
        """Return the columns of some fields, read in one pass through the messages."""
        places = {name: self._place(name) for name in names}
        parts: dict[str, list[FieldRows]] = {name: [] for name in places}
        leaves, size = self._leaves, 0
        for chunk in self.chunks():
            for name, part in self._parts(chunk, places):
                size += _size(part[1])
                self._store.memory.check(size, f"{self.topic}: the columns of {len(places):,} fields")
                parts[name].append(part)
        return {name: self._joined(name, leaves[place.leaf], place, parts[name]) for name, place in places.items()}

    def _parts(self, chunk: MessageChunk, places: Mapping[str, FieldPath]) -> Iterable[tuple[str, FieldRows]]:
        for layout, rows, raws in chunk.groups():
            matrix = as_rows(raws)
            for name, place in places.items():
                leaf = self._leaves[place.leaf]
                if leaf.dtype is None:
                    yield name, (chunk.start + rows, [layout.texts(raw, leaf, place) for raw in raws])
                else:
                    yield name, (chunk.start + rows, layout.values(matrix, leaf, place))

    def _joined(self, name: str, leaf: Leaf, place: FieldPath, parts: Sequence[FieldRows]) -> NDArray[Any]:
        """Join the parts of one column."""
        is_text = leaf.dtype is None
        dtype = np.dtype(object) if is_text else parts[0][1].dtype if parts else _dtype(leaf, place)
        widths = {len(values[0]) for _, values in parts}
        if _has_lists(leaf, place):
            width = next(iter(widths)) if len(widths) == 1 else 0 if widths or leaf.count is None else leaf.count
            if len(widths) < 2:
                table = np.empty((len(self), width), dtype)
                for rows, values in parts:
                    table[rows] = values
                return table
            ragged = np.empty(len(self), object)
            for rows, values in parts:
                for row, own in zip(rows.tolist(), values, strict=True):
                    ragged[row] = own
            return ragged
        if widths == {0}:
            raise UnknownFieldError(f"{self.topic}: no message has {name!r}: its arrays are shorter")
        is_missing = np.zeros(len(self), bool)
        column = np.zeros(len(self), dtype)
        for rows, values in parts:
            if len(values[0]):
                column[rows] = [own[0] for own in values] if is_text else values[:, 0]
            else:
                is_missing[rows] = True
        if not is_missing.any():
            return column
        if is_text or dtype.kind == "f":
            column[is_missing] = None if is_text else np.nan
            return column
        return np.ma.masked_array(column, is_missing)


def _as_column(name: str) -> str:
    """Return the name of a field's column in a table, which has time columns too."""
    return f"{name}_" if name in tables.TIMES else name


def _has_lists(leaf: Leaf, place: FieldPath) -> bool:
    """Return True if a field has several values in each message."""
    is_array = leaf.is_array and leaf.dtype is not None and place.value is None
    return is_array or None in (place.which or (None,) * len(leaf.arrays))


def _dtype(leaf: Leaf, place: FieldPath) -> np.dtype[Any]:
    """Return the type of a field's column of numbers."""
    assert leaf.dtype is not None
    if leaf.dtype.names is None:
        return leaf.dtype
    return np.dtype(leaf.dtype[place.part].newbyteorder("=") if place.part else np.int64)


def _size(values: Any) -> int:
    if isinstance(values, np.ndarray):
        return values.nbytes
    return sum(_TEXT_BYTES + len(text) for texts in values for text in texts)
