"""The mount of a scanner from odometry: while the robot drives and turns, walls move the opposite way."""

from __future__ import annotations

from math import cos, degrees, hypot, pi, radians, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...poses.recent import poses_at
from ...samples import Problem, Scan
from ...samples.distances import indices_at
from ..columns.scans import Scans
from ..columns.speeds import Speeds

Floats = NDArray[np.float64]

DRIVEN, STRAIGHT = 0.25, radians(3)
"""Metres between two scans that are compared, and the maximum turn between them."""

TURNED, ON_THE_SPOT = radians(20), 0.05
"""Radians between two scans that are compared, and the maximum distance in metres that the robot drives between them.
"""

LONGEST = 5.0
"""The maximum number of seconds between two such scans: people walk through rooms, and odometry drifts."""

MOST_PAIRS, FEWEST_PAIRS = 40, 5
MOST_RAYS = 400
STEP = radians(3)

OFF, OFF_SHARE = 0.05, 0.01
"""The tolerance for a wall in metres, and as a share of its distance."""

GOOD, BETTER = 0.6, 0.15
"""The share of the readings that must fit another mount, and its minimum lead over the assumed mount."""

ROUNDED = radians(5)

ALIKE = 0.03
"""The share of the readings by which two mounts count as equally good."""

LEAST = radians(20)


class Fit(NamedTuple):
    """The mount for which walls stand still, in the angles of the scans.

    ``yaw``: radians by which the scans must be turned, or 0 if they fit or the angle is unknown. ``upside_down``: True
    if the scanner seems to be mounted upside down.
    """

    yaw: float = 0.0
    upside_down: bool = False


def problem_of(scans: Scans, odometry: Speeds) -> Problem | None:
    """Return the problem if walls in the scans contradict the odometry, or None if they agree or are not seen."""
    fit = fit_of(scans, odometry)
    if fit == Fit():
        return None
    mount = scans[0].sample.mount
    parts = ["upside down" * fit.upside_down, f"turned by about {degrees(fit.yaw):.0f}°" if fit.yaw else ""]
    seems = " and ".join(filter(None, parts))
    if mount is not None and mount.words:
        what = f"the scanner is {mount.words}, but walls move as if it were also {seems}"
        return Problem(what, f"does the transform of {_frame(scans)} match how the scanner is really mounted?")
    by_hand = f'recording.mount("{scans[0].sample.frame_id}", "{degrees(fit.yaw):.0f}deg"'
    by_hand += ", upside_down=True)" if fit.upside_down else ")"
    return Problem(
        f"walls move as if the scanner were {seems}, which tf does not contain",
        f"publish the transform from base_link to {_frame(scans)}; meanwhile {by_hand}",
    )


def fit_of(scans: Scans, odometry: Speeds) -> Fit:
    """Return the mount of a scanner from scans of a robot that drives straight, and that turns on the spot."""
    poses = _poses(scans, odometry)
    turned = _pairs(poses, scans.seconds, turns=True)
    straight = _pairs(poses, scans.seconds, turns=False)
    is_hanging = False
    if len(turned) >= FEWEST_PAIRS:
        upright, hanging = np.mean([_turn_shares(*_both(scans, pair), poses, pair) for pair in turned], axis=0)
        is_hanging = hanging >= GOOD and hanging - upright >= BETTER
    yaw = 0.0
    if len(straight) >= FEWEST_PAIRS:
        shares = np.mean([_drive_shares(*_both(scans, pair), poses, pair) for pair in straight], axis=0)
        best = int(shares.argmax())
        found = _middle(shares, best)
        if shares[best] >= GOOD and shares[best] - shares[0] >= BETTER and abs(found) >= LEAST:
            # If upside down, an angle of the robot is the yaw minus the angle of the scanner.
            yaw = pi - (pi + found) % (2 * pi) if is_hanging else found
    return Fit(yaw, bool(is_hanging))


def _middle(shares: Floats, best: int) -> float:
    """Return the middle in radians of the turns around the best one that are about as good: one wall has many."""
    is_good = shares >= shares[best] - ALIKE
    ends = []
    for way in (-1, 1):
        run = is_good[(best + way * np.arange(1, len(shares))) % len(shares)]
        ends.append(way * (len(run) if run.all() else int(run.argmin())))
    # In steps of 5 degrees, above -180.
    rounded = ROUNDED * round((best + sum(ends) / 2) * STEP / ROUNDED)
    return pi - (pi - rounded) % (2 * pi)


