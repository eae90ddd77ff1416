"""The offsets of fields in the bytes of messages, to read columns of any type without an object for each message.

A type has leaves: the fields with numbers, times or text, including the fields of inner messages. A layout has the
offsets of each leaf in messages of one size whose texts and arrays have the same lengths. It is computed once for all
such messages.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from rosbags.interfaces import Nodetype

from .channel import Channel
from .decoding import DecodeError, may_go_on, store_of

TIMES = ("time", "duration")
"""Types of leaves with two numbers per value, the seconds and the nanoseconds."""

_TIME = np.dtype([("sec", "<i4"), ("nanosec", "<u4")])
_DTYPES: dict[str, np.dtype[Any]] = {
    **{name: np.dtype(name) for name in ("float32", "float64", "int8", "int16", "int32", "int64")},
    **{name: np.dtype(name) for name in ("uint8", "uint16", "uint32", "uint64", "bool")},
    "byte": np.dtype("int8"),
    "char": np.dtype("uint8"),
    "time": _TIME,
    "duration": _TIME,
}
_NAMED_TIMES = {"builtin_interfaces/msg/Time": "time", "builtin_interfaces/msg/Duration": "duration"}
NO_FIELD = "structure_needs_at_least_one_member"
"""The field of an empty message: one byte in CDR, nothing in ROS 1."""
_MOST_LEAVES = 10_000
_MOST_KEPT = 64
"""The most layouts to cache, one for each size of messages."""
_LENGTH = 4

Rows = NDArray[np.uint8]
"""The bytes of messages of one layout as rows, shape (N, size)."""


class Leaf(NamedTuple):
    """A field with numbers, times or text.

    ``name`` is its path in the definition, with ``[]`` after an array of messages: ``transforms[].header.stamp``.
    ``type`` is a type of ROS, or ``time`` or ``duration``. ``count`` is the number of values: 1 for a single value and
    for text, None for an array of any length. ``is_array`` is True for an array, also of text. ``arrays`` are the
    numbers of the arrays of messages around it, outermost first; an array of text counts as one.
    """

    name: str
    type: str
    count: int | None  # type: ignore[assignment]  # hides tuple.count, which a leaf does not need
    is_array: bool
    arrays: tuple[int, ...]

    @property
    def dtype(self) -> np.dtype[Any] | None:
        """The NumPy type of its values in the bytes, or None for text."""
        return _DTYPES.get(self.type)

    @property
    def is_fixed(self) -> bool:
        """True if each message has the same number of values."""
        return self.count is not None and not self.arrays


class _Node(NamedTuple):
    """A step in the walk through the bytes: a leaf, or, with ``inner``, an array of messages.

    ``number`` is the number of the leaf or the array, or None for a byte that does not belong to a field.
    """

    number: int | None
    is_text: bool
    size: int
    align: int
    count: int | None  # type: ignore[assignment]
    inner: tuple[_Node, ...] | None = None

    @property
    def is_static(self) -> bool:
        """True if it takes the same number of bytes in every message, apart from the alignment."""
        within = self.inner is None or all(node.is_static for node in self.inner)
        return self.count is not None and not self.is_text and within

    @property
    def alignment(self) -> int:
        """The largest alignment in it."""
        return max([self.align, *(node.alignment for node in self.inner or ())])


class FieldPath(NamedTuple):
    """A selection of values of a leaf.

    ``which`` is the index in each array of messages around the leaf, ``value`` the index of the value, or None for all.
    ``part`` is a part of a time, ``"sec"`` or ``"nanosec"``.
    """

    leaf: int
    which: tuple[int | None, ...] = ()
    value: int | None = None
    part: str = ""


class Layout:
    """The offsets of all leaves in some messages.

    Args:
        raw: one of these messages.
        lengths: the offsets of the lengths of texts and arrays.
        texts: the start and the end offset of each text.
        starts: for each leaf, the offsets of its values, or of the first value of each array.
        sizes: for each leaf of any length, the numbers of values from each of these offsets on.
        counts: for each array of messages, its lengths, one for each occurrence.
        is_big_endian: True if the most significant byte of a number comes first.
        ends: True if a zero follows each text.
        fields: the number and the leaf of each name and type outside of arrays of messages.
        left: the number of bytes after the last field, without padding.
    """

    __slots__ = (
        "_ends",
        "_fixed",
        "_lengths",
        "_texts",
        "counts",
        "fields",
        "is_big_endian",
        "left",
        "sizes",
        "starts",
    )

    def __init__(
        self,
        raw: bytes,
        lengths: Sequence[int],
        texts: Sequence[tuple[int, int]],
        starts: Sequence[Sequence[int]],
        sizes: Sequence[Sequence[int]],
        counts: Sequence[Sequence[int]],
        is_big_endian: bool,
        ends: bool,
        fields: Mapping[tuple[str, str], tuple[int, Leaf]],
        left: int = 0,
    ) -> None:
        self.fields = fields
        self.is_big_endian, self._texts, self._ends = is_big_endian, tuple(texts), ends
        self.left = left
        self.starts, self.sizes, self.counts = (
            tuple(np.array(one, np.int64) for one in column) for column in (starts, sizes, counts)
        )
        self._lengths = tuple(lengths)
        self._fixed = tuple(raw[at : at + _LENGTH] for at in self._lengths)

    def fits(self, raw: bytes) -> bool:
        """Return True if a message of the same size has this layout; raise DecodeError if it has, with invalid text."""
        if any(raw[at : at + _LENGTH] != fixed for at, fixed in zip(self._lengths, self._fixed, strict=True)):
            return False
        for start, stop in self._texts:
            _check_text(raw[start:stop])
            if self._ends and raw[stop]:
                raise DecodeError(f"a text at byte {start} does not end with a zero")
        return True

    def span(self, type_name: str, *names: str) -> slice | None:
        """Return the offsets of fields of one type, or None if they do not follow one another or have no values."""
        start = stop = None
        for name in names:
            number, leaf = self.fields.get((name, type_name), (0, None))
            if leaf is None or leaf.dtype is None or stop not in (None, self.starts[number][0]):
                return None
            count = self.sizes[number][0] if leaf.count is None else leaf.count
            stop = int(self.starts[number][0] + leaf.dtype.itemsize * count)
            start = int(self.starts[number][0]) if start is None else start
        return None if start == stop else slice(start, stop)

    def offsets(self, leaf: Leaf, place: FieldPath) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the offsets of the selected values of a leaf, and the lengths of the selected texts or arrays."""
        starts, sizes = self.starts[place.leaf], self.sizes[place.leaf]
        if any(which is not None for which in place.which):
            within = self._within(leaf, place.which)
            starts, sizes = starts[within], sizes[within] if sizes.size else sizes
        dtype = leaf.dtype
        if dtype is None:
            return starts, sizes
        counts = sizes if leaf.count is None else np.full(len(starts), leaf.count, np.int64)
        if place.value is not None:
            starts = starts[counts > place.value] + place.value * dtype.itemsize
            counts = np.ones(len(starts), np.int64)
        if counts.size == 1:
            return starts[0] + dtype.itemsize * np.arange(counts[0]), counts
        firsts = np.cumsum(counts) - counts
        numbers = np.arange(counts.sum()) - np.repeat(firsts, counts)
        return np.repeat(starts, counts) + dtype.itemsize * numbers, counts

    def values(self, rows: Rows, leaf: Leaf, place: FieldPath) -> NDArray[Any]:
        """Return a copy of the selected numbers of a leaf in all rows, shape (N, T); whole times in nanoseconds."""
        dtype = leaf.dtype
        assert dtype is not None
        offsets, _ = self.offsets(leaf, place)
        ordered = dtype.newbyteorder(">" if self.is_big_endian else "<")
        if not offsets.size:
            found = np.empty((len(rows), 0), ordered)
        elif offsets[-1] - offsets[0] == dtype.itemsize * (len(offsets) - 1):
            found = rows[:, offsets[0] : offsets[-1] + dtype.itemsize].view(ordered)
        else:
            every = (offsets[:, None] + np.arange(dtype.itemsize)).ravel()
            found = rows.take(every, axis=1).view(ordered)
        if leaf.type == "bool":
            flags: NDArray[Any] = found.view(np.uint8) != 0
            return flags
        if leaf.type not in TIMES:
            return found.astype(dtype)
        if place.part:
            part: NDArray[Any] = found[place.part].astype(dtype[place.part].newbyteorder("="))
            return part
        nanoseconds: NDArray[Any] = found["sec"].astype(np.int64) * 1_000_000_000 + found["nanosec"]
        return nanoseconds

    def texts(self, raw: bytes, leaf: Leaf, place: FieldPath) -> list[str]:
        """Return the selected texts of a leaf in one message."""
        starts, sizes = self.offsets(leaf, place)
        return [raw[start : start + size].decode() for start, size in zip(starts.tolist(), sizes.tolist(), strict=True)]

    def _within(self, leaf: Leaf, wanted: Sequence[int | None]) -> NDArray[np.int64]:
        """Return the indices of the selected values among all values of a leaf, or among all its arrays of numbers."""
        numbers = np.zeros(1, np.int64)
        for array, which in zip(leaf.arrays, wanted, strict=True):
            counts = self.counts[array]
            firsts = np.cumsum(counts) - counts
            if which is not None:
                numbers = firsts[numbers][counts[numbers] > which] + which
            else:
                numbers = np.concatenate(
                    [np.empty(0, np.int64), *(firsts[i] + np.arange(counts[i]) for i in numbers.tolist())]
                )
        return numbers


