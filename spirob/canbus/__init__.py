"""The robot on a real CAN bus.

bus.py     a bus through python-can: opened, listened to without saying anything, and checked
robot.py   a robot with real drives, and its claim on the computer that runs its loop
"""

from spirob.canbus.bus import open_bus
from spirob.canbus.robot import CanRobot

__all__ = ["CanRobot", "open_bus"]