def _poses(scans: Scans, odometry: Speeds) -> Floats:
    """Return x, y and yaw of the robot at each scan, shape (3, N), NaN if unknown."""
    poses = odometry.poses
    known = np.isfinite(poses).all(axis=1)
    if not known.any():
        return np.full((3, len(scans)), np.nan)
    x, y, yaw = poses[known].T
    columns = x, y, np.unwrap(yaw)
    both = scans.stamps_ns, odometry.stamps_ns[known]
    if all((stamps > 0).all() for stamps in both) and (np.diff(both[1]) > 0).all():
        first = both[1][0]
        found = poses_at((both[0] - first) / 1e9, (both[1] - first) / 1e9, columns)
        if np.isfinite(found).any():
            return found
    return poses_at(scans.seconds, odometry.seconds[known], columns)


def _pairs(poses: Floats, seconds: Floats, *, turns: bool) -> list[tuple[int, int]]:
    """Return pairs of scans between which the robot drove straight, or turned on the spot; evenly chosen."""
    steps = np.abs(np.diff(poses[2])) if turns else np.hypot(*np.diff(poses[:2], axis=1))
    gone = np.concatenate(([0.0], np.cumsum(np.nan_to_num(steps))))
    later = np.searchsorted(gone, gone + (TURNED if turns else DRIVEN))
    found = []
    for i, j in enumerate(later.tolist()):
        if j >= len(seconds) or seconds[j] - seconds[i] > LONGEST:
            continue
        dx, dy, turn = poses[:, j] - poses[:, i]
        driven, turn = hypot(dx, dy), abs(turn)
        is_wanted = (
            (driven <= ON_THE_SPOT and 0.8 * TURNED <= turn <= 3 * TURNED)
            if turns
            else (0.8 * DRIVEN <= driven <= 3 * DRIVEN and turn <= STRAIGHT)
        )
        if is_wanted:  # False for NaN
            found.append((i, j))
    chosen = np.unique(np.linspace(0, len(found) - 1, MOST_PAIRS).astype(int)) if found else ()
    return [found[k] for k in chosen]


def _both(scans: Scans, pair: tuple[int, int]) -> tuple[Scan, Scan]:
    first, second = (scans[i].sample for i in pair)
    return first, second


def _drive_shares(first: Scan, second: Scan, poses: Floats, pair: tuple[int, int]) -> Floats:
    """Return the share of readings that stand still, for each turn of the scans by a multiple of `STEP`."""
    (x, y, yaw), to = poses[:, pair[0]], poses[:, pair[1]]
    dx, dy = to[0] - x, to[1] - y
    ahead, left = cos(yaw) * dx + sin(yaw) * dy, cos(yaw) * dy - sin(yaw) * dx
    turns = np.arange(round(2 * pi / STEP)) * STEP
    away = np.stack([np.cos(turns) * ahead + np.sin(turns) * left, np.cos(turns) * left - np.sin(turns) * ahead])
    points = _points(first)
    return _shares(points[None] - away.T[:, None], second)


def _turn_shares(first: Scan, second: Scan, poses: Floats, pair: tuple[int, int]) -> Floats:
    """Return the share of the readings that stand still if the scanner is upright, and if it is upside down."""
    turn = poses[2, pair[1]] - poses[2, pair[0]]
    points = _points(first)
    x, y = points.T
    moved = [np.stack([cos(by) * x - sin(by) * y, sin(by) * x + cos(by) * y], axis=1) for by in (-turn, turn)]
    return _shares(np.stack(moved), second)


def _points(scan: Scan) -> Floats:
    points = scan.xy
    return points[:: max(1, len(points) // MOST_RAYS)]


def _shares(points: Floats, scan: Scan) -> Floats:
    """Return the share of each set of points, shape (K, N, 2), that a scan confirms, or 0 if it sees none of them."""
    away = np.hypot(points[..., 0], points[..., 1])
    rays = indices_at(scan, np.arctan2(points[..., 1], points[..., 0]))
    seen = (rays >= 0) & scan.valid[rays]
    fits = seen & (np.abs(scan.ranges[rays] - away) <= OFF + OFF_SHARE * away)
    counts = seen.sum(axis=1)
    return np.asarray(fits.sum(axis=1) / np.maximum(counts, 1))


def _frame(scans: Scans) -> str:
    return scans[0].sample.frame_id or "the scanner, whose frame_id is empty"
