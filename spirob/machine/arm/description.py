"""The description of an arm that was logged elsewhere: `RIG.yaml` with `body: arm`."""

from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

from pydantic import field_validator, model_validator

from spirob.given_number import Size
from spirob.identify.numbers import FITTED
from spirob.machine.arm.compared import ArmFilter, ArmRows
from spirob.machine.arm.following import following
from spirob.machine.arm.motors import MotorColumns
from spirob.machine.rig import TIME_UNITS, Bounded, Column, Effects, Entry
from spirob.plant import Rig
from spirob.plant.nominal import COMPONENTS
from spirob.unit_table import with_table

PARTS = {component.owner for component in COMPONENTS}
PLACELESS = {  # keys of other rigs -> why the arm has none
    "velocity": "the speed is that of the position",
    "reference": "how the arm was commanded need not be known",
    "control": "the model follows the measured motion",
    "predict": "the motors' currents are predicted",
    "rest_speed": "it is motor.rest_speed, for 'known' or 'fit'",
    "gear": "it is winch.gear_ratio, for 'known'",
}


class ArmFile(Entry):
    """A whole description.

    left, right  the two motors; the left one bends the arm to the left
    arm          what of the machine is not nominal, as in `conf/rig`: {winch: {...}, geometry:
                 {...}}; of a controller's gains nothing is used
    fit          numbers of the model to fit; None: from where and between what the model has them.
                 A list of names is read as a mapping of each to None
    known        numbers of the model, or of effects that it holds, by name; they are not fitted
    effects      those that the model holds already
    dbc          file beside the description that decodes the frames of a CAN log
    filter, rows of what is compared
    """

    name: str
    time: Column
    body: Literal["arm"]
    left: MotorColumns
    right: MotorColumns
    arm: dict[str, Any] = {}
    known: dict[str, Size] = {}
    fit: dict[str, Bounded | None] = dict.fromkeys(FITTED)
    effects: Effects = []
    dbc: str | None = None
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

    def columns(self) -> list[str]:
        """Names of the columns that the description needs."""
        motors = [c for m in self.motors().values() for c in (m.position, m.effort, m.command)]
        return [column.column for column in (self.time, *motors) if column is not None]

    def moving_columns(self) -> list[str]:
        """Those that say what the machine did, whatever the time."""
        return self.columns()[1:]

    def motors(self) -> dict[str, MotorColumns]:
        """Both motors by name, in the order of the model."""
        return {"left": self.left, "right": self.right}

    def beside(self, folder: Path) -> "ArmFile":
        """The same with the table of its arm's units read, where it names one in this folder."""
        geometry = self.arm.get("geometry")
        if not isinstance(geometry, dict):
            return self
        arm = {**self.arm, "geometry": with_table(geometry, folder)}
        return self.model_copy(update={"arm": arm})

    def machine(self) -> Rig:
        """The machine, with a controller that follows a motion.

        Raises ConfigError where `arm` or `known` names what it does not have, or a value is out of
        its range.
        """
        rig = Rig.from_mapping({"name": self.name, **self.arm, **self._known_parts()})
        return replace(rig, gains=following(rig))

    def _known_parts(self) -> dict[str, Any]:
        """The parts of the machine of which numbers are known, with what `arm` says of them."""
        found: dict[str, Any] = {}
        for name, value in self.known.items():
            part, _, number = name.partition(".")
            if part in PARTS:  # others are effects, which the machine does not have
                found.setdefault(part, dict(self.arm.get(part, {})))[number] = value
        return found
