"""What stands between a controller and the drives on every command path.

limits.py  the numbers: current, slew, travel, speed, winding temperature, silence; a command
           brought within current and slew; reasons to stop, one function each; Ctrl-C and SIGTERM
           between two cycles
motor.py   what a drive last said, in SI
guard.py   the robot behind all of this: armed by hand, zero current first
"""

from spirob.safety.guard import GuardedRobot
from spirob.safety.limits import Limits, Stopped, interruptible

__all__ = ["GuardedRobot", "Limits", "Stopped", "interruptible"]
