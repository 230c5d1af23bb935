"""The robot on a real CAN bus."""

from spirob.canbus.bus import open_bus
from spirob.canbus.robot import CanRobot

__all__ = ["CanRobot", "open_bus"]
