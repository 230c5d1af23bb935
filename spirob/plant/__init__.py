"""The unified multi-dynamics model: motor electrics, motor and winch, and the MuJoCo arm."""

from spirob.plant.plant import Plant, Response, Session
from spirob.plant.rig import Rig

__all__ = ["Plant", "Response", "Rig", "Session"]
