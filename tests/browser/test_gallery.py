"""The pictures of the documentation, from the recording that the package ships; `make pictures` puts them there."""

from __future__ import annotations

import re
from collections.abc import Callable
from math import cos, radians, sin
from pathlib import Path
from shutil import copy
from typing import Literal

import pytest
from playwright.sync_api import Browser, FloatRect, expect

import robowidgets
from robowidgets import conditions
from scripts import make_sample

from .chromium import PICTURES, SCREENSHOTS, shoot
from .cloud import ROOM as CLOUD
from .moving_picture import MovingPicture
from .notebook import Notebook
from .plain_page import PlainPage

every_theme = pytest.mark.parametrize("theme", ["light", "dark"] if PICTURES else ["light"])
"""Without PICTURES, a run checks in one theme that the subjects of the pictures appear."""

WIDGETS = """
import robowidgets
from robowidgets import LaserWidget, SpeedWidget, TouchWidget

recording = robowidgets.open(robowidgets.SAMPLE)
moment = next(m.seconds for m in recording.samples("/bumper") if any(m.sample.touched.values())) + 0.3
laser = LaserWidget(title="/scan", view_range="data")
speed = SpeedWidget(title="/odom", planar=True)
touch = TouchWidget(title="/bumper")
for m in [*recording.samples("/bumper", end=moment)]:
    touch.update(m)
fastest = max(recording.samples("/odom"), key=lambda m: abs(m.sample.angular[2]))
speed.command(recording.at("/cmd_vel", fastest.seconds))
speed.update(fastest)
laser.update(recording.at("/scan", moment))
player = recording.show()
player.seek(moment)
laser.pinned = laser.scan.nearest().index
scanogram = recording.scanogram()
scanogram.time, scanogram.selection = moment, (moment - 2, moment + 4)
"""


