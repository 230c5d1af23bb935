"""What stands between a controller and the drives on every command path.

limits.py        the numbers: current, slew, travel, speed, winding temperature, silence
motor.py         what a drive last said, in SI
command.py       a command brought within current and slew
watching.py      the reasons to stop, one function each
guard.py         the robot behind all of this: armed by hand, zero current first
interruption.py  Ctrl-C and SIGTERM as a stop between two cycles
"""

from spirob.safety.guard import GuardedRobot
from spirob.safety.interruption import interruptible
from spirob.safety.limits import Limits
from spirob.safety.stop import Stopped

__all__ = ["GuardedRobot", "Limits", "Stopped", "interruptible"]
