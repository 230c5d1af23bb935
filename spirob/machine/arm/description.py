"""The description of an arm that was logged elsewhere: `RIG.yaml` with `body: arm`."""

from dataclasses import replace
from typing import Any, Literal

from pydantic import Field, field_validator, model_validator

from spirob.control.law import Gains
from spirob.identify.numbers import FITTED
from spirob.identify.residual import Filter
from spirob.machine.rig import ANGLES, EFFORTS, LENGTHS, TIME_UNITS, Bounded, Column, Entry, Rows
from spirob.plant import Rig
from spirob.plant.nominal import COMPONENTS

PARTS = {component.owner for component in COMPONENTS}
PLACELESS = {  # keys of other rigs -> why the arm has none
    "velocity": "the speed is that of the position",
    "reference": "how the arm was commanded need not be known",
    "control": "the model follows the measured motion",
    "predict": "the motors' currents are predicted",
    "rest_speed": "it is motor.rest_speed, for 'known' or 'fit'",
    "gear": "it is winch.gear_ratio, for 'known'",
}
TIGHT = 3.0  # times the bandwidth of the machine's own controller
TIGHTER = {"velocity": 1, "integral": 2, "displacement": 1}  # gain -> power of that


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


class ArmFilter(Entry):
    """The zero-phase low-pass that both sides of the residual pass, and the motion to follow.

    cutoff    [Hz]; above it a coarse encoder's steps or another controller's ringing are left out
    decimate  every n-th cycle of the model, 1 ms each, is compared
    drop      cycles left out at both ends of a log, where the filter has no neighbours
    """

    cutoff: float = Field(default=30.0, ge=5.0, le=200.0)
    decimate: int = Field(default=Filter.every, ge=1)
    drop: int = Field(default=0, ge=0)

    @model_validator(mode="after")
    def _often_enough(self) -> "ArmFilter":
        most = int(0.5e3 / self.cutoff)
        if "decimate" in self.model_fields_set and self.decimate > most:
            raise ValueError(
                f"decimate: {self.decimate} cycles of 1 ms are too far apart for a cutoff of "
                f"{self.cutoff:g} Hz; {most} at most"
            )
        return self


class ArmRows(Rows):
    """Rows that are left out of what is compared; a log is played whole.

    minimum_speed, maximum_speed  of the motor that does the work, in its unit of position a second
    standstill  "keep", other than for an axis: the arm's stiffness, and what creeps or winds up,
                show in holds, and a dry friction of the model remembers where it came from
    """

    standstill: Literal["drop", "keep"] = "keep"


class ArmFile(Entry):
    """A whole description.

    left, right  the two motors; the left one bends the arm to the left
    arm          numbers of the machine that are not nominal, as in `conf/rig`: {winch: {...}, ...}
    fit          numbers of the model to fit; None: from where and between what the model has them.
                 A list of names is read as a mapping of each to None
    known        numbers of the model, or of effects that it holds, by name; they are not fitted
    effects      those that the model holds already
    filter, rows of what is compared
    """

    name: str
    time: Column
    body: Literal["arm"]
    left: MotorColumns
    right: MotorColumns
    arm: dict[str, Any] = {}
    known: dict[str, float] = {}
    fit: dict[str, Bounded | None] = dict.fromkeys(FITTED)
    effects: list[str] = []
    filter: ArmFilter = ArmFilter()
    rows: ArmRows = ArmRows()

    @model_validator(mode="before")
    @classmethod
    def _has_a_place(cls, value: Any) -> Any:
        for key, why in PLACELESS.items():
            if isinstance(value, dict) and key in value:
                raise ValueError(f"{key}: has no place with body: arm; {why}")
        return value

    @field_validator("time")
    @classmethod
    def _known_time(cls, value: Column) -> Column:
        if value.unit not in TIME_UNITS:
            raise ValueError(f"unit '{value.unit}'; known: {', '.join(TIME_UNITS)}")
        return value

    @field_validator("arm")
    @classmethod
    def _mappings(cls, value: dict[str, Any]) -> dict[str, Any]:
        for part, numbers in value.items():
            if part in PARTS and not isinstance(numbers, dict):
                raise ValueError(f"{part}: a mapping of its numbers, got {numbers!r}")
        return value

    @field_validator("fit", mode="before")
    @classmethod
    def _by_name(cls, value: Any) -> Any:
        if isinstance(value, list):
            if not all(isinstance(name, str) for name in value):
                raise ValueError("a list of names, or a mapping: name -> {nominal, low, high}")
            value = dict.fromkeys(value)
        if isinstance(value, dict) and not value:
            raise ValueError("name at least one number to fit, such as winch.efficiency")
        return value

    @model_validator(mode="after")
    def _known_once(self) -> "ArmFile":
        twice = sorted(set(self.known) & set(self.fit))
        if twice and "fit" in self.model_fields_set:
            raise ValueError(f"{', '.join(twice)}: either known or fitted")
        if not self.fitted():
            raise ValueError("known: nothing is left to fit")
        for name in self.known:
            part, _, number = name.partition(".")
            if number in self.arm.get(part, {}):
                raise ValueError(f"{name}: either in 'known' or in 'arm'")
        return self

    def fitted(self) -> dict[str, Bounded | None]:
        """What is fitted: those of `fit`, of which the usual ones give way to what is known."""
        return {name: bounds for name, bounds in self.fit.items() if name not in self.known}

    def motors(self) -> dict[str, MotorColumns]:
        """Both motors by name, in the order of the model."""
        return {"left": self.left, "right": self.right}

    def machine(self) -> Rig:
        """The machine, with a tight controller, as it only has to repeat a motion.

        Raises ConfigError where `arm` or `known` names what it does not have, or a value is out of
        its range.
        """
        rig = Rig.from_mapping({"name": self.name, **self.arm, **self._known_parts()})
        own = {name: float(getattr(rig.gains, name)) for name in Gains.parameters()}
        for name, power in TIGHTER.items():
            own[name] *= TIGHT**power
        return replace(rig, gains=Gains(**own))

    def _known_parts(self) -> dict[str, Any]:
        """The parts of the machine of which numbers are known, with what `arm` says of them."""
        found: dict[str, Any] = {}
        for name, value in self.known.items():
            part, _, number = name.partition(".")
            if part in PARTS:  # others are effects, which the machine does not have
                found.setdefault(part, dict(self.arm.get(part, {})))[number] = value
        return found
