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
    command   the current that its drive was asked for; may be absent
    """

    position: Column
    effort: CurrentColumn
    command: Column | None = None

    @model_validator(mode="after")
    def _units(self) -> "MotorColumns":
        if self.position.unit not in LENGTHS | ANGLES:
            known = ", ".join(LENGTHS | ANGLES)
            raise ValueError(f"position.unit '{self.position.unit}'; known: {known}")
        for name, column in (("effort", self.effort), ("command", self.command)):
            if column is not None and column.unit not in EFFORTS["current"]:
                known = ", ".join(EFFORTS["current"])
                raise ValueError(f"{name}.unit '{column.unit}' is no current; known: {known}")
        return self

    def metres(self, machine: Rig) -> float:
        """Length wound in for one unit of position [m]."""
        unit = self.position.unit
        if unit in LENGTHS:
            return LENGTHS[unit]
        return ANGLES[unit] * machine.winch.radius / machine.winch.gear_ratio

    def amperes(self, column: Column) -> float:
        """Current for one unit of `effort` or `command` [A]."""
        return EFFORTS["current"][column.unit]
