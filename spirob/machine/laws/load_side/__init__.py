"""Laws of an axis whose position sensor sits at the load, behind gear and shaft.

What the sensor tells is the motor's position less the twist between them: an error of its reading
that follows the load.  The effort is the motor's, which moves its own share of the inertia with
the twist's acceleration.
"""

from spirob.machine.laws.load_side.backlash import Backlash
from spirob.machine.laws.load_side.gear_compliance import GearCompliance

__all__ = ["Backlash", "GearCompliance"]
