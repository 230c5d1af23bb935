"""The columns of a log in a description, and their units: motion, effort, time."""

from collections.abc import Mapping, Sequence
from typing import Any, Literal, get_args

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    ValidationInfo,
    field_validator,
    model_validator,
)

from spirob.errors import DataError
from spirob.units import UNITS, number, sized, units_of

TIME_UNITS = units_of("s")
LENGTHS, ANGLES = units_of("m"), units_of("rad")
TICK = "tick"
SI = {"current": "A", "voltage": "V", "duty": "V", "force": "N", "torque": "N·m"}
EFFORTS = {kind: units_of("1" if kind == "duty" else si) for kind, si in SI.items()}


class Entry(BaseModel):
    """Base of every part of the description: no unknown keys, no number that none can mean."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    @field_validator("*", mode="before")
    @classmethod
    def _no_switch(cls, value: Any, about: ValidationInfo) -> Any:
        kind = cls.model_fields[str(about.field_name)].annotation
        wanted = {kind, *get_args(kind)}
        return number(value) if wanted & {int, float} and bool not in wanted else value

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


class TimeColumn(Column):
    """When a row was logged; a column of dates and times needs no unit."""

    @field_validator("unit")
    @classmethod
    def _known_unit(cls, value: str) -> str:
        if value not in ("", *TIME_UNITS):
            raise ValueError(f"'{value}'; known: {', '.join(TIME_UNITS)}")
        return value

    def told(self, log: str, units: Mapping[str, str]) -> "TimeColumn":
        """With the unit that the log itself tells; DataError where nothing does."""
        if unit := units.get(self.column, self.unit):
            return self.model_copy(update={"unit": unit})
        raise DataError(
            f"{log}: time.unit: '{self.column}' holds numbers; known: {', '.join(TIME_UNITS)}"
        )


class MotionColumn(Column):
    """A position or a speed.

    per_turn, per_metre  ticks of an encoder in a turn, or a metre, for the units tick and tick/s
    """

    per_turn: float | None = Field(default=None, gt=0)
    per_metre: float | None = Field(default=None, gt=0)

    @property
    def si(self) -> str:
        """What it is in SI: m, rad, m/s or rad/s; "" where the unit is of another kind."""
        return self._meant[0]

    @property
    def scale(self) -> float:
        """SI for one `unit`."""
        return self._meant[1]

    @property
    def _meant(self) -> tuple[str, float]:
        own = UNITS.get(self.unit)
        name, _, rate = self.unit.partition("/")
        if name != TICK:
            known = own is not None and own.si in ("m", "rad", "m/s", "rad/s")
            return (own.si, own.factor) if own and known else ("", 1.0)
        per = f"/{rate}" if rate else ""
        if self.per_metre is not None:
            return f"m{per}", 1.0 / self.per_metre
        return f"rad{per}", ANGLES["turn"] / (self.per_turn or 1.0)

    @model_validator(mode="after")
    def _ticks_are_counted(self) -> "MotionColumn":
        counted = [n for n in (self.per_turn, self.per_metre) if n is not None]
        if self.unit.partition("/")[0] == TICK and len(counted) != 1:
            raise ValueError("ticks need per_turn, or per_metre: how many there are")
        if self.unit.partition("/")[0] != TICK and counted:
            raise ValueError("per_turn and per_metre belong to the units tick and tick/s")
        return self


class PositionColumn(MotionColumn):
    """The position.

    modulus  after which it begins again at its lowest value, in `unit`; absent: found in the log
    side     where its sensor sits: at the "motor", or at the "load" behind gear and shaft; absent:
             at the motor, unless the logs fit one at the load better
    """

    modulus: float | None = Field(default=None, gt=0)
    side: Literal["motor", "load"] | None = None


class EffortColumn(Column):
    """The effort: what it is, and whether it was measured or only commanded.

    from    "column", or "control": computed from `control`, the reference and the motion
    kind    of quantity after `factor`; a duty becomes a voltage by its supply
    supply  voltage that a duty of 1 gives [V], or its column
    origin  "sensor": a force or torque sensor behind the motor, which no drive can distort;
            "measured": what the drive reports;  "command": what the drive was asked for
    limit   size at which the drive saturates, in `unit`; rows beyond 98 % of it are left out
    """

    column: str = ""
    source: Literal["column", "control"] = Field(default="column", alias="from")
    kind: Literal["current", "voltage", "duty", "force", "torque"]
    supply: float | Column | None = None
    origin: Literal["sensor", "measured", "command"] = "measured"
    name: str = ""
    limit: float | None = Field(default=None, gt=0)

    @field_validator("unit", mode="before")
    @classmethod
    def _one_is_a_unit(cls, value: Any) -> Any:
        return "1" if value == 1 and not isinstance(value, bool) else value

    @model_validator(mode="after")
    def _whole(self) -> "EffortColumn":
        units = EFFORTS[self.kind]
        if self.unit not in units:
            raise ValueError(f"unit '{self.unit}' is no {self.kind}; known: {', '.join(units)}")
        if (self.source == "column") != bool(self.column):
            raise ValueError("give either its column, or from: control")
        if self.kind == "duty" and self.supply is None:
            raise ValueError("a duty needs effort.supply: its voltage at a duty of 1 [V]")
        if self.kind != "duty" and self.supply is not None:
            raise ValueError(f"effort.supply is that of a duty; a {self.kind} has none")
        if isinstance(self.supply, float) and self.supply <= 0:
            raise ValueError("supply: more than 0 V")
        if isinstance(self.supply, Column) and self.supply.unit not in EFFORTS["voltage"]:
            raise ValueError(
                f"supply.unit '{self.supply.unit}'; known: {', '.join(EFFORTS['voltage'])}"
            )
        return self

    @property
    def si(self) -> str:
        """Its unit in the model: A, V, N or N·m."""
        return SI[self.kind]

    @property
    def scale(self) -> float:
        """SI for one `unit`; for a duty whose supply is a column, its share of that."""
        volts = self.supply if isinstance(self.supply, float) else 1.0
        return EFFORTS[self.kind][self.unit] * volts

    @property
    def title(self) -> str:
        """What it is called in a sentence."""
        return self.name or f"motor {'voltage' if self.kind == 'duty' else self.kind}"


def _each_once(names: Sequence[str]) -> Sequence[str]:
    if twice := [name for k, name in enumerate(names) if name in names[:k]]:
        raise ValueError(f"'{twice[0]}' is given twice")
    return names


Once = AfterValidator(_each_once)


def used_once(channels: Mapping[str, Column]) -> None:
    """Raise ValueError where one column is given for two things, by what it is for."""
    seen: dict[str, str] = {}
    for key, column in channels.items():
        if column.column in seen:
            raise ValueError(f"{key}: '{column.column}' is the column of {seen[column.column]}")
        seen[column.column] = key
