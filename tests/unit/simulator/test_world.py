import numpy as np
import pytest

from robowidgets.simulator import Robot, World


def test_clearance_is_the_distance_to_the_nearest_thing():
    world = World(walls=[(3.0, -2.0, 3.0, 2.0)], obstacles=[(0.0, 2.0, 0.5)])
    assert world.clearance(1.0, -1.0) == pytest.approx(2.0)
    assert world.clearance(0.0, 0.5) == pytest.approx(1.0)
    assert world.clearance(-3.0, 5.0) == pytest.approx(np.hypot(3, 3) - 0.5)


def test_clearance_reaches_past_the_end_of_a_wall_to_its_corner():
    assert World(walls=[(0.0, 0.0, 1.0, 0.0)]).clearance(4.0, 4.0) == pytest.approx(5.0)


def test_clearance_is_negative_inside_an_obstacle_and_inf_in_an_empty_world():
    assert World(obstacles=[(0.0, 0.0, 0.5)]).clearance(0.1, 0.0) == pytest.approx(-0.4)
    assert World().clearance(0.0, 0.0) == np.inf


def test_nearest_points_come_in_the_order_of_walls_and_obstacles():
    world = World(walls=[(0.0, -1.0, 4.0, -1.0)], obstacles=[(0.0, 2.0, 0.5)])
    assert world.nearest_points(1.0, 2.0).tolist() == [[1.0, -1.0], [0.5, 2.0]]


def test_the_house_has_five_rooms_that_a_robot_can_reach_through_the_doors():
    house, radius, step = World.rooms(), 0.18, 0.1
    reached, edge = {(0, 0)}, [(0, 0)]
    while edge:
        i, j = edge.pop()
        for place in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if place not in reached and house.clearance(place[0] * step, place[1] * step) > radius:
                reached.add(place)
                edge.append(place)
    rooms = {"hall": (-5, -1), "kitchen": (5, -2), "bedroom": (6, 1), "study": (-4, 2), "bath": (0, 2)}
    assert [name for name, (x, y) in rooms.items() if (x * 10, y * 10) not in reached] == []
    assert max(abs(i) for i, _ in reached) < 70
    assert max(abs(j) for _, j in reached) < 45


def test_a_robot_starts_in_the_house_by_default():
    assert Robot(World.rooms()).pose == (0.0, 0.0, 0.0)


def test_what_a_world_was_made_of_cannot_change_behind_its_back():
    with pytest.raises(ValueError, match="read-only"):
        World.rooms().walls[0, 0] = 1.0


@pytest.mark.parametrize(
    ("walls", "obstacles", "error", "text"),
    [
        ([(0, 0, 1)], (), ValueError, r"walls: expected rows of \(x1, y1, x2, y2\) in metres, got .* shape \(1, 3\)"),
        ([(0, 0, 1, 1), (0, 0)], (), ValueError, r"walls: expected rows of \(x1, y1, x2, y2\) in metres"),
        ((), [0, 0, 1], ValueError, r"obstacles: expected rows of \(x, y, radius\) in metres, got .* shape \(3,\)"),
        ([(0, 0, np.nan, 1)], (), ValueError, r"all finite, got \[0.0, 0.0, nan, 1.0\]"),
        ([(1, 2, 1, 2)], (), ValueError, r"walls\[0\]: expected two different ends, got \(1, 2\) twice"),
        ((), [(0, 0, 1), (0, 0, -1)], ValueError, r"obstacles\[1\]: expected a radius above 0 m, got -1"),
        (None, (), ValueError, r"walls: expected rows"),
        (
            [(0, 0, {}, 1)],
            (),
            TypeError,
            r"walls: expected rows of \(x1, y1, x2, y2\) in metres, got \[\(0, 0, {}, 1\)\]",
        ),
    ],
)
def test_a_world_that_cannot_be_is_refused(walls, obstacles, error, text):
    with pytest.raises(error, match=text):
        World(walls, obstacles)
