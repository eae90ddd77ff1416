"""Scanners that behave like real ones, by name. `docs/simulator.md` lists the sources."""

from __future__ import annotations

from math import inf, pi, radians

from .scanner import Scanner

SCANNERS: dict[str, Scanner] = {
    # Hokuyo UTM-30LX, with the rays and angles of the PR2's base laser.
    "utm30lx": Scanner(
        1040, radians(259.75), 0.023, 60.0, first_angle=radians(-130), rate=40.0, nothing=0.001, failed=(0.001,)
    ),
    # LDS-01 of the TurtleBot3, which starts forward and sends 0 if nothing is in range.
    "lds01": Scanner(
        360, 2 * pi, 0.12, 3.5, 0.005, 0.001, 0.01, 5.0, True, "base_scan",
        first_angle=0.0, noise_share=0.01, nothing=0.0, too_close=0.0, failed=(0.0,),
    ),
    # RPLIDAR A1, with a motor of varying speed.
    "rplidar_a1": Scanner(
        720, 2 * pi, 0.15, 12.0, 0.002, 0.00025, 0.02, 5.5, True,
        noise_share=0.005, failed=(inf,), count_spread=15, period_spread=0.05,
    ),
    # Hokuyo URG-04LX, which sends codes of a few millimetres for failures.
    "urg04lx": Scanner(
        681, 2 * radians(119.53), 0.02, 5.6, 0.005, 0.001, 0.01,
        noise_share=0.005, nothing=0.0, too_close=0.0, failed=(0.0, 0.006, 0.007),
    ),
    # Neato, with a last ray that repeats the first.
    "neato": Scanner(
        361, radians(359.9999), 0.02, 5.0, 0.003, 0.001, 0.02, 5.0, True, "base_laser_link",
        noise_share=0.01, failed=(inf,),
    ),
}  # fmt: skip


def scanner_of(name: str) -> Scanner:
    """Return the scanner with this name; ValueError if it does not exist."""
    if name not in SCANNERS:
        raise ValueError(f"scanner: expected a Scanner, or {', '.join(SCANNERS)}, got {name!r}")
    return SCANNERS[name]
