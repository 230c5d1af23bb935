"""The unified multi-dynamics model: motor electrics, motor and winch, and the MuJoCo arm."""

import mujoco

from spirob.plant.plant import Plant
from spirob.plant.records import Response
from spirob.plant.rig import Rig
from spirob.plant.session import Session

__all__ = ["Plant", "Response", "Rig", "Session"]

_log = mujoco.MjLogConfig.get()
_log.logto_file = False  # no MUJOCO_LOG.TXT where the program was started; the console still hears
_log.set()
