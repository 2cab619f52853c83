"""Robots that somebody described for a simulator, URDF and MJCF, as descriptions."""

from mbsym.source.robots.convert import Converted, convert, is_robot
