"""What a drive's description may hold; the DBC file beside it says the rest, units included.

    name: odrive
    dbc: odrive.dbc
    motors:
      left:
        command: {message: Axis0_Set_Input_Torque, signal: Input_Torque, per_ampere: 0.0203}
        angle: {message: Axis0_Get_Encoder_Estimates, signal: Pos_Estimate}
        speed: {message: Axis0_Get_Encoder_Estimates, signal: Vel_Estimate}
        current: {message: Axis0_Get_Iq, signal: Iq_Measured}
        temperature: {message: Axis0_Get_Temperature, signal: Motor_Temperature}
      right: ...
    arm: [{message: Axis0_Set_Axis_State, values: {Axis_Requested_State: 8}}]
    disarm: ...

`per_ampere`: what the signal is for one ampere of the motor's current; negative where the drive
counts the other way round, as `sign: -1` is for feedback.  `per_volt` stands instead where the
drive takes a voltage: 1, or -1 where a positive one pays out; the unit, V or mV, is the DBC's.
"""

from math import pi
from typing import Annotated, Literal, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    StringConstraints,
    ValidationError,
    model_validator,
)

from spirob.errors import ConfigError
from spirob.units import Size, sized_not_zero

Text = Annotated[str, StringConstraints(min_length=1, max_length=200)]
TURNS = {"turn": 1.0, "rev": 1.0, "rad": 1 / (2 * pi), "deg": 1 / 360, "count": 1 / 8192}
RPM = {"rpm": 1.0, "rev/s": 60.0, "turn/s": 60.0, "rad/s": 60 / (2 * pi), "deg/s": 1 / 6}
AMPERES = {"A": 1.0, "mA": 1e-3}
VOLTS = {"V": 1.0, "mV": 1e-3}
CELSIUS = {"degC": 1.0, "°C": 1.0, "C": 1.0}
UNITS = {"angle": TURNS, "speed": RPM, "current": AMPERES, "temperature": CELSIUS}


class Strict(BaseModel):
    """No key that is not declared."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class Source(Strict):
    """One signal of one message."""

    message: Text
    signal: Text
    sign: Literal[1, -1] = 1


class Command(Strict):
    """The signal that commands a motor's current, or its voltage where `per_volt` is given."""

    message: Text
    signal: Text
    per_ampere: Annotated[float, AfterValidator(sized_not_zero)] = 1.0
    per_volt: Annotated[float, AfterValidator(sized_not_zero)] | None = None

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if self.per_volt is not None and "per_ampere" in self.model_fields_set:
            raise ValueError("per_ampere or per_volt, not both: it is a current or a voltage")
        return self


class Motor(Strict):
    """One motor: how it is commanded, and what it says; `angle` comes last in a cycle."""

    command: Command
    angle: Source
    speed: Source
    current: Source
    temperature: Source | None = None


class Sent(Strict):
    """A message with fixed values."""

    message: Text
    values: dict[Text, Size] = {}


class Motors(Strict):
    """Both motors of the arm."""

    left: Motor
    right: Motor

    @model_validator(mode="after")
    def _alike(self) -> Self:
        if (self.left.command.per_volt is None) != (self.right.command.per_volt is None):
            raise ValueError("both motors take a current, or both a voltage")
        return self


class Description(Strict):
    """A whole description."""

    name: Text
    dbc: Annotated[str, StringConstraints(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.\-]{0,99}$")]
    motors: Motors
    arm: list[Sent] = Field([], max_length=50)
    disarm: list[Sent] = Field([], max_length=50)


def description_from(plain: object, where: str) -> Description:
    """A description from plain data; raises ConfigError naming `where` and the key."""
    try:
        return Description.model_validate(plain)
    except (ValidationError, RecursionError) as error:
        if isinstance(error, RecursionError):
            raise ConfigError(f"{where}: is nested too deeply") from None
        first = error.errors(include_input=False, include_url=False)[0]
        key = ".".join(str(part) for part in first["loc"]) or "the file"
        said = first["msg"].removeprefix("Value error, ")
        raise ConfigError(f"{where}: key '{key[:200]}': {said}") from None
