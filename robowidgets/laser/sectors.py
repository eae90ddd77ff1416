"""Marks of the user or of a program in a laser's picture: sectors, the selection, pins, highlighted rays."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, MutableMapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import traitlets
from numpy.typing import NDArray

from ..samples import Ray, Scan
from ..samples.scan import MAX_RAYS
from ..samples.sector import ALL_ROUND, SECTORS, Sector, SectorLike, to_sector
from ..samples.sector_code import for_array, for_message, for_scan
from ..samples.stretches import expression, parse, sector_of, stretches, to_stretches

LONGEST_NAME = 40
FORMS = ("scan", "message", "slice")


@dataclass(frozen=True)
class Selection:
    """A sector that the user or a program has picked, with the scan on show.

    It is accepted as a sector everywhere: ``scan.distance(laser.selection)``.

    Attributes:
        name: the name of a kept sector, or "" for another sector.
        sector: its angles and limits.
        scan: the scan on show.

    Examples:
        >>> laser.selection.indices, laser.selection.values  # doctest: +SKIP
    """

    name: str
    sector: Sector
    scan: Scan

    @property
    def indices(self) -> NDArray[np.intp]:
        """Indices of its rays, as `Scan.indices` returns them."""
        return self.scan.indices(self.sector)

    @property
    def mask(self) -> NDArray[np.bool_]:
        """True for its rays, shape (R,)."""
        mask = np.zeros(len(self.scan), bool)
        mask[self.indices] = True
        return mask

    @property
    def slice(self) -> slice | None:
        """The slice of ``ranges``, or None if the sector is in two parts of the array, such as across the seam."""
        found = stretches(self.scan, self.sector)
        return slice(*found[0]) if len(found) == 1 else None

    @property
    def expression(self) -> str:
        """The slice of ``ranges`` as code: ``ranges[540:610]``, ``ranges[350:] + ranges[:10]``."""
        return expression(stretches(self.scan, self.sector), len(self.scan))

    @property
    def values(self) -> NDArray[np.float32]:
        """The ranges of its rays in metres, unchanged, in the order of `indices`."""
        return self.scan.ranges[self.indices]

    @property
    def distance(self) -> float:
        """Metres to the nearest thing, as `Scan.distance` returns them."""
        return self.scan.distance(self.sector)

    @property
    def nearest(self) -> Ray | None:
        """The ray to the nearest thing, as `Scan.nearest` returns it."""
        return self.scan.nearest(self.sector)


class HasSectors(traitlets.HasTraits):
    """Part of the laser widget: sectors, selection, pins and highlighted rays."""

    _sectors = traitlets.Dict(help="The fields of each kept sector, by name. Python and the view write it.").tag(
        sync=True, echo_update=False
    )
    _selection = traitlets.Dict(
        help="{name} of a selected sector that is kept, {start, end} of another one, or empty. Python and the view "
        "write it."
    ).tag(sync=True, echo_update=False)
    _pins = traitlets.Dict(help="Index of a ray by name.").tag(sync=True)
    _highlight = traitlets.Dict(help="{text, stretches} or {text, sector} of the highlighted rays.").tag(sync=True)

    scan: Any
    pinned: Any
    angle_offset: Any

    @property
    def sectors(self) -> Sectors:
        """The kept sectors by name, each drawn with its name. A dictionary of sectors may be assigned.

        "front", "left", "back" and "right" can be read even if they are not kept.

        Examples:
            >>> laser.sectors["ahead"] = Sector("-15deg", "15deg", near=0.5)  # doctest: +SKIP
        """
        return Sectors(lambda: self._sectors, self._keep_sectors)

    @sectors.setter
    def sectors(self, sectors: Mapping[str, SectorLike]) -> None:
        self._keep_sectors(
            {_name("sectors", name): _plain(to_sector(value)) for name, value in _by_name("sectors", sectors).items()}
        )

    @property
    def pins(self) -> dict[str, int]:
        """Indices of rays by name, each drawn with a ring and its name. Assign a dictionary to change them."""
        return dict(self._pins)

    @pins.setter
    def pins(self, pins: Mapping[str, int]) -> None:
        self._pins = {_name("pins", name): _index("pins", index) for name, index in _by_name("pins", pins).items()}

    @property
    def selection(self) -> Selection | None:
        """The selected sector, with the scan on show; None without one, or before the first scan.

        The name of a kept sector, a sector, or two angles may be assigned; None clears the selection.
        """
        picked = self._picked()
        return Selection(*picked, self.scan) if picked and self.scan is not None else None

    @selection.setter
    def selection(self, sector: SectorLike | None) -> None:
        if sector is None:
            self._selection = {}
        elif isinstance(sector, str) and sector in self._sectors:
            self._selection = {"name": sector}
        else:
            self._selection = _plain(to_sector(sector))

    def distance(self, sector: SectorLike = ALL_ROUND, *, percentile: float | None = None) -> float:
        """Return the metres to the nearest thing in the scan on show, as `Scan.distance` does; NaN without a scan.

        Args:
            sector: the name of a kept sector, or anything that `Scan.distance` takes; by default all rays.
            percentile: as in `Scan.distance`.

        Raises:
            TypeError: the sector is not a pair of numbers. ValueError: no such sector, or an angle beyond a full turn.
        """
        asked = sector if sector is ALL_ROUND else self._known(sector)
        scan: Scan | None = self.scan
        return float("nan") if scan is None else scan.distance(asked, percentile=percentile)

    def code(self, sector: SectorLike | int | None = None, form: str = "scan") -> str:
        """Return Python code that computes the distance in a sector, which is the number in the picture.

        Args:
            sector: the name of a kept sector, anything that `Scan.distance` takes, or the index of a ray; by default
                the selection, else the pinned ray.
            form: "scan" for a `Scan` named ``scan``; "message" for a sensor_msgs/LaserScan named ``msg``, which needs
                only NumPy and not robowidgets; "slice" for the slice of ``ranges``, without any check for invalid
                ranges.

        Raises:
            TypeError: the sector is not a pair of numbers. ValueError: no such sector or form, nothing is selected, or
                a scan is needed but has not come.
        """
        if form not in FORMS:
            raise ValueError(f"form: expected {', '.join(map(repr, FORMS))}, got {form!r}")
        if sector is None:
            picked = self._picked()
            if picked is None and self.pinned is None:
                raise ValueError("code() needs a sector: nothing is selected and no ray is pinned")
            sector = picked[1] if picked else self.pinned
        if isinstance(sector, (int, np.integer)):
            index = _index("sector", sector)
            if self.scan is None or index >= len(self.scan):
                raise ValueError(f"sector: expected a ray of the scan on show, got {index}: {_about_scan(self.scan)}")
            if form == "slice":
                return f"ranges[{index}]"
            asked = sector_of(self.scan, index, index)
        else:
            asked = self._known(sector)
        if form == "slice" and self.scan is None:
            raise ValueError(f"code() of a slice needs a scan: {_about_scan(None)}")
        if form == "slice":
            return for_array(asked, self.scan)
        mount = None if self.scan is None else self.scan.mount
        return for_scan(asked) if form == "scan" else for_message(asked, self.angle_offset, mount)

    def highlight(self, rays: Any) -> None:
        """Highlight rays in the picture, until the next call. None removes the highlight.

        Args:
            rays: text such as ``ranges[240:300]`` or ``ranges[350:] + ranges[:10]``; a slice; an index or indices; a
                mask with a value for each ray; a sector, a selection or the name of a kept sector. In later scans, rays
                are highlighted by index, and sectors by their angles.

        Raises:
            TypeError: another type. ValueError: it contains no ray, or the number of rays is unknown before the first
                scan.

        Examples:
            >>> laser.highlight(slice(240, 300))  # doctest: +SKIP
        """
        if rays is None:
            self._highlight = {}
            return
        is_name = isinstance(rays, str) and "[" not in rays
        if is_name or isinstance(rays, (Sector, Selection)) or (isinstance(rays, tuple) and len(rays) == 2):
            self._highlight = {"text": rays if is_name else "", "sector": _plain(self._known(rays))}
            return
        if self.scan is None:
            raise ValueError(f"highlight() of rays needs a scan, which has their number: {_about_scan(None)}")
        found = to_stretches(_to_indices(rays, len(self.scan)))
        text = rays.strip() if isinstance(rays, str) else expression(found, len(self.scan))
        self._highlight = {"text": text if len(text) <= LONGEST_NAME else "", "stretches": [[*one] for one in found]}

    def _picked(self) -> tuple[str, Sector] | None:
        """Return the name and the sector of the selection, or None without one."""
        name = self._selection.get("name", "")
        if name:
            return (name, Sector(**self._sectors[name])) if name in self._sectors else None
        return ("", Sector(**self._selection)) if self._selection else None

    def _known(self, sector: SectorLike) -> Sector:
        if isinstance(sector, str) and sector in self._sectors:
            return Sector(**self._sectors[sector])
        if isinstance(sector, str) and sector not in SECTORS:
            known = ", ".join({**self._sectors, **SECTORS})
            raise ValueError(f"sector: expected {known} or two angles, got {sector!r}")
        return to_sector(sector)

    def _keep_sectors(self, sectors: dict[str, Any]) -> None:
        """Keep these sectors, and clear the selection if its sector is gone."""
        self._sectors = sectors
        if "name" in self._selection and self._selection["name"] not in self._sectors:
            self._selection = {}


class Sectors(MutableMapping[str, Sector]):
    """The kept sectors of a widget by name. Changes here appear in the page, and changes in the page here."""

    def __init__(self, kept: Callable[[], dict[str, Any]], keep: Callable[[dict[str, Any]], None]) -> None:
        self._kept, self._keep = kept, keep

    def __getitem__(self, name: str) -> Sector:
        kept = self._kept()
        if name in kept:
            return Sector(**kept[name])
        if name in SECTORS:
            return SECTORS[name]
        raise KeyError(f"no sector {name!r}; there are: {', '.join([*kept, *SECTORS])}")

    def __setitem__(self, name: str, sector: SectorLike) -> None:
        self._keep(self._kept() | {_name("sectors", name): _plain(to_sector(sector))})

    def __delitem__(self, name: str) -> None:
        kept = self._kept()
        if name not in kept:
            raise KeyError(f"no sector {name!r} is kept; there are: {', '.join(kept) or 'none'}")
        self._keep({other: value for other, value in kept.items() if other != name})

    def __contains__(self, name: object) -> bool:
        return name in self._kept()

    def __iter__(self) -> Iterator[str]:
        return iter(list(self._kept()))

    def __len__(self) -> int:
        return len(self._kept())

    def __repr__(self) -> str:
        return repr(dict(self))

    def save(self, file: str | Path) -> None:
        """Write the kept sectors to a JSON file."""
        text = json.dumps({name: sector.to_json() for name, sector in self.items()}, indent=2, ensure_ascii=False)
        Path(file).write_text(f"{text}\n", encoding="utf-8")

    def load(self, file: str | Path) -> None:
        """Add the sectors of a JSON file to the kept ones.

        Raises:
            OSError: the file cannot be read. ValueError: it does not contain sectors.
        """
        try:
            read = json.loads(Path(file).read_text(encoding="utf-8"))
            found = {name: Sector(**values) for name, values in read.items()}
        except (AttributeError, TypeError, ValueError) as error:
            raise ValueError(f"{file}: expected sectors as save() writes them: {error}") from None
        self.update(found)


def _by_name(what: str, given: Any) -> Mapping[str, Any]:
    if not isinstance(given, Mapping):
        raise TypeError(f"{what}: expected a dictionary by name, got {given!r}")
    return given


def _about_scan(scan: Scan | None) -> str:
    return "no scan has come" if scan is None else f"it has {len(scan):,} rays"


def _name(what: str, name: Any) -> str:
    if not isinstance(name, str) or not name.strip() or len(name) > LONGEST_NAME or not name.isprintable():
        raise ValueError(f"{what}: expected a name of 1 to {LONGEST_NAME} characters, got {name!r}")
    return name


def _index(name: str, index: Any) -> int:
    is_index = isinstance(index, (int, np.integer)) and not isinstance(index, bool)
    if not is_index or not 0 <= index < MAX_RAYS:
        raise ValueError(f"{name}: expected the index of a ray, 0 or more, got {index!r}")
    return int(index)


def _plain(sector: Sector) -> dict[str, float]:
    """Return the fields of a sector that are set."""
    return {name: value for name, value in asdict(sector).items() if value is not None}


def _to_indices(rays: Any, count: int) -> NDArray[np.intp]:
    if isinstance(rays, str):
        return parse(rays, count)
    listed = rays
    if isinstance(rays, slice):
        listed = range(count)[rays]
    elif isinstance(rays, (int, np.integer)) and not isinstance(rays, bool):
        listed = [rays]
    array = np.asarray(list(listed) if isinstance(listed, Iterable) else listed)
    if array.dtype == bool and array.shape == (count,):
        array = np.flatnonzero(array)
    if array.ndim != 1 or (array.size and array.dtype.kind not in "iu"):
        raise TypeError(
            f"rays: expected a slice, indices, a mask of {count:,} values, a sector or text like "
            f'"ranges[240:300]", got {rays!r}'
        )
    if not array.size or array.min() < -count or array.max() >= count:
        raise ValueError(f"rays: expected indices of the {count:,} rays of this scan, got {rays!r}")
    return array.astype(np.intp) % count
