#!/usr/bin/env bash
# Provides ROS 1 for its tests if the system has packages of it. Otherwise these tests are skipped.
set -euo pipefail
if /usr/bin/python3 -c 'import geometry_msgs.msg, nav_msgs.msg, rosmaster, rospy, sensor_msgs.msg' 2>/dev/null; then
  exit 0
fi
if ! command -v apt-get >/dev/null; then
  echo "No ROS 1 packages for this system: the tests of feeds.ros1 are skipped." >&2
  exit 0
fi
if [ "$(id -u)" != 0 ]; then
  echo "The tests of feeds.ros1 are skipped. To run them: sudo scripts/ros1.sh" >&2
  exit 0
fi
scripts/apt.sh "ROS 1" python3-rospy python3-rosmaster python3-sensor-msgs python3-geometry-msgs python3-nav-msgs
