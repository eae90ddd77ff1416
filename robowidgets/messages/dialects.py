"""The messages of touch sensors: one row per dialect, tried from top to bottom.

Sources: the message definitions of kobuki_msgs, create_msgs, ca_msgs, irobot_create_msgs, turtlebot3_msgs,
neato2_interfaces, neato_node (ROS 1), gazebo_msgs, ros_gz_interfaces, std_msgs and sensor_msgs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any, NamedTuple

from ..samples import TouchMode
from ..samples.checks import number
from ._codes import bits, code, flag, integer, is_flag
from .fields import MISSING, describe, get, has

Sensor = str | tuple[str, str]
"""A sensor's name, or the two sides of a contact. The message does not say which side is the robot's."""

Said = Mapping[Any, bool | None]
"""`Sensor` to True (touched), False (free) or None (the source does not know)."""


class Dialect(NamedTuple):
    """One way to report touches.

    A new one also needs its definition in `definitions/`, unless rosbags has it, and a line in docs/touch.md and in
    docs/every_topic.md. Names of sensors have spaces: ``front left``. A mapping of names to flags may have any names,
    so a message of flags fits only if the dialect knows all its fields; see `_with`.

    ``types``: the message types, such as ``create_msgs/Bumper``; empty for plain mappings.
    ``fits``: returns True if a message is of this dialect, by its fields: dictionaries have no type.
    ``mode``: see `TouchMode`.
    ``sensors``: the sensors of such a robot, from its left to its right, if the dialect fixes them.
    ``read``: returns the states in a message, or raises ValueError for a number without a meaning and TypeError for a
    field of a wrong type.
    ``of_contacts``: True if messages name the two sides of contacts instead of sensors.
    """

    types: tuple[str, ...]
    fits: Callable[[Any], bool]
    mode: TouchMode
    sensors: tuple[str, ...]
    read: Callable[[Any], Said]
    of_contacts: bool = False


def _with(*names: str, more: Iterable[str] = ()) -> Callable[[Any], bool]:
    """Return a function that returns True if a message has fields.

    A plain mapping of sensors may use the same words: then it has other names, too, or unknown states.
    """
    fields = {*names, *more}

    def is_mapping_of_sensors(message: Any) -> bool:
        return _is_plain(message) and (not message.keys() <= fields or None in message.values())

    return lambda message: has(message, *names) and not is_mapping_of_sensors(message)


def _is_plain(message: Any) -> bool:
    return isinstance(message, Mapping) and bool(message) and all(v is None or is_flag(v) for v in message.values())


def _is_bool(message: Any) -> bool:
    return _with("data")(message) and is_flag(get(message, "data"))


_BUMPERS = ("left", "center", "right")
_CLIFFS = ("cliff left", "cliff center", "cliff right")
_WHEELS = ("wheel left", "wheel right")
_BUTTONS = ("button 0", "button 1", "button 2")
_PRESS = ("released", "pressed")
_LIGHTS = ("left", "front left", "center left", "center right", "front right", "right")
_CREATE = {"left": "is_left_pressed", "right": "is_right_pressed"} | {
    f"light {place}": f"is_light_{place.replace(' ', '_')}" for place in _LIGHTS
}
_CREATE_CLIFFS = {f"cliff {place}": f"is_cliff_{place.replace(' ', '_')}" for place in _LIGHTS if "center" not in place}
_CREATE_WHEELS = {f"wheel {side}": f"is_{side}_dropped" for side in ("left", "right")}
_NEATO = {place: place.replace(" ", "_") for place in ("left side", "left front", "right front", "right side")}
_NEATO_ROS1 = dict(zip(_NEATO, ("leftSide", "leftFront", "rightFront", "rightSide"), strict=True))


def _flags(message: Any, names: Mapping[str, str]) -> Said:
    return {sensor: flag(message, name) for sensor, name in names.items() if has(message, name)}


def _neato(message: Any, names: Mapping[str, str]) -> Said:
    return {sensor: code(message, name, _PRESS) == 1 for sensor, name in names.items()}


def _event(message: Any, which: str, sensors: tuple[str, ...], states: tuple[str, str]) -> Said:
    return {sensors[code(message, which, sensors)]: code(message, "state", states) == 1}


def _kobuki(message: Any) -> Said:
    # Bits count from the right here, but from the left in the events of the same robot.
    return (
        bits(message, "bumper", {4: "left", 2: "center", 1: "right"})
        | bits(message, "cliff", {4: "cliff left", 2: "cliff center", 1: "cliff right"})
        | bits(message, "wheel_drop", {2: "wheel left", 1: "wheel right"})
    )


def _turtlebot3(message: Any) -> Said:
    # `cliff` is a float here, the raw reading of an infrared sensor: without a threshold it is not a touch.
    return bits(message, "bumper", {1: "front", 2: "back"})


_HAZARDS = {1: "bump", 2: "cliff", 4: "wheel"}
"""The hazards that a sensor at the body feels. The backup limit, a stall and proximity are not touches."""
_FRAME_STARTS = {"bump": "bump_", "cliff": "cliff_", "wheel": "wheel_drop_"}
_CREATE3 = (
    *("left", "front left", "front center", "front right", "right"),
    *("cliff side left", "cliff front left", "cliff front right", "cliff side right"),
    *_WHEELS,
)


def _hazards(message: Any) -> Said:
    names = (_hazard(f"detections[{i}]", d) for i, d in enumerate(_items(message, "detections")))
    return {name: True for name in names if name}


def _hazard(where: str, detection: Any) -> str:
    """Return the name of the sensor that felt a hazard, or an empty text if it is not a touch."""
    frame = get(detection, "header.frame_id")
    if frame is MISSING or not has(detection, "type"):
        raise TypeError(f"{where}: expected a hazard with header.frame_id and type, got {describe(detection)}")
    kind = _HAZARDS.get(integer(detection, "type"))
    if kind is None:
        return ""
    start = _FRAME_STARTS[kind]
    place = "" if frame == "base_link" else str(frame).removeprefix(start).replace("_", " ")
    return place if kind == "bump" and str(frame).startswith(start) else f"{kind} {place}".strip()


def _contacts(message: Any, items: str, first: str, second: str) -> Said:
    said = {}
    for i, contact in enumerate(_items(message, items)):
        sides = get(contact, first), get(contact, second)
        if not all(isinstance(side, str) and side for side in sides):
            raise TypeError(f"{items}[{i}]: expected a contact with {first} and {second}, got {describe(contact)}")
        said[sides] = True
    return said


def _items(message: Any, name: str) -> list[Any]:
    value = get(message, name)
    try:
        return list(value)
    except TypeError:
        raise TypeError(f"{name}: expected a list, got {value!r}") from None


def _range(message: Any) -> Said:
    low, high = (number(name, get(message, name)) for name in ("min_range", "max_range"))
    if low != high:
        raise ValueError(
            "min_range: expected the same as max_range, because only such a Range is a touch sensor; "
            f"got {low:g} and {high:g} m (a sensor that measures distance)"
        )
    value = get(message, "range")
    sensor = str(get(message, "header.frame_id", "")) or "touch"
    # JSON turns both infinities into null, so the value that was sent is unknown.
    return {sensor: None if value is None else {float("-inf"): True, float("inf"): False}.get(number("range", value))}


_KOBUKI = ("kobuki_msgs", "kobuki_ros_interfaces")


def _kobuki_event(name: str, which: str, sensors: tuple[str, ...], states: tuple[str, str]) -> Dialect:
    return Dialect(
        types=tuple(f"{package}/{name}" for package in _KOBUKI),
        fits=_with(which, "state"),
        mode=TouchMode.EVENT,
        sensors=sensors,
        read=partial(_event, which=which, sensors=sensors, states=states),
    )


def _contact_list(types: tuple[str, ...], items: str, first: str, second: str) -> Dialect:
    read = partial(_contacts, items=items, first=first, second=second)
    return Dialect(types, _with(items), TouchMode.PRESENCE, (), read, of_contacts=True)


def _flag_levels(types: tuple[str, ...], names: Mapping[str, str]) -> Dialect:
    read = partial(_flags, names=names)
    return Dialect(types, _with(*names.values()), TouchMode.LEVEL, tuple(names), read)


def _neato_bump(type_name: str, names: Mapping[str, str]) -> Dialect:
    read = partial(_neato, names=names)
    return Dialect((type_name,), _with(*names.values()), TouchMode.LEVEL, tuple(names), read)


_LEVEL, _PRESENCE = TouchMode.LEVEL, TouchMode.PRESENCE

DIALECTS = (
    # These have True and False, like a plain mapping of names, so they come before it. The others have numbers.
    Dialect(
        types=("create_msgs/Bumper", "ca_msgs/Bumper"),
        fits=_with("is_left_pressed", "is_right_pressed", more=_CREATE.values()),
        mode=_LEVEL,
        sensors=(),  # a Create 1 has no light sensors
        read=partial(_flags, names=_CREATE),
    ),
    _flag_levels(("create_msgs/Cliff", "ca_msgs/Cliff"), _CREATE_CLIFFS),
    _flag_levels(("ca_msgs/Wheeldrop",), _CREATE_WHEELS),
    Dialect(("std_msgs/Bool",), _is_bool, _LEVEL, (), lambda m: {"touch": flag(m, "data")}),
    _neato_bump("neato2_interfaces/Bump", _NEATO),
    _neato_bump("neato_node/Bump", _NEATO_ROS1),
    Dialect((), _is_plain, _LEVEL, (), lambda message: message),
    _kobuki_event("BumperEvent", "bumper", _BUMPERS, _PRESS),
    _kobuki_event("CliffEvent", "sensor", _CLIFFS, ("floor", "cliff")),
    _kobuki_event("WheelDropEvent", "wheel", _WHEELS, ("raised", "dropped")),
    _kobuki_event("ButtonEvent", "button", _BUTTONS, _PRESS),
    Dialect(
        tuple(f"{package}/SensorState" for package in _KOBUKI),
        _with("bumper", "cliff", "wheel_drop"),
        _LEVEL,
        (*_BUMPERS, *_CLIFFS, *_WHEELS),
        _kobuki,
    ),
    Dialect(("turtlebot3_msgs/SensorState",), _with("bumper", "cliff"), _LEVEL, ("front", "back"), _turtlebot3),
    Dialect(("irobot_create_msgs/HazardDetectionVector",), _with("detections"), _PRESENCE, _CREATE3, _hazards),
    _contact_list(("gazebo_msgs/ContactsState",), "states", "collision1_name", "collision2_name"),
    _contact_list(
        ("ros_gz_interfaces/Contacts", "ros_ign_interfaces/Contacts"), "contacts", "collision1.name", "collision2.name"
    ),
    Dialect(("sensor_msgs/Range",), _with("range", "min_range", "max_range"), _LEVEL, (), _range),
)
