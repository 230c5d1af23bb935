"""The description of a machine that nobody here has seen: `RIG.yaml`, read by `loading`.

Columns and their units, what the effort is, which numbers are known and which are fitted, the body
behind the motor, filters and the rows that are left out.  Data, never code; an unknown key is an
error that says where it stands.
"""

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, field_validator, model_validator

from spirob.given_number import Size, sized

TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9}
LENGTHS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6}
ANGLES = {"rad": 1.0, "deg": 0.017453292519943295, "turn": 6.283185307179586}
EFFORTS = {  # kind -> unit -> factor to SI
    "current": {"A": 1.0, "mA": 1e-3},
    "voltage": {"V": 1.0, "mV": 1e-3},
    "force": {"N": 1.0, "kN": 1e3, "mN": 1e-3},
    "torque": {"N·m": 1.0, "Nm": 1.0, "mN·m": 1e-3, "mNm": 1e-3},
}
MOST_EFFECTS = 100  # named in a description
SI = {"current": "A", "voltage": "V", "force": "N", "torque": "N·m"}


class Entry(BaseModel):
    """Base of every part of the description: no unknown keys, no number that none can mean."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @field_validator("*")
    @classmethod
    def _sized(cls, value: Any) -> Any:
        return sized(value) if isinstance(value, float) else value


class Column(Entry):
    """A column of the log: value in `unit` = factor·(cell - zero)."""

    column: str
    unit: str = ""
    factor: float = 1.0
    zero: float = 0.0

    @field_validator("factor")
    @classmethod
    def _factor_is_not_zero(cls, value: float) -> float:
        if value == 0.0:
            raise ValueError("a factor of 0 erases the column")
        return value


class EffortColumn(Column):
    """The effort: what it is, and whether it was measured or only commanded.

    kind    of quantity after `factor`
    origin  "sensor": a force or torque sensor behind the motor, which no drive can distort;
            "measured": what the drive reports;  "command": what the drive was asked for
    limit   size at which the drive saturates, in `unit`; rows beyond 98 % of it are left out
    """

    kind: Literal["current", "voltage", "force", "torque"]
    origin: Literal["sensor", "measured", "command"] = "measured"
    name: str = ""
    limit: float | None = Field(default=None, gt=0)


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
    drop      samples left out at both ends, where the filter has no neighbours; absent: half a
              period of the cutoff times ten
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


class Control(Entry):
    """A cascade: u = clip(velocity·(position·(reference - q) - v)), in the unit of effort.

    position [1/s], velocity [effort per speed], integral of the speed error [effort per position]
    """

    position: float
    velocity: float
    integral: float = 0.0
    limit: float | None = Field(default=None, gt=0)


NUMBERS = {
    "inertia": "inertia or mass that the motor moves",
    "viscous": "friction in proportion to speed",
    "stiffness": "spring that pulls towards position 0",
    "scale": "torque or force for one unit of effort",
    "delay": "time by which the effort trails the motion in the log",
}


def _each_once(names: list[str]) -> list[str]:
    if twice := [name for k, name in enumerate(names) if name in names[:k]]:
        raise ValueError(f"'{twice[0]}' is given twice")
    return names


Effects = Annotated[list[str], Field(max_length=MOST_EFFECTS), AfterValidator(_each_once)]


class RigFile(Entry):
    """A whole description; `spirob.machine.loading.load_rig` reads it.

    predict     what the user wants predicted; effects are named in the effort in any case, because
                a controller hides in the motion what its effort shows
    rest_speed  scale of the smooth sign of dry friction, in the unit of position per second;
                absent: 1 % of the fastest tenth of the motion
    gear        radians of the motor for one radian, or one metre, of position; absent: 1, or one
                turn over the whole stroke
    effects     what the model holds already; a name that ends in .py is a file of the user's own
    """

    name: str
    time: Column
    position: Column
    velocity: Column | None = None
    effort: EffortColumn
    reference: Column | None = None
    predict: Literal["effort", "motion", "closed_loop"] = "effort"
    control: Control | None = None
    known: dict[str, Size] = {}
    fit: dict[str, Bounded] = {}
    body: Body | Literal["none"] = "none"
    filter: FilterSettings = FilterSettings()
    rows: Rows = Rows()
    rest_speed: float | None = Field(default=None, gt=0)
    gear: float | None = Field(default=None, gt=0)
    effects: Effects = []

    @field_validator("known", "fit")
    @classmethod
    def _known_names(cls, value: dict[str, Any]) -> dict[str, Any]:
        for name in value:
            if name not in NUMBERS:
                raise ValueError(f"no number '{name}'; a rig has: {', '.join(NUMBERS)}")
        return value

    @model_validator(mode="after")
    def _consistent(self) -> "RigFile":
        if twice := set(self.known) & set(self.fit):
            raise ValueError(f"{', '.join(sorted(twice))}: either known or fitted")
        if self.time.unit not in TIME_UNITS:
            raise ValueError(f"time.unit '{self.time.unit}'; known: {', '.join(TIME_UNITS)}")
        if self.position.unit not in LENGTHS | ANGLES:
            known = ", ".join(LENGTHS | ANGLES)
            raise ValueError(f"position.unit '{self.position.unit}'; known: {known}")
        rates = [f"{unit}/s" for unit in LENGTHS | ANGLES]
        if self.velocity is not None and self.velocity.unit not in rates:
            raise ValueError(f"velocity.unit '{self.velocity.unit}'; known: {', '.join(rates)}")
        others = {} if isinstance(self.body, str) else self.body.joints
        for name, column in others.items():
            if column.unit not in LENGTHS | ANGLES:
                raise ValueError(f"body.joints.{name}.unit '{column.unit}' is no length or angle")
        units = EFFORTS[self.effort.kind]
        if self.effort.unit not in units:
            raise ValueError(
                f"effort.unit '{self.effort.unit}' is no {self.effort.kind}; "
                f"known: {', '.join(units)}"
            )
        if self.predict == "closed_loop" and (self.control is None or self.reference is None):
            raise ValueError("predict: closed_loop needs 'control' and 'reference'")
        return self
