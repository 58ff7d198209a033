"""Recorded trials in the formats of other programs: Foxglove, Minari, ROS 2."""
