"""What of an arm's logs is compared, as its description says: filter, thinning and rows."""

from typing import Literal

from pydantic import Field, model_validator

from spirob.identify.residual import Filter
from spirob.machine.rig import Entry, Rows


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
