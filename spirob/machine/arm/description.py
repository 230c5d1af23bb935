"""The description of an arm that was logged elsewhere: `RIG.yaml` with `body: arm`."""

from dataclasses import replace
from typing import Any, Literal

from pydantic import Field, field_validator, model_validator

from spirob.control.law import Gains
from spirob.identify.numbers import FITTED
from spirob.machine.rig import ANGLES, EFFORTS, LENGTHS, TIME_UNITS, Column, Entry
from spirob.plant import Rig

TIGHT = 3.0  # times the bandwidth of the machine's own controller
TIGHTER = {"velocity": 1, "integral": 2, "displacement": 1}  # gain -> power of that


class MotorColumns(Entry):
    """A motor of the arm: how far it has wound in, and its current.

    position  angle of the rotor, or length wound in;  effort  current, which pulls where positive
    """

    position: Column
    effort: Column

    @model_validator(mode="after")
    def _units(self) -> "MotorColumns":
        if self.position.unit not in LENGTHS | ANGLES:
            known = ", ".join(LENGTHS | ANGLES)
            raise ValueError(f"position.unit '{self.position.unit}'; known: {known}")
        if self.effort.unit not in EFFORTS["current"]:
            known = ", ".join(EFFORTS["current"])
            raise ValueError(f"effort.unit '{self.effort.unit}' is no current; known: {known}")
        return self


class ArmFilter(Entry):
    """The zero-phase low-pass that both sides of the residual pass, and the motion to follow.

    cutoff  [Hz]; above it a coarse encoder's steps or another controller's ringing are left out
    """

    cutoff: float = Field(default=30.0, ge=5.0, le=200.0)


class ArmFile(Entry):
    """A whole description.

    left, right  the two motors; the left one bends the arm to the left
    arm          numbers of the machine that are not nominal, as in `conf/rig`: {winch: {...}, ...}
    fit          numbers of the model to fit;  effects  those that it holds already
    filter       of what is compared
    """

    name: str
    time: Column
    body: Literal["arm"]
    left: MotorColumns
    right: MotorColumns
    arm: dict[str, Any] = {}
    fit: list[str] = Field(default=list(FITTED), min_length=1)
    effects: list[str] = []
    filter: ArmFilter = ArmFilter()

    @field_validator("time")
    @classmethod
    def _known_time(cls, value: Column) -> Column:
        if value.unit not in TIME_UNITS:
            raise ValueError(f"unit '{value.unit}'; known: {', '.join(TIME_UNITS)}")
        return value

    def motors(self) -> dict[str, MotorColumns]:
        """Both motors by name, in the order of the model."""
        return {"left": self.left, "right": self.right}

    def machine(self) -> Rig:
        """The machine, with a tight controller, as it only has to repeat a motion.

        Raises ConfigError where `arm` names what it does not have.
        """
        rig = Rig.from_mapping({"name": self.name, **self.arm})
        own = {name: float(getattr(rig.gains, name)) for name in Gains.parameters()}
        for name, power in TIGHTER.items():
            own[name] *= TIGHT**power
        return replace(rig, gains=Gains(**own))
