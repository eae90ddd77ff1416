"""Cells with messages, for the tests of their widget."""

from __future__ import annotations

IMU = """
from robowidgets import MessageWidget
from robowidgets.messages.decoding import store_of
from robowidgets.messages.channel import Channel
import numpy as np
def message(type_name, **fields):
    return store_of(Channel(0, "", type_name, "cdr", "", 0)).types[type_name](**fields)
def time(sec, nanosec=0):
    return message("builtin_interfaces/msg/Time", sec=sec, nanosec=nanosec)
def vector(x, y, z, kind="Vector3"):
    return message(f"geometry_msgs/msg/{kind}", x=x, y=y, z=z)
def header(frame_id, sec=1750000033, nanosec=197000000):
    return message("std_msgs/msg/Header", stamp=time(sec, nanosec), frame_id=frame_id)
def imu(z=-0.4702, nanosec=197000000):
    return message(
        "sensor_msgs/msg/Imu",
        header=header("imu_link", nanosec=nanosec),
        orientation=message("geometry_msgs/msg/Quaternion", x=0.0021, y=-0.0008, z=-0.8413, w=0.5406),
        orientation_covariance=np.diag([0.01, 0.01, 0.01]).ravel(),
        angular_velocity=vector(0.004, -0.011, z),
        angular_velocity_covariance=np.zeros(9),
        linear_acceleration=vector(0.2143, -0.0612, 9.8241234567890123),
        linear_acceleration_covariance=np.r_[-1.0, np.zeros(8)],
    )
imu_widget = MessageWidget(title="/imu")
imu_widget.update(imu())
imu_widget
"""
BATTERY = """
battery = MessageWidget(title="/battery")
battery.update(message(
    "sensor_msgs/msg/BatteryState", header=header("base_link"), voltage=np.float32(16.21), temperature=31.4,
    current=-1.84, charge=2.26, capacity=2.6, design_capacity=float("nan"), percentage=np.float32(0.867),
    power_supply_status=2, power_supply_health=1, power_supply_technology=3, present=True,
    cell_voltage=np.array([4.07, 4.05, 4.03, 4.06], np.float32), cell_temperature=np.empty(0, np.float32),
    location="", serial_number="B-17",
))
battery
"""
JOINTS = """
joints = MessageWidget(title="/joint_states")
def joint_state(left=410.62):
    nan = float("nan")
    return message(
        "sensor_msgs/msg/JointState", header=header(""),
        name=["wheel_left", "wheel_right", "pan", "tilt", "lift", "gripper"],
        position=np.array([left, 387.9, -0.35, 0.12, 0.18, 0.031]),
        velocity=np.array([8.06, 7.09, -0.41, 0, 0, nan]), effort=np.array([0.21, 0.34, 0.02, 0.11, 4.9, nan]),
    )
joints.update(joint_state(380.0))
joints.update(joint_state())
joints
"""
DIAGNOSTICS = """
def status(level, name, text, **values):
    pairs = [message("diagnostic_msgs/msg/KeyValue", key=key, value=value) for key, value in values.items()]
    return message("diagnostic_msgs/msg/DiagnosticStatus", level=level, name=name, message=text, hardware_id="",
                   values=pairs)
diagnostics = MessageWidget(title="/diagnostics")
diagnostics.update(message("diagnostic_msgs/msg/DiagnosticArray", header=header(""), status=[
    status(0, "motor left", "running", temperature="41.2", current="0.8"),
    status(1, "battery", "20 % left"),
    status(2, "lidar", "no data for 3 s", port="/dev/ttyUSB0"),
    status(3, "camera", "stale"),
]))
diagnostics
"""
LARGE_NUMBERS = """
large = MessageWidget(title="battery", fields=["percentage", "voltage", "power_supply_status", "present"])
large.update(battery.message)
large
"""
HOSTILE = """
hostile = MessageWidget(title="odd")
hostile.update({
    "<b>name</b>": "<img src=x onerror=alert(1)>", "nothing": None, "nan": float("nan"), "big": 2**60 + 1,
    "inf": float("-inf"), "text": "a" * 3_000_000, "flags": [True, False], "deep": {"er": {"still": {"x": 1}}},
    "ranges": np.r_[np.linspace(0.2, 5, 357), [np.nan, np.inf, np.nan]].astype(np.float32),
    "image": np.zeros(307200, np.uint8), "names": [f"n{i}" for i in range(100)],
    "many": {f"f{i}": i for i in range(2000)}, "list": [{"a": i} for i in range(50)],
})
hostile
"""
