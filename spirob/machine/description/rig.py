"""The description of a machine that nobody here has seen: `RIG.yaml`, read by `loading`.

Which columns (`columns`), which numbers are known and which are fitted, the body behind the motor,
filters and the rows that are left out.  Data, never code; an unknown key is an error that says
where it stands.
"""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from spirob.diagnosis.criteria import Criteria
from spirob.machine.description.columns import (
    ANGLES,
    EFFORTS,
    LENGTHS,
    TICK,
    TIME_UNITS,
    Column,
    EffortColumn,
    Entry,
    MotionColumn,
    Once,
    PositionColumn,
    TimeColumn,
    used_once,
)
from spirob.machine.description.controller import Control
from spirob.units import Size, units_of

__all__ = [
    "ANGLES",
    "EFFORTS",
    "LENGTHS",
    "TIME_UNITS",
    "Body",
    "Bounded",
    "Column",
    "Control",
    "Entry",
    "FilterSettings",
    "RigFile",
    "Rows",
]

STEP = 1.5e-8  # of a range, that a fit takes at least: the root of a number's last digit
MOST_EFFECTS = 100  # named in a description


class Bounded(Entry):
    """A number to fit: where to start, and between which bounds."""

    nominal: float
    low: float
    high: float

    @model_validator(mode="after")
    def _ordered(self) -> "Bounded":
        if not self.low <= self.nominal <= self.high or self.low == self.high:
            raise ValueError(
                f"needs low ≤ nominal ≤ high, got {self.low}, {self.nominal}, {self.high}"
            )
        return self


class Body(Entry):
    """A body in MuJoCo's format behind the motor.

    mjcf    file, beside or below the description
    joint or tendon  what the motor drives
    joints  columns of the other joints, where there are any
    tip     site or body that would carry a payload
    """

    mjcf: str
    joint: str | None = None
    tendon: str | None = None
    joints: dict[str, Column] = {}
    tip: str | None = None

    @model_validator(mode="after")
    def _one_drive(self) -> "Body":
        if (self.joint is None) == (self.tendon is None):
            raise ValueError("name either the driven joint or the driven tendon")
        return self


class FilterSettings(Entry):
    """Filter and thinning, alike for motion, effort and model.

    cutoff    of the zero-phase Butterworth filter of 4th order [Hz]; absent: from the sample rate
    decimate  keep every n-th sample afterwards; absent: about six times the cutoff
    drop      samples left out at both ends, where the filter has no neighbours; absent: six periods
              of the cutoff, or a twentieth of the piece, at least 2.5 periods
    """

    cutoff: float | None = Field(default=None, gt=0)
    decimate: int | None = Field(default=None, ge=1)
    drop: int | None = Field(default=None, ge=0)


class Rows(Entry):
    """Rows that are left out.

    minimum_speed  slower rows, in the unit of position per second: at standstill dry friction may
                   take any value below its level, and says nothing about it
    standstill     what happens to holds of a tenth of a second or more, where no minimum speed is
                   given: "drop" or "keep"
    """

    minimum_speed: float | None = Field(default=None, ge=0)
    maximum_speed: float | None = Field(default=None, gt=0)
    standstill: Literal["drop", "keep"] = "drop"


class OwnNumbers(Entry):
    """Numbers of one log alone.

    offset   effort that this log needs more than others, in SI
    payload  mass or moment that the axis carries in it, in any unit that all logs share; with a
             body that has a tip in kg
    zero     position, as this log reads it, in SI, that counts as 0, like that of a column
    """

    offset: float | None = None
    payload: float | None = Field(default=None, ge=0)
    zero: float | None = None


