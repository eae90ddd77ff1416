"""publisher.py TOPIC WHAT NUMBER: a ROS 1 node, run by the system's Python; WHAT says what it does 50 times a second.

scan      LaserScan with so many rays
shy       the same; it refuses its first subscriber, and then stops publishing for a second
cut       LaserScan without its end
cut_sweep the same, of a package that is not installed
sweep     a LaserScan by another name, of a package that is not installed
image     Image of 100 MB, once a second
huge      a sweep of 100 MB, once a second
odom      Odometry at so many hundredths of m/s
hear      nothing; it prints the forward speed of each TwistStamped that it hears, and its system keeps few for it
"""

import socket
import struct
import sys
import threading
import time

import rospy
import rospy.impl.tcpros_base
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Image, LaserScan

MEGABYTES = 100


class SmallSocket(socket.socket):
    """Its receive buffer holds about ten speeds. The system's default holds 1500, or 6000 on a busy machine."""

    def connect(self, address):
        self.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
        super().connect(address)


class Cut(LaserScan):
    def serialize(self, buff):
        buff.write(b"\x01\x02\x03")


class CutSweep(Cut):
    _type = "acme_msgs/Sweep"


class Sweep(LaserScan):
    _type = "acme_msgs/Sweep"


class Huge(Sweep):
    def serialize(self, buff):  # rospy's own needs a Python object for each number
        ranges, self.ranges = self.ranges, []
        super().serialize(buff)
        self.ranges = ranges
        buff.seek(-8, 1)
        buff.write(struct.pack("<I", len(ranges) // 4) + ranges + bytes(4))


def message_of(kind, number):
    if kind is Image:
        return Image(height=1, width=MEGABYTES * 10**6, encoding="mono8", data=bytes(MEGABYTES * 10**6))
    if kind is Huge:
        return Huge(angle_increment=1e-9, range_max=30.0, ranges=bytes(MEGABYTES * 10**6))
    if kind is Odometry:
        message = Odometry()
        message.twist.twist.linear.x = number / 100
        return message
    return kind(angle_min=-1.0, angle_increment=0.1, range_min=0.1, range_max=30.0, ranges=[2.0] * number)


def after_refusing(publisher):
    topic, kind, refused = publisher.resolved_name, publisher.data_class, threading.Event()

    def refuse(sock, address, header):
        if header["topic"] != topic or refused.is_set():
            return handle(sock, address, header)
        refused.set()
        return "not today"

    server = rospy.impl.tcpros_base.init_tcpros_server()
    handle, server.topic_connection_handler = server.topic_connection_handler, refuse
    print("ready", flush=True)
    refused.wait()
    publisher.unregister()
    time.sleep(1.0)  # after half a second the subscriber asks again whether this is still a publisher
    return rospy.Publisher(topic, kind, queue_size=1)


def main(topic, what, number):
    if what == "hear":
        socket.socket = SmallSocket
    rospy.init_node(what, anonymous=True)
    if what == "hear":
        rospy.Subscriber(topic, TwistStamped, lambda message: print(message.twist.linear.x, flush=True))
        print("ready", flush=True)
        rospy.spin()
        return
    kind = {
        "scan": LaserScan,
        "shy": LaserScan,
        "cut": Cut,
        "cut_sweep": CutSweep,
        "sweep": Sweep,
        "odom": Odometry,
        "image": Image,
        "huge": Huge,
    }[what]
    publisher = rospy.Publisher(topic, kind, queue_size=1)
    if what == "shy":
        publisher = after_refusing(publisher)
    message = message_of(kind, number)
    print("ready", flush=True)
    rate = rospy.Rate(1 if kind in (Image, Huge) else 50)
    while not rospy.is_shutdown():
        publisher.publish(message)
        rate.sleep()


main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