class Layouts:
    """The leaves of the messages of a channel, and the layouts of its messages.

    Args:
        channel: the channel.

    Raises:
        DecodeError: its type is unknown, or has more than 10,000 fields.
    """

    def __init__(self, channel: Channel) -> None:
        self.type, self._is_cdr = channel.type, channel.encoding != "ros1"
        self.may_go_on = may_go_on(channel)
        self.leaves: list[Leaf] = []
        self._arrays = 0
        self._types: Mapping[str, Any] = store_of(channel).fielddefs
        self._nodes = tuple(self._compile(channel.type, "", ()))
        self.fields = {(leaf.name, leaf.type): (i, leaf) for i, leaf in enumerate(self.leaves) if not leaf.arrays}
        self._kept: OrderedDict[int, Layout] = OrderedDict()

    def of(self, raw: bytes) -> Layout:
        """Return the layout of a message; raise DecodeError if the bytes are not a valid message of the type."""
        size = len(raw)
        kept = self._kept.get(size)
        if kept is not None and kept.fits(raw):
            return kept
        layout = _Walk(raw, self).layout(self._nodes)
        self._kept[size] = layout
        self._kept.move_to_end(size)
        if len(self._kept) > _MOST_KEPT:
            self._kept.popitem(last=False)
        return layout

    @property
    def array_count(self) -> int:
        """The number of arrays of messages and arrays of texts."""
        return self._arrays

    @property
    def is_cdr(self) -> bool:
        """True if the messages are in CDR, which aligns numbers; else they are in the encoding of ROS 1."""
        return self._is_cdr

    def _compile(self, type_name: str, prefix: str, arrays: tuple[int, ...]) -> Iterator[_Node]:
        for name, (kind, what) in self._types[type_name][1]:
            if name == NO_FIELD:
                if self._is_cdr:
                    yield _Node(None, False, 1, 1, 1)
                continue
            count: int | None = 1
            is_array = kind not in (Nodetype.BASE, Nodetype.NAME)
            if is_array:
                (inner, what), limit = what
                count, kind = (limit if kind == Nodetype.ARRAY else None), inner
            yield from self._field(f"{prefix}{name}", kind, what, count, is_array, arrays)

    def _field(
        self, name: str, kind: int, what: Any, count: int | None, is_array: bool, arrays: tuple[int, ...]
    ) -> Iterator[_Node]:
        if kind == Nodetype.NAME and what not in _NAMED_TIMES:
            if not is_array:
                yield from self._compile(what, f"{name}.", arrays)
                return
            number = self._new_array()
            inner = tuple(self._compile(what, f"{name}[].", (*arrays, number)))
            yield _Node(number, False, 0, 1, count, inner)
            return
        type_name = _NAMED_TIMES[what] if kind == Nodetype.NAME else what[0]
        if len(self.leaves) >= _MOST_LEAVES:
            raise DecodeError(f"the definition of its messages has more than {_MOST_LEAVES:,} fields")
        leaf = len(self.leaves)
        if type_name == "string":
            number = self._new_array() if is_array else 0
            self.leaves.append(Leaf(name, type_name, 1, is_array, (*arrays, number) if is_array else arrays))
            text = _Node(leaf, True, 1, _LENGTH, 1)
            yield _Node(number, False, 0, 1, count, (text,)) if is_array else text
            return
        if type_name not in _DTYPES:
            raise DecodeError(f"its field {name} is of the type {type_name}, which cannot be read")
        self.leaves.append(Leaf(name, type_name, count, is_array, arrays))
        size = _DTYPES[type_name].itemsize
        yield _Node(leaf, False, size, _LENGTH if type_name in TIMES else size, count)

    def _new_array(self) -> int:
        self._arrays += 1
        return self._arrays - 1


