"""Rooms that are ready-made, drawn as text, or made from a map."""

from __future__ import annotations

import re
import time
from math import cos, pi, sin
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from robowidgets import feeds
from robowidgets.simulator import Robot, Scanner, World, room, wander
from robowidgets.simulator._raycast import cast_rays

EXACT = Scanner(ray_count=4, field_of_view=1.5 * pi, noise=0.0, resolution=0.0, dropout=0.0, range_max=30.0)
"""Rays at -135, -45, 45 and 135 degrees."""
DRAWN = """
    ##########
    #..o.....#
    #.^....#.#
    #......#.#
    ##########
"""


def test_a_room_of_text_has_its_walls_obstacles_and_start_where_they_are_drawn() -> None:
    world = World.from_text(DRAWN, cell=0.5)
    assert world.start == (1.25, 1.25, pi / 2)
    assert world.obstacles.tolist() == [[1.75, 1.75, pytest.approx(0.175)]]
    right, up = (cast_rays(world, 1.25, 0.75, np.array([angle]))[0][0] for angle in (0.0, pi / 2))
    assert (right, up) == (pytest.approx(3.5 - 1.25), pytest.approx(2.0 - 0.75))
    assert Robot(world).pose == (1.25, 1.25, pi / 2)


def test_neighbouring_cells_of_a_wall_are_one_segment() -> None:
    room = World.from_text("#####\n#   #\n#   #\n#####", cell=1.0)
    assert sorted(map(tuple, room.walls.tolist())) == [(1, 1, 1, 3), (1, 1, 4, 1), (1, 3, 4, 3), (4, 1, 4, 3)]


def test_what_lies_outside_of_a_drawing_is_not_floor() -> None:
    shifted = World.from_text("  ####\n  #..#\n  ####")
    assert len(shifted.walls) == 4


def test_a_room_without_a_mark_starts_where_there_is_room() -> None:
    world = World.from_text("######\n#    #\n#    #\n#  o #\n######", cell=1.0)
    assert world.clearance(*world.start[:2]) >= 0.5


@pytest.mark.parametrize(
    ("text", "cell", "error", "words"),
    [
        (7, 0.5, TypeError, "text: expected the lines of a room, such as '####', got 7"),
        ("##\n#X", 0.5, ValueError, "got 'X' in line 2, column 2"),
        ("> <", 0.5, ValueError, "text: expected one robot, as one of > < ^ v; got 2"),
        ("####", 0.5, ValueError, "text: expected free floor, as spaces or dots, got none"),
        ("\n\n", 0.5, ValueError, "text: expected free floor"),
        ("##\n #", 0.5, ValueError, "spaces at the ends of a line are outside"),
        ("#.", 0, ValueError, "cell: expected metres above 0, got 0"),
        ("#.", "1", TypeError, "cell: expected a number, got '1'"),
    ],
)
def test_errors_for_a_text_that_is_not_a_room(text: str, cell: float, error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=re.escape(words)):
        World.from_text(text, cell)


@pytest.mark.parametrize("name", ["house", "corridor", "office", "maze"])
def test_a_robot_finds_its_way_in_every_ready_made_room(name: str) -> None:
    robot = Robot(room(name))
    places = set()
    for _ in wander(robot):
        robot.step(0.1)
        places.add((round(robot.pose.x), round(robot.pose.y)))
        if robot.time > 20:
            break
    assert len(places) > 3
    assert robot.world.clearance(*robot.pose[:2]) >= robot.radius - 1e-6
    assert np.isfinite(robot.scan().ranges).mean() > 0.7, "there are walls all round"


def test_each_seed_is_another_maze_all_of_which_can_be_reached() -> None:
    mazes = [room("maze", seed) for seed in (1, 1, 2)]
    assert mazes[0].walls.tolist() == mazes[1].walls.tolist() != mazes[2].walls.tolist()
    for maze in mazes:
        middles = [((3 * i + 2) * 0.45, (3 * j + 2) * 0.45) for i in range(7) for j in range(5)]
        reached, new = set(), {middles[0]}
        while new:
            reached |= new
            new = {other for one in new for other in middles if other not in reached and _joined(maze, one, other)}
        assert len(reached) == 35


def _joined(maze: World, one: tuple[float, float], other: tuple[float, float]) -> bool:
    dx, dy = other[0] - one[0], other[1] - one[1]
    return abs(np.hypot(dx, dy) - 1.35) < 0.01 and cast_rays(maze, *one, np.array([np.arctan2(dy, dx)]))[0][0] > 1.35


def test_words_for_a_room_that_there_is_not() -> None:
    with pytest.raises(ValueError, match="room: expected house, corridor, office, maze, got 'garden'"):
        room("garden")
    with pytest.raises(TypeError, match="room: expected a name such as 'maze', or a World, got 3"):
        room(3)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="seed: expected 0 or more, got -1"):
        room("maze", -1)


# -- maps --------------------------------------------------------------------------------------------------------------


def grid(**more: object) -> dict[str, object]:
    """A map of 4 by 3 cells: a wall on the left, unknown on the right, and one cell of 40 %."""
    data = [100, 0, 40, -1] * 3
    return {"info": {"width": 4, "height": 3, "resolution": 0.5, **more}, "data": data}


