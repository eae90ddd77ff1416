"""publisher.py TOPIC WHAT NUMBER: a ROS 1 node, run by the system's Python; WHAT says what it does 50 times a second.

scan      LaserScan with so many rays
cut       LaserScan of which the end is missing
cut_sweep the same, of a package that is not installed
sweep     a LaserScan by another name, of a package that is not installed
odom      Odometry at so many hundredths of m/s
hear      nothing; it prints the forward speed of each TwistStamped that it hears
"""

import sys

import rospy
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan


class Cut(LaserScan):
    def serialize(self, buff):
        buff.write(b"\x01\x02\x03")


class CutSweep(Cut):
    _type = "acme_msgs/Sweep"


class Sweep(LaserScan):
    _type = "acme_msgs/Sweep"


def message_of(kind, number):
    if kind is Odometry:
        message = Odometry()
        message.twist.twist.linear.x = number / 100
        return message
    return kind(angle_min=-1.0, angle_increment=0.1, range_min=0.1, range_max=30.0, ranges=[2.0] * number)


def main(topic, what, number):
    rospy.init_node(what, anonymous=True)
    if what == "hear":
        rospy.Subscriber(topic, TwistStamped, lambda message: print(message.twist.linear.x, flush=True))
        print("ready", flush=True)
        rospy.spin()
        return
    kind = {"scan": LaserScan, "cut": Cut, "cut_sweep": CutSweep, "sweep": Sweep, "odom": Odometry}[what]
    publisher = rospy.Publisher(topic, kind, queue_size=1)
    message = message_of(kind, number)
    print("ready", flush=True)
    rate = rospy.Rate(50)
    while not rospy.is_shutdown():
        publisher.publish(message)
        rate.sleep()


main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