@every_theme
def test_pictures_of_the_widgets(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([WIDGETS, "laser", "speed", "touch", "player", "scanogram"], scale=2, theme=theme)
    nb.resize(680)
    nb.widget(1).locator(".rw-freeze").click()
    nb.python("for i in range(37): laser.update(laser.scan)")
    nb.widget(1).locator(".rw-number", has_text="37").wait_for()
    for cell, name in ((1, "laser"), (2, "speed"), (3, "touch")):
        shoot(nb.widget(cell).locator(".rw-card"), f"gallery-{name}-{theme}")
    nb.resize(1180)
    size = nb.page.viewport_size
    assert size is not None
    nb.page.set_viewport_size({**size, "height": 1700})
    shoot(nb.output(4), f"gallery-recording-{theme}")
    shoot(nb.widget(5).locator(".rw-card"), f"gallery-scanogram-{theme}")


SONARS = """
from robowidgets import Ranges, SonarWidget
from robowidgets.simulator import Robot, World

pioneer = Robot(World.rooms(), (2.0, -2.0, 0.6), model="pioneer", seed=1)
sonars = SonarWidget(title="/sonar", near=0.4)
sonars.update(Ranges({name: pioneer.sonar(name) for name in pioneer.sonars.poses}))
sonars
"""


@every_theme
def test_picture_of_sonars(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([SONARS], scale=2, theme=theme)
    nb.resize(680)
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-sonar-near")).to_contain_text("below 0.4 m")
    shoot(card, f"gallery-sonar-{theme}")


@every_theme
def test_picture_of_a_cloud(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([CLOUD], scale=2, theme=theme)
    nb.resize(680)
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-cloud-nearest")).to_contain_text("nearest 1.34 m")
    shoot(card, f"gallery-cloud-{theme}")


CAMERA = """
import numpy as np
from ipywidgets import HBox
from robowidgets import ImageWidget, LaserWidget, screen
from robowidgets.simulator import Robot, World

rows, columns = np.mgrid[:480, :640]
metres = (1 + rows / 400 + np.abs(columns - 320) / 200).astype(np.float32)
metres[200:330, 280:360] = 0.75
metres[:, :24] = np.nan
depth = ImageWidget(title="/camera/depth", region=(200, 330, 280, 360))
depth.update(metres)

near = Robot(World.rooms(), (0.3, -1.6, 0.15), camera=True, seed=1)
laser = LaserWidget(title="/scan", view_range=1.5, layout={"width": "50%"})
eye = ImageWidget(title="/camera/image_raw", camera_pose=(0, 0, 0.1, 0, 0, 0), layout={"width": "50%"})
screen(eye, laser)
both = HBox([eye, laser])
eye.calibrate(near.camera.info)
eye.take_scan(near.scan())
laser.update(near.scan())
eye.update(near.image())
"""


@every_theme
def test_pictures_of_a_camera(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([CAMERA, "depth", "both"], scale=2, theme=theme)
    nb.resize(680)
    card = nb.widget(1).locator(".rw-card")
    expect(card.locator(".rw-popup:visible")).to_contain_text("0.750 m")
    shoot(card, f"gallery-image-{theme}")
    nb.resize(1180)
    eye = nb.output(2).locator(".rw-image")
    picture = eye.locator(".rw-picture")
    index, column, row = map(
        float, nb.python("i = laser.scan.nearest('front').index; print(i, *eye.seen.pixels[i])").split()
    )
    box = picture.bounding_box()
    assert box
    factor = min(box["width"] / 320, box["height"] / 240)
    left, top = (box["width"] - 320 * factor) / 2, (box["height"] - 240 * factor) / 2
    picture.hover(position={"x": left + (column + 0.5) * factor, "y": top + (row + 0.5) * factor})
    expect(nb.output(2).locator(".rw-laser .rw-popup:visible")).to_contain_text(f"ranges[{index:.0f}]")
    shoot(nb.output(2), f"gallery-camera-{theme}")


EVENTS = r"""
from robowidgets import EventsWidget

lines = (
    (0.0, "INFO", "bringup", "all nodes have started"),
    (1.2, "DEBUG", "follower", "wall at 0.42 m, angle 3.1°"),
    *((2.0 + i / 2, "WARN", "scan", "12 rays were lost") for i in range(14)),
    (9.5, "INFO", "joy", "button 0 pressed"),
    (9.8, "INFO", "joy", "button 0 released"),
    (11.0, "ERROR", "base: left motor", "over current: 4.2 A, limit 3.0 A\nThe driver is off until it is reset."),
    (12.5, "INFO", "follower", "stops: no wall within 2 m"),
    (14.0, "WARN", "battery", "stale: no data for 5 s"),
)
events = EventsWidget(title="/rosout, /diagnostics, /joy")
for seconds, level, source, text in lines:
    events.add(text, level=level, source=source, time=seconds)
events
"""


@every_theme
def test_picture_of_events(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([EVENTS], scale=2, theme=theme)
    nb.resize(860)
    card = nb.widget(0).locator(".rw-card")
    card.locator(".rw-event:visible").filter(has_text="over current").click()
    expect(card.locator(".rw-event-whole:visible")).to_contain_text("The driver is off")
    nb.page.mouse.move(0, 0)
    shoot(card, f"gallery-events-{theme}")


MESSAGE = """
import robowidgets
from robowidgets import MessageWidget

odometry = MessageWidget(title="/odom", folds={"header": False, "pose.pose.orientation": False})
odometry.update(robowidgets.open(robowidgets.SAMPLE).message_at("/odom", 12.5))
odometry
"""


@every_theme
def test_picture_of_a_message(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([MESSAGE], scale=2, theme=theme)
    nb.resize(680)
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator('.rw-message-row[data-rw-row="twist.twist.linear.x"]')).to_contain_text("m/s")
    shoot(card, f"gallery-message-{theme}")


PLOT = """
import robowidgets
from robowidgets import conditions

recording = robowidgets.open(robowidgets.SAMPLE)
fields = ("/odom.twist.twist.linear.x", "/cmd_vel.twist.linear.x", "/odom.twist.twist.angular.z")
plot = robowidgets.plot(recording, *fields, marks=recording.find(conditions.touched()), title="sample")
plot.time = 33.2
plot
"""


@every_theme
def test_picture_of_a_plot(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([PLOT], scale=2, theme=theme)
    nb.resize(860)
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-plot-at").first).to_have_text("at 33.200 s")
    shoot(card, f"gallery-plot-{theme}")


WIRES = """
from robowidgets import LaserWidget, conditions, feeds
from robowidgets.behaviors import Drive

wired = feeds.simulator(wander=False)
front = LaserWidget()
wired.connect("/scan", front)
front.watch(conditions.nearest_below(0.5), "near")

@wired.program(rate=10)
def avoid(scan):
    return Drive(0.2) if scan.distance("front") > 0.6 else Drive(0, 0.8)

wired.wires().wires
"""


@every_theme
def test_picture_of_wires(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([WIRES], scale=2, theme=theme)
    nb.resize(1080)
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator("[data-key='speeds speeds 0']")).to_contain_text("0.2 m/s")
    card.locator("[data-key='topic /scan']").hover()
    expect(card.locator(".rw-wires-foot")).to_contain_text("here to")
    shoot(card, f"gallery-wires-{theme}")


FOUND = """
import robowidgets
from ipywidgets import VBox
from robowidgets import conditions

recording = robowidgets.open(robowidgets.SAMPLE)
bumps = recording.find(conditions.touched())
bump = bumps[0]
scan = recording.scans("/scan").at(bump.start).sample
ray = scan.nearest().index
drive = recording.scanogram()
drive.marks = bumps
drive.view, drive.time = (bump.start - 5, bump.start + 5), bump.start
drive.selection = (bump.start - 4, bump.start, ray - 15, ray + 16)
laser = robowidgets.LaserWidget(title=f"/scan at {bump.start:.2f} s", view_range=1.5)
laser.update(scan)
laser.pinned = ray
VBox([drive, laser])
"""


@every_theme
def test_pictures_of_found_moments(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([FOUND], scale=2, theme=theme)
    nb.resize(764, height=1600)
    drive = nb.output(0).locator(".rw-scanogram")
    drive.locator(".rw-scanogram-chip").wait_for(state="hidden")
    shoot(nb.widget(0), f"gallery-find-{theme}")


MOMENTS = """
import robowidgets
from concurrent.futures import ThreadPoolExecutor
from robowidgets import conditions

with ThreadPoolExecutor(1) as here:
    hits = robowidgets.find(conditions.nearest_below(0.6), {folder!r}, executor=here, keep=False)
sheet = hits.show()
sheet
"""


@every_theme
def test_pictures_of_moments_in_many_recordings(
    plain_page: Callable[..., PlainPage], tmp_path: Path, theme: Literal["light", "dark"]
) -> None:
    for number in (412, 87, 733, 260):
        copy(robowidgets.SAMPLE, tmp_path / f"drive_{number:04}.mcap")
    (tmp_path / "drive_0583.bag").touch()
    nb = plain_page([MOMENTS.format(folder=str(tmp_path))], scale=2, theme=theme)
    nb.resize(1280, height=1000)
    nb.run_all()
    sheet = nb.widget(0).locator(".rw-sheet")
    nb.page.wait_for_function("() => document.querySelectorAll('[data-painted=\"rays\"]').length >= 24")
    nb.python("sheet.widget.sort = '-nearest'")
    nb.page.wait_for_function("() => !document.querySelector('.rw-sheet-tile:not([data-painted])')")
    shoot(sheet, f"gallery-moments-{theme}")


COMPARED = """
import robowidgets
view = robowidgets.compare({fast!r}, {slow!r})
view.plot.time = 12.0
view
"""


@every_theme
def test_pictures_of_two_drives(
    plain_page: Callable[..., PlainPage],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    theme: Literal["light", "dark"],
) -> None:
    slow = tmp_path / "slower.mcap"
    monkeypatch.setattr(make_sample, "FORWARD", 0.35)
    make_sample.main(slow)
    nb = plain_page([COMPARED.format(fast=str(robowidgets.SAMPLE), slow=str(slow))], scale=2, theme=theme)
    nb.resize(1130, height=1000)
    plot, way = nb.output(0).locator(".rw-plot"), nb.output(0).locator(".rw-path")
    expect(plot.locator(".rw-plot-ghost")).to_have_count(2)
    expect(way.locator(".rw-footer")).to_contain_text("driven")
    shoot(nb.output(0), f"gallery-compare-{theme}")


CONDITIONS = """
import time
import robowidgets
from robowidgets import LaserWidget, Sector, conditions

recording = robowidgets.open(robowidgets.SAMPLE)
bump = recording.find(conditions.touched())[0]
laser = LaserWidget(title="/scan", view_range=3.5)
laser.sectors["ahead"] = Sector("-50deg", "0deg", near=0.5)
laser.watch(conditions.nearest_below(0.5, laser.sectors["ahead"]), name="table")
laser.watch(lambda scan: scan.distance("left") < 0.4, name="wall on the left")
laser
"""
APPROACH = """
for moment in recording.samples("/scan", bump.start - 2.5, bump.start - 0.35):
    laser.update(moment.sample)
    time.sleep(0.1)
laser.ghost = 8
"""


@every_theme
def test_pictures_of_conditions(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([CONDITIONS, APPROACH], scale=2, theme=theme, run=False)
    nb.run(0)
    nb.resize(680)
    nb.run(1)
    card = nb.widget(0).locator(".rw-card")
    card.locator(".rw-lamp[data-rw-state='true']").wait_for()
    card.locator(".rw-freeze").click()
    shoot(card, f"gallery-conditions-{theme}")


TRAIL = """
import robowidgets
from robowidgets import LaserWidget, PathWidget, screen
from robowidgets.widget.pacer import pacer

laser, path = LaserWidget(title="/scan", view_range=5, trail=60), PathWidget(title="/odom")
view = screen(laser, path)
laser
"""
DRIVE = """
recording = robowidgets.open(robowidgets.SAMPLE)
for moment in recording.samples(("/scan", "/odom"), 17.8, 24.0):
    (path if moment.topic == "/odom" else laser).update(moment)
    pacer.flush()
laser.paused = True
"""


@every_theme
def test_pictures_of_a_trail(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([TRAIL, DRIVE], scale=2, theme=theme, run=False)
    nb.run(0)
    nb.resize(680)
    nb.run(1)
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-footer")).to_contain_text("trail of 60, by odometry")
    expect(card.locator(".rw-freeze")).to_have_attribute("aria-pressed", "true")
    shoot(card, f"gallery-trail-{theme}")


PAD = """
from robowidgets import DriveWidget
from robowidgets.simulator import Robot, World
pad = DriveWidget(send=Robot(World.rooms()).drive, title="/cmd_vel")
pad
"""


@every_theme
def test_pictures_of_the_drive_pad(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([PAD], scale=2, theme=theme)
    card = nb.widget(0).locator(".rw-card")
    box = card.locator(".rw-pad").bounding_box()
    assert box is not None
    nb.page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    nb.page.mouse.down()
    nb.page.mouse.move(box["x"] + 0.36 * box["width"], box["y"] + 0.24 * box["height"])
    card.locator(".rw-words", has_text="driving").wait_for()
    nb.page.wait_for_function("() => /^0[.]3/.test(document.querySelector('.rw-readout-value').textContent)")
    shoot(card, f"gallery-drive-{theme}")


SIDEWAYS = """
from robowidgets import DriveWidget
from robowidgets.simulator import Robot, World
pr2 = Robot(World.rooms(), model="pr2")
pad = DriveWidget(send=pr2.drive, title="pr2 /cmd_vel", lateral_limit=0.2)
pad
"""


@every_theme
def test_pictures_of_a_pad_for_sideways(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([SIDEWAYS], scale=2, theme=theme)
    card = nb.widget(0).locator(".rw-card")
    box = card.locator(".rw-slide").bounding_box()
    assert box is not None
    nb.page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    nb.page.mouse.down()
    nb.page.mouse.move(box["x"] + 0.28 * box["width"], box["y"] + 0.4 * box["height"])
    card.locator(".rw-words", has_text="driving").wait_for()
    expect(card.locator(".rw-readout-value").nth(2)).to_have_text(re.compile("^0[.]1"))
    shoot(card, f"gallery-drive-sideways-{theme}")


PROGRAM = """
from robowidgets import ProgramWidget, feeds
from robowidgets.behaviors import Drive
robot = feeds.simulator(wander=False)
robot.variables.slider("f_vel", 0.25, 0.0, 0.5, "m/s")
robot.variables.slider("near", 0.55, 0.2, 2.0, "m")
robot.variables.go = True

@robot.program(rate=20)
def avoid(scan, state, variables):
    state.n = state.get("n", 0) + 1
    if state.n in (7, 14, 21):
        print(f"near {scan.distance('front'):.2f} m [{state.n}]")
    return Drive(variables.f_vel if variables.go else 0, -0.3)

ProgramWidget(robot)
"""


def test_a_picture_of_a_program(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([PROGRAM], scale=2, width=500)
    card = nb.widget(0).locator(".rw-program")
    expect(card.locator(".rw-print-text")).to_have_count(3)
    shoot(card, "gallery-program-light")
    nb.python("robot.close()")


MACHINE = """
from robowidgets import MachineWidget, conditions, feeds
from robowidgets.behaviors import Drive
robot = feeds.simulator(wander=False, hz=20)

class Walker:
    near = conditions.nearest_below(1.5, "front")
    bumped = lambda touch: any(touch.touched.values())
    def forward(): return Drive(0.3)

    class avoid:
        free_left = lambda scan: scan.distance("left") > scan.distance("right")
        free_right = lambda scan: not scan.distance("left") > scan.distance("right")
        def stop(): return Drive()
        def backward(): return Drive(-0.25)
        def turn_left(): return Drive(0, 1.0)
        def turn_right(): return Drive(0, -1.0)
        finish = None
        moves = (
            "stop -> backward after 0.4",
            "backward -> turn_left on free_left",
            "backward -> turn_right on free_right",
            "turn_left -> finish after 1.1",
            "turn_right -> finish after 1.1",
        )
    moves = "forward -> avoid on near", "forward -> avoid on bumped", "avoid -> forward on done"

robot.program(Walker, rate=20)
MachineWidget(robot)
"""


@every_theme
def test_pictures_of_a_machine(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([MACHINE], scale=2, theme=theme, width=720)
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-fired-row")).to_have_count(8)
    card.locator(
        ".rw-machine-state[data-active=leaf] .rw-machine-state-left", has_text=re.compile(r"0\.[5-9]")
    ).wait_for()
    shoot(card, f"gallery-machine-{theme}")
    nb.python("robot.close()")


ROBOT = """
from robowidgets import feeds
from robowidgets.behaviors import Drive

robot = feeds.simulator(wander=False)
robot.variables.slider("f_vel", 0.4, 0.0, 0.6, "m/s")
robot.variables.slider("near", 1.2, 0.2, 2.0, "m")


class Avoid:
    obstacle = lambda scan, variables: scan.distance("front") < variables.near
    free = lambda scan, variables: scan.distance("front") > variables.near + 0.2

    def forward(variables):
        return Drive(variables.f_vel)

    def turn():
        return Drive(0, 0.8)

    moves = "forward -> turn on obstacle", "turn -> forward on free"


robot.program(Avoid, rate=20)
robot.show()
"""


@every_theme
def test_pictures_of_a_robot_on_one_screen(
    plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]
) -> None:
    nb = plain_page([ROBOT], scale=2, theme=theme, width=1152, height=720)
    driven = 3 if PICTURES else 1  # each takes seconds, with every widget at work
    expect(nb.output(0).locator(".rw-fired-row").nth(driven - 1)).to_be_visible(timeout=60_000)
    if PICTURES:
        expect(nb.output(0).locator(".rw-machine-state[data-active=leaf]")).to_contain_text("forward")
    shoot(nb.output(0), f"gallery-feed-{theme}")
    nb.python("robot.close()")


OFFICE = """
from robowidgets.simulator import Robot, View, room, wander
robot = Robot(room("office"), model="kobuki", scanner="rplidar_a1", seed=2)
view = View(robot)
robot.run(40, behavior=wander(robot))
view
"""


@every_theme
def test_pictures_of_a_room(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([OFFICE], scale=2, theme=theme, width=720)
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-facts")).to_contain_text("40.0 s")
    shoot(card, f"gallery-room-{theme}")


DRIVEN = """
from robowidgets import PathWidget
from math import sin
from robowidgets.simulator import Robot, World
hall = World.from_text("\\n".join(["#" * 30, *["#" + "." * 28 + "#"] * 18, "#" * 30]))
robot = Robot(hall, (3.0, 3.0, 0.0), seed=2)
path = PathWidget(title="/odom")
path.has_rate = False
while robot.time < 75:
    robot.drive(0.5, 0.2 + 0.5 * sin(robot.time / 3.2))
    robot.step(0.1)
    path.update(robot.speed(), time=robot.time)
path
"""


@every_theme
def test_pictures_of_a_path(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([DRIVEN], scale=2, theme=theme, width=720)
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-footer")).to_contain_text("driven")
    card.locator(".rw-picture").focus()
    nb.page.keyboard.press("Home")
    for _ in range(12):
        nb.page.keyboard.press("PageUp")
    nb.page.evaluate("document.activeElement.blur()")
    shoot(card, f"gallery-path-{theme}")


MAPPED = """
from robowidgets import Line, PathWidget
from tests import map_scene
path = PathWidget(title="Map")
path.has_rate = False
map_scene.drive(path)
path.draw("door 2", Line((4.9, -0.6), (6.0, -0.6)), frame="odom")
path
"""


@every_theme
def test_pictures_of_a_map(plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"]) -> None:
    nb = plain_page([MAPPED], scale=2, theme=theme, width=1030)
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-layers-row")).to_have_count(7)
    shoot(card, f"gallery-map-{theme}")


LARGEST_PAGE = 2_000_000


@pytest.fixture(scope="module")
def files() -> list[Path]:
    """The pages in files of the gallery."""
    SCREENSHOTS.mkdir(exist_ok=True)
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        bumps = recording.find(conditions.touched())
        note = "Center and right touch at once. The nearest reading is 0.15 m away, to the right of the middle."
        ends = {"start": bumps[0].start - 5, "end": bumps[0].start + 5}
        path = SCREENSHOTS / "gallery-bump.html"
        part = recording.to_html(path, **ends, marks=bumps, title="The first bump", note=note)
        whole = recording.to_html(SCREENSHOTS / "gallery-drive.html", marks=bumps, title="A drive through a flat")
    return [part, whole]


@every_theme
def test_pictures_of_pages(browser: Browser, files: list[Path], theme: Literal["light", "dark"]) -> None:
    assert all(file.stat().st_size <= LARGEST_PAGE for file in files)
    context = browser.new_context(
        color_scheme=theme, device_scale_factor=2, offline=True, viewport={"width": 1180, "height": 900}
    )
    shown = context.new_page()
    shown.goto(files[0].as_uri())
    shown.locator(".rw-player .rw-slider").focus()
    shown.keyboard.press("n")
    shown.evaluate("document.activeElement.blur()")
    shown.locator(".rw-scanogram", has_text="100 scans").wait_for()
    shown.locator(".rw-touch", has_text="touched").wait_for()
    shoot(shown.locator("body"), f"gallery-page-{theme}")
    context.close()


ROOM = """
from robowidgets import LaserWidget
from robowidgets.simulator import Robot, World
robot = Robot(World.rooms(), pose=(-1.0, -2.2, 3.0), seed=1)
laser = LaserWidget(title="/scan")
laser.update(robot.scan())
laser.layout.width = "620px"
"""
ARC = """(picture) => {
    const { left, top, width, height } = picture.getBoundingClientRect();
    return [left + width / 2, top + height * 0.57, height * 0.3];
}"""


@pytest.mark.skipif(not PICTURES, reason="takes a minute: only for `make pictures`")
def test_a_moving_picture_of_a_drag_that_becomes_code(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([ROOM, "laser", "scan = laser.scan\n"], run=False, scale=2, width=760, height=1000)
    nb.run(0)
    nb.run(1)
    card = nb.widget(1).locator(".rw-card")
    shown, cell = nb.output(1), nb.page.locator(".jp-Cell").nth(2)
    nb.page.locator(".jp-Cell").nth(1).evaluate("(cell) => cell.scrollIntoView()")
    start, end = shown.bounding_box(), cell.bounding_box()
    assert start
    assert end
    # With room for the chip below the picture, a line of code and its result.
    height = end["y"] + end["height"] + 74 + 80 - start["y"]
    clip = FloatRect(x=end["x"], y=start["y"] - 6, width=646, height=height)
    film = MovingPicture(nb.page, clip)
    x, y, radius = card.locator(".rw-picture").evaluate(ARC)

    def on_arc(degrees: float) -> tuple[float, float]:
        return x + radius * cos(radians(degrees + 90)), y - radius * sin(radians(degrees + 90))

    film.take(600)
    film.move(*on_arc(-25))
    nb.page.mouse.down()
    for i in range(11):
        film.jump(*on_arc(-25 + 55 * i / 10))
    nb.page.mouse.up()
    film.take(900)
    copy = card.locator(".rw-copy").last
    box = copy.bounding_box()
    assert box
    film.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    nb.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    copy.click()
    expect(copy).to_have_text("Copied")
    film.take(900)
    field = cell.locator(".cm-content")
    box = field.bounding_box()
    assert box
    film.move(box["x"] + 200, box["y"] + box["height"] - 12)
    field.click()
    nb.page.keyboard.press("Control+End")
    film.take(400)
    nb.page.keyboard.press("Control+V")
    expect(field).to_contain_text("scan.distance((")
    film.take(900)
    nb.page.keyboard.press("Control+Enter")
    result = cell.locator(".jp-OutputArea-output")
    expect(result).to_have_text(re.compile(r"^\d\.\d+$"))
    expect(card.locator(".rw-chip-distance")).to_have_text(f"{float(result.inner_text()):.2f} m")
    film.take(2500)
    film.save("gallery-drag-to-code")


EXPLORER = """
from ipywidgets import HBox
from robowidgets import MachineWidget, conditions, feeds
from robowidgets.behaviors import Drive
from robowidgets.simulator import Robot, View, room
robot = feeds.simulator(Robot(room("house"), seed=1), wander=False, hz=20)
view, machine = View(robot), MachineWidget(robot)
view.layout.width, machine.layout.width = "430px", "414px"
view.layout.height = machine.layout.height = "480px"
HBox([view, machine])
"""
EXPLORE = """\
class Explore:
    near = conditions.nearest_below(1.6, "front")
    def forward(): return Drive(0.5)
    def turn(): return Drive(0, 1)
    moves = \"\"\"
        forward -> turn on near
        turn -> forward after 1.2
    \"\"\"
robot.program(Explore, rate=20);"""


@pytest.mark.skipif(not PICTURES, reason="takes a minute: only for `make pictures`")
def test_a_moving_picture_of_a_program_edited_while_it_drives(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([EXPLORER, EXPLORE], run=False, scale=1, width=1100, height=1000)
    nb.run(0)
    nb.resize(850, height=1000)
    house, cell = nb.widget(0).locator(".rw-simulator"), nb.page.locator(".jp-Cell").nth(1)
    nb.run(1)
    nb.output(0).evaluate("(output) => output.scrollIntoView()")
    expect(house.locator(".rw-facts")).to_contain_text("14.0")
    box, below = nb.output(0).bounding_box(), cell.bounding_box()
    assert box
    assert below
    two_lines = 36
    height = below["y"] + below["height"] + two_lines - box["y"]
    clip = FloatRect(x=below["x"], y=box["y"] - 4, width=below["width"], height=height)
    rows = nb.widget(0).locator(".rw-fired-row")
    expect(rows.nth(1)).to_be_attached()
    film = MovingPicture(nb.page, clip)
    film.run(0.6)
    line = cell.locator(".cm-line", has_text="def turn").bounding_box()
    name = cell.locator(".cm-line", has_text="forward -> turn").bounding_box()
    assert line
    assert name

    def type_in(text: str) -> None:
        for i in range(0, len(text), 5):
            nb.page.keyboard.insert_text(text[i : i + 5])
            film.take_live()

    def go_to(x: float, y: float) -> None:
        film.move(x, y)
        nb.page.mouse.click(x, y)

    # From the last line to the first, so that lines still to edit do not move.
    go_to(name["x"] + 330, name["y"] + name["height"] / 2)
    for _ in "turn on near":
        nb.page.keyboard.press("Shift+ArrowLeft")
    film.take_live()
    type_in("back on near\n        back -> turn after 0.7")
    go_to(line["x"] + 330, line["y"] + line["height"] / 2)
    type_in("\n    def back(): return Drive(-0.3)")
    nb.page.keyboard.press("Control+Enter")
    expect(nb.widget(0).locator(".rw-machine .rw-facts")).to_contain_text("v2")
    new = rows.filter(has_text="back \u2192 turn")
    film.run(6, until=lambda: new.count() > 0)
    expect(new).to_have_count(1)
    film.run(1)
    film.save("gallery-edit-while-driving")
    nb.python("robot.close()")


THINKER = """
from ipywidgets import HBox
from robowidgets import LaserWidget, LinesWidget, feeds
from robowidgets.behaviors import Drive
from robowidgets.simulator import Robot, World
robot = feeds.simulator(Robot(World.rooms(), pose=(-1.0, -2.2, 3.0), seed=1), wander=False, hz=20)
laser, lines = LaserWidget(), LinesWidget(robot)
robot.connect("/scan", laser)
laser.layout.width, lines.layout.width = "300px", "700px"
laser.layout.height = lines.layout.height = "320px"
HBox([laser, lines])
"""
THINK = """\
@robot.program(rate=20)
def avoid(scan):
    front = scan.distance("front")
    left = scan.distance("left")
    right = scan.distance("right")
    if front < 0.8:
        return Drive(0, 0.8 if left > right else -0.8)
    return Drive(0.4)
"""


@pytest.mark.skipif(not PICTURES, reason="takes a minute: only for `make pictures`")
def test_a_moving_picture_of_the_lines_of_a_program(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([THINKER, THINK], run=False, scale=1, width=1300, height=1000)
    nb.run(0)
    nb.resize(1100, height=1000)
    nb.run(1)
    nb.output(0).evaluate("(output) => output.scrollIntoView()")
    lines = nb.widget(0).locator(".rw-lines")
    test, read = (lines.locator(".rw-line", has_text=text) for text in ("if front < 0.8", "front = scan"))
    expect(test).to_be_visible()
    left, right = (nb.widget(0).locator(f".rw-{one}").bounding_box() for one in ("laser", "lines"))
    assert left
    assert right
    width = right["x"] + right["width"] - left["x"]
    film = MovingPicture(
        nb.page, FloatRect(x=left["x"] - 4, y=left["y"] - 4, width=width + 8, height=left["height"] + 8)
    )
    film.run(3)
    film.run(5, until=lambda: "True" in test.inner_text())
    row = read.bounding_box()
    assert row
    film.move(row["x"] + 180, row["y"] + row["height"] / 2)
    film.run(4)
    film.save("gallery-lines")
    nb.python("robot.close()")