def test_occupied_cells_of_a_map_are_walls_and_unknown_ones_are_not() -> None:
    assert World.from_map(grid()).walls.tolist() == [[0.5, 0.0, 0.5, 1.5]]


def test_a_map_lies_where_its_origin_says_as_message_or_dict() -> None:
    turned = {"position": {"x": 2.0, "y": 1.0}, "orientation": {"z": sin(pi / 4), "w": cos(pi / 4)}}
    as_dict = World.from_map(grid(origin=turned))
    assert as_dict.walls[0].tolist() == pytest.approx([2.0, 1.5, 0.5, 1.5])
    info = SimpleNamespace(width=4, height=3, resolution=0.5, origin=SimpleNamespace(**{
        name: SimpleNamespace(**values) for name, values in turned.items()}))  # fmt: skip
    message = SimpleNamespace(info=info, data=np.array([100, 0, 40, -1] * 3, np.int8))
    assert World.from_map(message).walls.tolist() == as_dict.walls.tolist()


def written(
    folder: Path, about: str = "", *, pixels: bytes = b"\x00\xfe\xcd" * 2, header: str = "P5\n# made\n3 2\n255\n"
):
    (folder / "map.pgm").write_bytes(header.encode() + pixels)
    path = folder / "map.yaml"
    path.write_text(about or "image: map.pgm\nresolution: 0.5\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\n"
                    "occupied_thresh: 0.65\nfree_thresh: 0.196\n")  # fmt: skip
    return path


def test_a_map_of_map_server_opens_as_it_was_saved(tmp_path: Path) -> None:
    assert World.from_map(written(tmp_path)).walls.tolist() == [[-0.5, 2.0, -0.5, 3.0]]
    plain = written(tmp_path, pixels=b"0 254 205\n0 254 205\n", header="P2 3 2 255\n")
    assert World.from_map(str(plain)).walls.tolist() == [[-0.5, 2.0, -0.5, 3.0]]
    start = World.from_map(plain, start=(0.0, 2.5, 0.1)).start
    assert start == (0.0, 2.5, 0.1)


def test_words_for_a_map_that_cannot_be(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match="map: expected a nav_msgs/OccupancyGrid, or the path of a YAML file, got 5"):
        World.from_map(5)
    with pytest.raises(ValueError, match="map: expected 4 x 9 cells, as its info says, got 12"):
        World.from_map(grid(height=9))
    with pytest.raises(ValueError, match="resolution: expected metres above 0, got 0"):
        World.from_map(grid(resolution=0))
    with pytest.raises(ValueError, match="map: expected free cells; all are occupied or unknown"):
        World.from_map({**grid(), "data": [100, -1] * 6})
    with pytest.raises(TypeError, match="map: expected data as whole numbers from -1 to 100"):
        World.from_map({**grid(), "data": "none"})
    with pytest.raises(ValueError, match=r"map.yaml: expected the YAML file of a map, with image, resolution and"):
        World.from_map(written(tmp_path, "image: [map.pgm"))
    with pytest.raises(ValueError, match=r"map.pgm: expected 3 x 2 pixels, got 3: the file is cut off"):
        World.from_map(written(tmp_path, pixels=b"\x00\xfe\xcd"))
    with pytest.raises(ValueError, match=r"map.pgm: expected an image in PGM"):
        World.from_map(written(tmp_path, header="PNG"))
    with pytest.raises(FileNotFoundError):
        World.from_map(tmp_path / "none.yaml")


def test_a_map_with_thousands_of_walls_stays_fast_and_looks_as_if_all_were_tried() -> None:
    rng = np.random.default_rng(1)
    data = np.where(rng.random((300, 300)) < 0.03, 100, 0)
    data[140:160, 140:160] = 0
    world = World.from_map({"info": {"width": 300, "height": 300, "resolution": 0.1}, "data": data.ravel()})
    assert len(world.walls) > 5000
    robot = Robot(world, (15.0, 15.0, 0.0), scanner=Scanner(ray_count=1040, range_max=30.0))
    slow = min(
        distance for x1, y1, x2, y2 in world.walls if x1 == x2 and x1 > 15 and y1 <= 15.05 <= y2
        for distance in [x1 - 15.0]
    )  # fmt: skip
    assert cast_rays(world, 15.0, 15.05, np.zeros(1))[0][0] == pytest.approx(slow)
    robot.drive(0.2, 0.5)
    began = time.process_time()
    for _ in range(50):
        robot.step(0.1)
        robot.scan()
    assert time.process_time() - began < 5.0 / 2, "at least twice as fast as time"
    assert all(len(part.walls) < 500 for part in world._near.values())


# -- the feed ----------------------------------------------------------------------------------------------------------


def test_the_feed_takes_a_room_by_name_or_a_world() -> None:
    for given in ("corridor", World.from_text(DRAWN)):
        with feeds.simulator(room=given, hz=100.0) as feed:
            assert next(feed.scans("/scan", timeout=60)).distance("front") < 30
    with pytest.raises(TypeError, match="simulator: expected a Robot, which has its world, scanner and camera"):
        feeds.simulator(Robot(World()), room="maze")
    with pytest.raises(ValueError, match="room: expected house, corridor, office, maze, got 'hall'"):
        feeds.simulator(room="hall")
