"""The columns of the arm's two motors, and their units."""

from pydantic import Field, model_validator

from spirob.machine.rig import ANGLES, EFFORTS, LENGTHS, Column, Entry
from spirob.plant import Rig


class CurrentColumn(Column):
    """A motor's current.

    limit  size at which its drive saturates, in `unit`; rows beyond 98 % of it are left out
    """

    limit: float | None = Field(default=None, gt=0)


class MotorColumns(Entry):
    """A motor of the arm: how far it has wound in, and its current.

    position  angle of the rotor, or length wound in;  effort  current, which pulls where positive
    """

    position: Column
    effort: CurrentColumn

    @model_validator(mode="after")
    def _units(self) -> "MotorColumns":
        if self.position.unit not in LENGTHS | ANGLES:
            known = ", ".join(LENGTHS | ANGLES)
            raise ValueError(f"position.unit '{self.position.unit}'; known: {known}")
        if self.effort.unit not in EFFORTS["current"]:
            known = ", ".join(EFFORTS["current"])
            raise ValueError(f"effort.unit '{self.effort.unit}' is no current; known: {known}")
        return self

    def metres(self, machine: Rig) -> float:
        """Length wound in for one unit of position [m]."""
        unit = self.position.unit
        if unit in LENGTHS:
            return LENGTHS[unit]
        return ANGLES[unit] * machine.winch.radius / machine.winch.gear_ratio

    @property
    def amperes(self) -> float:
        """Current for one unit of effort [A]."""
        return EFFORTS["current"][self.effort.unit]