class _Walk:
    """A walk through the bytes of one message, from its first field to its last."""

    def __init__(self, raw: bytes, layouts: Layouts) -> None:
        self._raw, self._type, self._is_cdr, self._fields = raw, layouts.type, layouts.is_cdr, layouts.fields
        self._may_go_on = layouts.may_go_on
        self._base = self._at = _LENGTH if layouts.is_cdr else 0
        if layouts.is_cdr and raw[:2] not in (b"\x00\x00", b"\x00\x01"):
            raise self._error("they do not begin with a header of CDR")
        self._is_big_endian = layouts.is_cdr and raw[1] == 0
        self._lengths = [0] if layouts.is_cdr else []
        self._texts: list[tuple[int, int]] = []
        self._starts: list[list[int]] = [[] for _ in layouts.leaves]
        self._sizes: list[list[int]] = [[] for _ in layouts.leaves]
        self._counts: list[list[int]] = [[] for _ in range(layouts.array_count)]

    def layout(self, nodes: Sequence[_Node]) -> Layout:
        """Return the layout of the message."""
        for node in nodes:
            self._pass(node)
        left = len(self._raw) - self._at
        if left <= (3 if self._is_cdr else 0):  # CDR pads messages to four bytes
            left = 0
        elif not self._may_go_on:
            raise self._error(f"{left} bytes are left over")
        columns = (self._starts, self._sizes, self._counts)
        is_big, ends = self._is_big_endian, self._is_cdr
        return Layout(self._raw, self._lengths, self._texts, *columns, is_big, ends, self._fields, left)

    def _pass(self, node: _Node) -> None:
        count = self._length() if node.count is None else node.count
        if node.number is None:
            self._skip(1)
        elif node.inner is not None:
            self._counts[node.number].append(count)
            self._pass_messages(node.inner, count)
        elif node.is_text:
            self._pass_text(node.number)
        else:
            if count:
                self._align(node.align)
            self._starts[node.number].append(self._at)
            if node.count is None:
                self._sizes[node.number].append(count)
            self._skip(node.size * count)

    def _pass_text(self, leaf: int) -> None:
        size = self._length()
        start = self._at
        self._skip(size)
        stop = self._at
        if self._is_cdr:
            if not size or self._raw[stop - 1]:
                raise self._error(f"a text at byte {start} does not end with a zero")
            stop -= 1
        _check_text(self._raw[start:stop])
        self._texts.append((start, stop))
        self._starts[leaf].append(start)
        self._sizes[leaf].append(stop - start)

    def _pass_messages(self, inner: Sequence[_Node], count: int) -> None:
        is_static = all(node.is_static for node in inner)
        align = max([1, *(node.alignment for node in inner)]) if self._is_cdr else 1
        marks: list[tuple[list[int], int, bool]] = []
        before, step = self._at, 1
        for done in range(count):
            if is_static and done == 2 and step % align == 0:  # so all others have the layout of the second
                self._repeat(marks, step, count - done)
                return
            marks = self._marks(inner) if is_static and done == 1 else marks
            for node in inner:
                self._pass(node)
            before, step = self._at, self._at - before

    def _marks(self, inner: Sequence[_Node]) -> list[tuple[list[int], int, bool]]:
        """Return the columns of the leaves and arrays of a message, with their lengths before the message."""
        marks: list[tuple[list[int], int, bool]] = []
        for node in inner:
            if node.number is None:
                continue
            column = self._starts[node.number] if node.inner is None else self._counts[node.number]
            marks.append((column, len(column), node.inner is None))
            if node.inner is not None:
                marks += self._marks(node.inner)
        return marks

    def _repeat(self, marks: Sequence[tuple[list[int], int, bool]], step: int, times: int) -> None:
        """Pass messages with the layout of the last message, which took ``step`` bytes."""
        self._skip(step * times)
        for column, before, moves in marks:
            last = np.array(column[before:], np.int64)
            steps = step * np.arange(1, times + 1) if moves else np.zeros(times, np.int64)
            column += (last + steps[:, None]).ravel().tolist()

    def _length(self) -> int:
        self._align(_LENGTH)
        at = self._at
        self._skip(_LENGTH)
        self._lengths.append(at)
        length = int.from_bytes(self._raw[at : at + _LENGTH], "big" if self._is_big_endian else "little")
        if length > len(self._raw) - self._at:
            raise self._error(f"the length at byte {at} is {length:,}")
        return length

    def _align(self, to: int) -> None:
        if self._is_cdr:
            self._at = self._base + (self._at - self._base + to - 1) // to * to

    def _skip(self, size: int) -> None:
        self._at += size
        if self._at > len(self._raw):
            raise self._error("they end too early")

    def _error(self, why: str) -> DecodeError:
        return DecodeError(f"{len(self._raw)} bytes are not a valid {self._type}: {why}")


def _check_text(text: bytes) -> None:
    if not text.isascii():
        try:
            text.decode()
        except UnicodeDecodeError as error:
            raise DecodeError(f"a text is not UTF-8: {error}") from None


def as_rows(raws: Sequence[bytes]) -> Rows:
    """Return messages of one size as rows."""
    return np.frombuffer(b"".join(raws), np.uint8).reshape(len(raws), len(raws[0]))
