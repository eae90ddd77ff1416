"""Distances and contacts against MuJoCo in the same room, if MuJoCo is installed."""

from __future__ import annotations

from math import atan2, hypot

import numpy as np
import pytest

from robowidgets.simulator import World, room
from robowidgets.simulator._raycast import cast_rays

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install mujoco")

THIN = 1e-4
RADIUS = 0.18


def model_of(world: World) -> object:
    """Walls as thin boxes, obstacles as cylinders, and a body like the robot's that moves on the floor."""
    shapes = [
        f'<geom type="box" size="{hypot(x2 - x1, y2 - y1) / 2} {THIN} 1" pos="{(x1 + x2) / 2} {(y1 + y2) / 2} 0" '
        f'euler="0 0 {np.degrees(atan2(y2 - y1, x2 - x1))}"/>'
        for x1, y1, x2, y2 in world.walls
    ] + [f'<geom type="cylinder" size="{radius} 1" pos="{x} {y} 0"/>' for x, y, radius in world.obstacles]
    body = (
        '<body name="robot"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 1 0"/>'
        f'<geom type="cylinder" size="{RADIUS} 0.5"/></body>'
    )
    return mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{''.join(shapes)}{body}</worldbody></mujoco>")


@pytest.mark.parametrize("name", ["house", "office", "maze"])
def test_rays_and_contacts_match_mujoco(name: str) -> None:
    world, rng = room(name), np.random.default_rng(1)
    model = model_of(world)
    data = mujoco.MjData(model)
    angles = np.linspace(-3.1, 3.1, 181)
    rays = np.column_stack((np.cos(angles), np.sin(angles), np.zeros(angles.size)))
    robot, compared, touched = model.body("robot").id, 0, 0
    low, high = world.walls[:, :2].min(axis=0), world.walls[:, :2].max(axis=0)
    for _ in range(200):
        x, y = rng.uniform(low, high)
        data.qpos[:] = x, y
        mujoco.mj_forward(model, data)
        clearance = world.clearance(x, y)
        if abs(clearance - RADIUS) > 2 * THIN and clearance > -RADIUS:
            assert (data.ncon > 0) == (clearance < RADIUS)
            touched += clearance < RADIUS
        if clearance < 0.01:
            continue
        distance, geom = np.empty(angles.size), np.empty(angles.size, np.int32)
        mujoco.mj_multiRay(
            model, data, np.array((x, y, 0.0)), rays.ravel(), None, 1, robot, geom, distance, None, angles.size, 100.0
        )
        ours = np.minimum(*cast_rays(world, x, y, angles))
        met = (distance >= 0) & np.isfinite(ours)
        assert met.mean() > 0.95 or name != "house"
        # At an edge a ray meets one wall or the next, depending on the thickness that the walls have in MuJoCo.
        assert np.mean(np.abs(distance[met] - ours[met]) < 0.01) > 0.97
        compared += 1
    assert compared > 100
    assert touched > 10