NUMBERS = {
    "inertia": "inertia or mass that the motor moves",
    "viscous": "friction in proportion to speed",
    "stiffness": "spring that pulls towards position 0",
    "scale": "torque or force for one unit of effort",
    "delay": "time by which the effort trails the motion in the log",
    "back_emf": "voltage for one unit of speed, which the turning motor sets against its supply",
    "payload_inertia": "inertia or mass that a payload of 1 adds",
    "payload_cosine": "effort for a payload of 1 at position 0, or anywhere on a slide",
    "payload_sine": "effort for a payload of 1 at a quarter turn from position 0",
}
NEVER_NEGATIVE = ("inertia", "viscous", "scale", "back_emf", "payload_inertia")
PER_LOG = {
    "offset": "effort that this log needs more than others",
    "payload": "what the axis carries in this log",
    "zero": "position, as this log reads it, that counts as 0",
}


Effects = Annotated[list[str], Field(max_length=MOST_EFFECTS), Once]


class RigFile(Entry):
    """A whole description; `spirob.machine.loading.load_rig` reads it.

    position    may be absent where `velocity` is there: then no effect of position can be told
    per_log     numbers that each log has for itself, to fit; None: found out, [] for none
    logs        name of a log -> its own numbers, where they are known
    predict     what the user wants predicted; effects are named in the effort in any case, because
                a controller hides in the motion what its effort shows
    rest_speed  scale of the smooth sign of dry friction, in the unit of position per second;
                absent: 1 % of the fastest tenth of the motion
    gear        radians of the motor for one radian, or one metre, of position; absent: 1, or one
                turn over the whole stroke
    effects     what the model holds already; a name that ends in .py is a file of the user's own
    dbc         file beside or below the description that decodes the frames of a log of a CAN bus
    criteria    how the search decides, where that is to differ
    """

    name: str
    time: TimeColumn
    position: PositionColumn | None = None
    velocity: MotionColumn | None = None
    effort: EffortColumn
    reference: MotionColumn | None = None
    predict: Literal["effort", "motion", "closed_loop"] = "effort"
    control: Control | None = None
    known: dict[str, Size] = {}
    fit: dict[str, Bounded] = {}
    per_log: Annotated[tuple[Literal["offset", "payload", "zero"], ...], Once] | None = None
    logs: dict[str, OwnNumbers] = {}
    body: Body | Literal["none"] = "none"
    filter: FilterSettings = FilterSettings()
    rows: Rows = Rows()
    rest_speed: float | None = Field(default=None, gt=0)
    gear: float | None = Field(default=None, gt=0)
    effects: Effects = []
    dbc: str | None = None
    criteria: Criteria = Criteria()

    @field_validator("known", "fit")
    @classmethod
    def _known_names(cls, value: dict[str, Any]) -> dict[str, Any]:
        for name, one in value.items():
            if name not in NUMBERS:
                raise ValueError(f"no number '{name}'; a rig has: {', '.join(NUMBERS)}")
            begin = one.nominal if isinstance(one, Bounded) else one
            if name == "scale" and begin == 0.0:
                raise ValueError("scale: at 0 no effort makes a torque")
            if name in NEVER_NEGATIVE and begin < 0.0:
                why = "effort.factor: -1 turns the sign" if name == "scale" else "no machine has it"
                raise ValueError(f"{name}: {begin:g} is less than 0; {why}")
            if isinstance(one, Bounded) and 0.0 < abs(one.nominal) < STEP * (one.high - one.low):
                raise ValueError(
                    f"{name}: bounds {1 / STEP:.1g} times as wide as its nominal value of "
                    f"{one.nominal:g} hide it; give narrower ones"
                )
        return value

    def channels(self) -> dict[str, Column]:
        """The columns that are needed, by what they are: time, position, effort, `joint ...`."""
        found: dict[str, Column] = {"time": self.time}
        single = {"position": self.position, "velocity": self.velocity, "reference": self.reference}
        found |= {key: column for key, column in single.items() if column is not None}
        if self.effort.source == "column":
            found["effort"] = self.effort
        if isinstance(self.effort.supply, Column):
            found["supply"] = self.effort.supply
        if not isinstance(self.body, str):
            found |= {f"joint {name}": column for name, column in self.body.joints.items()}
        return found

    def columns(self) -> list[str]:
        """Names of the columns that are needed."""
        return [column.column for column in self.channels().values()]

    def moving_columns(self) -> list[str]:
        """Those that say what the machine did, whatever the time."""
        return [column.column for key, column in self.channels().items() if key != "time"]

    @property
    def motion(self) -> MotionColumn:
        """The column that the motion is taken from: the position, or the velocity alone."""
        column = self.position or self.velocity
        assert column is not None
        return column

    @property
    def axis(self) -> str:
        """What positions are measured in inside: rad or m."""
        return self.motion.si.removesuffix("/s")

    @property
    def angular(self) -> bool:
        """Whether the axis turns."""
        return self.axis == "rad"

    @property
    def speed_scale(self) -> float:
        """SI for one unit of position per second, or of velocity where there is no position."""
        return self.motion.scale

    @model_validator(mode="before")
    @classmethod
    def _one_encoder(cls, given: Any) -> Any:
        """A speed in ticks is counted by the encoder of the position, where it names none."""
        position, speed = (
            (given.get(key) if isinstance(given, Mapping) else None)
            for key in ("position", "velocity")
        )
        if not (isinstance(position, Mapping) and isinstance(speed, Mapping)):
            return given
        counted = {key: position[key] for key in ("per_turn", "per_metre") if key in position}
        if speed.get("unit") != "tick/s" or not counted or set(speed) & {"per_turn", "per_metre"}:
            return given
        return {**given, "velocity": {**speed, **counted}}

    @model_validator(mode="after")
    def _consistent(self) -> "RigFile":
        if twice := set(self.known) & set(self.fit):
            raise ValueError(f"{', '.join(sorted(twice))}: either known or fitted")
        if self.position is None and self.velocity is None:
            raise ValueError("position: needed; where the log has none, give its velocity")
        places, rates = [*LENGTHS, *ANGLES, TICK], [*units_of("m/s"), *units_of("rad/s"), "tick/s"]
        _is_of("position", self.position, self.axis, places)
        _is_of("velocity", self.velocity, f"{self.axis}/s", rates)
        _is_of("reference", self.reference, self.axis, places)
        others = {} if isinstance(self.body, str) else self.body.joints
        for name, column in others.items():
            if column.unit not in LENGTHS | ANGLES:
                raise ValueError(f"body.joints.{name}.unit '{column.unit}' is no length or angle")
        if self.predict == "closed_loop" and (self.control is None or self.reference is None):
            raise ValueError("predict: closed_loop needs 'control' and 'reference'")
        if self.effort.source == "control" and (self.control is None or self.reference is None):
            raise ValueError("effort.from: control needs 'control' and 'reference'")
        self._has_places()
        used_once(self.channels())
        return self

    def _has_places(self) -> None:
        """Raise where something asks for what this rig does not have."""
        named = set(self.known) | set(self.fit)
        if "back_emf" in named and self.effort.si != "V":
            raise ValueError("back_emf: only where the effort is a voltage")
        if self.position is not None:
            return
        if not isinstance(self.body, str):
            raise ValueError("body: needs the position")
        if self.reference is not None:
            raise ValueError("reference: needs the position")
        if placed := sorted(named & {"stiffness", "payload_cosine", "payload_sine"}):
            raise ValueError(f"{placed[0]}: needs the position")
        if self.predict != "effort":
            raise ValueError(f"predict: {self.predict} needs the position")


def _is_of(key: str, column: MotionColumn | None, si: str, known: list[str]) -> None:
    if column is None:
        return
    if column.unit not in known:
        raise ValueError(f"{key}.unit '{column.unit}'; known: {', '.join(known)}")
    if column.si != si:
        raise ValueError(f"{key}.unit '{column.unit}' does not go with an axis in {si}")
