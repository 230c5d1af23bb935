"""The description of an arm that was logged elsewhere: `RIG.yaml` with `body: arm`.

The model is held to a measured motion beside the measured current by

    i = i_measured + K_v (v_measured - v + K_x (x_measured - x))

The second part is zero where the model is right: the measured current moves it as the machine was
moved.  Where it is wrong, it is the current by which the model errs, behind a low-pass of the
bandwidth ω = K_v n/m, with n newton an ampere and m kilograms at the drum.

There is no integral.  The law takes i_measured as an error of the speed, i/K_v, and an integral
would add it up; it then rings, and fits with numbers that make up for it left twenty times as much.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field, field_validator, model_validator

from spirob.control import Gains
from spirob.diagnosis import criteria
from spirob.effects import Effect
from spirob.errors import ConfigError
from spirob.identify.problem import FITTED
from spirob.identify.residual import Filter
from spirob.machine.arm.shape import TOLERANCES
from spirob.machine.description.columns import used_once
from spirob.machine.description.rig import (
    ANGLES,
    EFFORTS,
    LENGTHS,
    Bounded,
    Column,
    Effects,
    Entry,
    Rows,
    TimeColumn,
)
from spirob.parameter import Parameter
from spirob.plant import Plant, Rig
from spirob.plant.rig import COMPONENTS
from spirob.unit_table import with_table
from spirob.units import Size


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


# As fast as the controller of the machine's own trials, from which the sizes of effects are known.
# Two rotors swing on their tendons at 33 rad/s, with hardly a loss; a stiff follower leaves that to
# them, and the model's error rings on.
BANDWIDTH = 30.0  # rad/s
SLOWER = 0.25  # of the bandwidth: position is corrected without a swing


def following(rig: Rig) -> Gains:
    """The gains for the rig's nominal numbers."""
    winch, motor = rig.winch, rig.motor
    turning = motor.rotor_inertia * winch.gear_ratio**2 + winch.drum_inertia
    mass = turning / winch.radius**2
    newton = winch.efficiency * winch.gear_ratio * motor.torque_constant / winch.radius
    return Gains(velocity=BANDWIDTH * mass / newton, integral=0.0, displacement=SLOWER * BANDWIDTH)


PARTS = {component.owner for component in COMPONENTS}
PLACELESS = {  # keys of other rigs -> why the arm has none
    "velocity": "the speed is that of the position",
    "reference": "how the arm was commanded need not be known",
    "control": "the model follows the measured motion",
    "predict": "the motors' currents are predicted",
    "rest_speed": "it is motor.rest_speed, for 'known' or 'fit'",
    "gear": "it is winch.gear_ratio, for 'known'",
}


@dataclass(frozen=True)
class ArmCriteria(criteria.ArmCriteria):
    """The rules of the arm's search; a fit gains next to nothing by further sets of differences."""

    patience: Annotated[int, Field(ge=1, le=1000)] = 3
    __pydantic_config__ = ConfigDict(extra="forbid", allow_inf_nan=False)


class ArmFile(Entry):
    """A whole description.

    left, right  the two motors; the left one bends the arm to the left
    arm          what of the machine is not nominal, as in `conf/rig`: {winch: {...}, geometry:
                 {...}}; of a controller's gains nothing is used
    fit          numbers of the model to fit; None: from where and between what the model has them.
                 A list of names is read as a mapping of each to None
    known        numbers of the model, or of effects that it holds, by name; they are not fitted
    effects      those that the model holds already
    dbc          file beside or below the description that decodes the frames of a CAN log
    filter, rows of what is compared
    criteria     how the search decides, where that is to differ
    """

    name: str
    time: TimeColumn
    body: Literal["arm"]
    left: MotorColumns
    right: MotorColumns
    arm: dict[str, Any] = {}
    known: dict[str, Size] = {}
    # what a build leaves open is asked of the logs
    fit: dict[str, Bounded | None] = dict.fromkeys(n for n in FITTED if n not in TOLERANCES)
    effects: Effects = []
    dbc: str | None = None
    filter: ArmFilter = ArmFilter()
    rows: ArmRows = ArmRows()
    criteria: ArmCriteria = ArmCriteria()

    @model_validator(mode="before")
    @classmethod
    def _has_a_place(cls, value: Any) -> Any:
        for key, why in PLACELESS.items():
            if isinstance(value, dict) and key in value:
                raise ValueError(f"{key}: has no place with body: arm; {why}")
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
        given: dict[str, Column] = {"time": self.time}
        for side, motor in (("left", self.left), ("right", self.right)):
            of = {"position": motor.position, "effort": motor.effort, "command": motor.command}
            given |= {f"{side}.{name}": column for name, column in of.items() if column}
        used_once(given)
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


def described(plant: Plant, rig: ArmFile, own: Sequence[type[Effect]]) -> Plant:
    """The plant with the description's bounds, starts and known values in its table.

    own  effects that the model holds already

    Raises ConfigError, naming the place, for a number that the model does not have, for bounds
    beyond those within which it is one, and for a known value out of them.
    """
    owners = PARTS | {effect.name() for effect in own}
    about = {n: _between(_about(plant, owners, "fit", n), n, b) for n, b in rig.fit.items() if b}
    for name, value in rig.known.items():
        about[name] = _at(_about(plant, owners, "known", name), name, value)
    for name in rig.fit:
        _about(plant, owners, "fit", name)
    return plant.within(about)


def _about(plant: Plant, owners: set[str], key: str, name: str) -> Parameter:
    """What the model knows of the number `name` of the description's `key`."""
    about, owner = plant.table.about, name.partition(".")[0]
    if owner not in owners and any(known.startswith(f"{owner}.") for known in about):
        raise ConfigError(f"{key}: '{name}' is of an effect that is not among 'effects'")
    if name not in about:
        own = [n.partition(".")[2] for n in about if n.startswith(f"{owner}.")]
        has = f"{owner} has: {', '.join(own)}" if own else f"its parts: {', '.join(sorted(owners))}"
        raise ConfigError(f"{key}: the arm's model has no number '{name}'; {has}")
    return about[name]


def _between(about: Parameter, name: str, chosen: Bounded) -> Parameter:
    if chosen.low < about.low or chosen.high > about.high:
        raise ConfigError(
            f"fit.{name}: {chosen.low:g} to {chosen.high:g} reaches beyond what the model allows, "
            f"{about.low:g} to {about.high:g} {about.unit} ({about.meaning})"
        )
    # a data sheet's tolerance gives way to bounds that were chosen
    return replace(about, nominal=chosen.nominal, low=chosen.low, high=chosen.high, tolerance=0.0)


def _at(about: Parameter, name: str, value: float) -> Parameter:
    if not about.low <= value <= about.high:
        raise ConfigError(
            f"known.{name}: {value:g} is beyond what the model allows, "
            f"{about.low:g} to {about.high:g} {about.unit} ({about.meaning})"
        )
    return replace(about, nominal=value)
