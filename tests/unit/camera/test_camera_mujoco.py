"""The projection of things onto pixels, against the pictures of MuJoCo of a known room, if MuJoCo can draw."""

from __future__ import annotations

import os

import numpy as np
import pytest

from robowidgets.camera.depth_scan import depth_scan
from robowidgets.camera.model import CameraModel
from robowidgets.camera.overlay import ScanOnPicture
from robowidgets.poses.frame_tree import Poses
from robowidgets.samples import Scan
from robowidgets.samples.camera_info import CameraInfo

os.environ.setdefault("MUJOCO_GL", "egl")
mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install mujoco")

WIDTH, HEIGHT, OPENING = 640, 480, 55.0
SCANNER, CAMERA = 0.2, 0.7
TURNED, DOWN = np.radians(12.0), np.radians(18.0)
RAYS, INCREMENT = 121, np.radians(1.0)
ROOM = (
    '<geom type="box" size="0.05 3 1" pos="3.05 0 1"/><geom type="box" size="3 0.05 1" pos="0 2.05 1"/>'
    '<geom type="box" size="3 0.05 1" pos="0 -2.05 1"/><geom type="box" size="0.2 0.3 0.25" pos="1.8 0.6 0.25"/>'
    '<geom type="cylinder" size="0.15 0.3" pos="1.4 -0.5 0.3"/><geom type="plane" size="5 5 0.1"/>'
)


def turned(axis: int, angle: float) -> np.ndarray:
    """A rotation about x, y or z."""
    a, b = [i for i in range(3) if i != axis]
    sign = -1.0 if axis == 1 else 1.0
    result = np.eye(3)
    result[a, a] = result[b, b] = np.cos(angle)
    result[a, b], result[b, a] = -sign * np.sin(angle), sign * np.sin(angle)
    return result


BODY = turned(2, TURNED) @ turned(1, DOWN)
"""Ahead, left and up of the camera in the room; its optical frame is to the right, down and ahead."""
OPTICAL = np.column_stack([-BODY[:, 1], -BODY[:, 2], BODY[:, 0]])


def seen(things: str) -> tuple[np.ndarray, np.ndarray]:
    """A depth image of things in the room, and the thing in each pixel."""
    axes = " ".join(map(str, (*OPTICAL[:, 0], *-OPTICAL[:, 1])))
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><visual><global offwidth="{WIDTH}" offheight="{HEIGHT}"/><map znear="0.005"/></visual><worldbody>'
        f'<camera name="eye" pos="0 0 {CAMERA}" xyaxes="{axes}" fovy="{OPENING}"/>{things}</worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    try:
        renderer = mujoco.Renderer(model, HEIGHT, WIDTH)
    except (RuntimeError, ImportError, AttributeError) as error:
        pytest.skip(f"MuJoCo cannot draw here: {error}")
    with renderer:
        renderer.enable_depth_rendering()
        renderer.update_scene(data, camera="eye")
        depth = renderer.render().copy()
        renderer.disable_depth_rendering()
        renderer.enable_segmentation_rendering()
        renderer.update_scene(data, camera="eye")
        return depth, renderer.render()[:, :, 0].copy()


def measured(start: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Metres along rays to the room, without balls."""
    model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{ROOM}</worldbody></mujoco>")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    distance, geom = np.empty(len(directions)), np.empty(len(directions), np.int32)
    mujoco.mj_multiRay(
        model, data, start, directions.ravel(), None, 1, -1, geom, distance, None, len(directions), 100.0
    )
    return np.where(distance < 0, np.inf, distance)


def camera() -> CameraModel:
    focus = HEIGHT / 2 / np.tan(np.radians(OPENING) / 2)
    k = np.array([focus, 0, (WIDTH - 1) / 2, 0, focus, (HEIGHT - 1) / 2, 0, 0, 1])
    return CameraModel(CameraInfo(WIDTH, HEIGHT, k, frame_id="eye"))


def quaternion(matrix: np.ndarray) -> np.ndarray:
    found = np.empty(4)
    mujoco.mju_mat2Quat(found, matrix.ravel())
    return np.roll(found, -1)


def test_readings_depths_and_scans_fall_where_mujoco_draws_them() -> None:
    angles = (np.arange(RAYS) - RAYS // 2) * INCREMENT
    rays = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(RAYS)])
    start = np.array([0.0, 0.0, SCANNER])
    scan = Scan(measured(start, rays), angles[0], INCREMENT, 0.05, 30.0)
    meets = start + scan.ranges[:, None] * rays
    model = camera()

    # The scanner in the frame of the camera. A ball stands where each sixth ray meets the room.
    at = Poses(((start - [0, 0, CAMERA]) @ OPTICAL)[None], quaternion(OPTICAL.T)[None])
    pixels = ScanOnPicture(model, at, scan).pixels()
    which, compared = np.arange(0, RAYS, 6), 0
    balls = (f'<geom type="sphere" size="0.02" pos="{x} {y} {z}"/>' for x, y, z in meets[which])
    _, ball_at = seen("".join(balls))
    for number, ray in enumerate(which):
        rows, columns = np.nonzero(ball_at == number)
        if len(rows) == 0 or not (rows.min() > 0 and rows.max() < HEIGHT - 1):
            continue
        if columns.min() > 0 and columns.max() < WIDTH - 1:
            assert np.hypot(columns.mean() - pixels[ray, 0], rows.mean() - pixels[ray, 1]) < 1.0
            compared += 1
    assert compared >= 8

    # Each pixel with its depth is a point of the room.
    depth, _ = seen(ROOM)
    grid = np.meshgrid(np.arange(0, WIDTH, 7), np.arange(0, HEIGHT, 7))
    column, row = (each.ravel() for each in grid)
    points = model.points(np.column_stack([column, row]), depth[row, column]) @ OPTICAL.T + [0, 0, CAMERA]
    towards = points - [0, 0, CAMERA]
    lengths = np.linalg.norm(towards, axis=1)
    ours = measured(np.array([0.0, 0.0, CAMERA]), towards / lengths[:, None])
    assert np.mean(np.abs(ours - lengths) < 0.01) > 0.97
    assert (points[:, 2] > -0.01).all()

    # A row of depths is what a scanner in the plane of the camera measures.
    level = depth_scan(depth, model.info, (240, 241), range_min=0.1)
    ahead = np.column_stack([np.cos(level.angles), np.sin(level.angles), np.zeros(len(level))])
    expected = measured(np.array([0.0, 0.0, CAMERA]), ahead @ BODY.T)
    assert np.mean(np.abs(level.ranges - expected) < 0.01) > 0.9
