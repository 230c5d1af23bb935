"""Which machine: nominal numbers of its parts and the gains of its controller."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from spirob.control.law import Gains
from spirob.errors import ConfigError
from spirob.parameter import Numbers
from spirob.plant.nominal import COMPONENTS, Arm, Drive, Motor, Tendon, Winch

MOST_UNITS = 200  # of an arm; each is a hinge of the model


@dataclass(frozen=True)
class Rig:
    """Nominal numbers of a machine with two motors, two tendons and a spiral arm."""

    name: str = "spirob"
    units: int = 24
    motor: Motor = field(default_factory=Motor)
    drive: Drive = field(default_factory=Drive)
    winch: Winch = field(default_factory=Winch)
    tendon: Tendon = field(default_factory=Tendon)
    arm: Arm = field(default_factory=Arm)
    gains: Gains = field(default_factory=Gains)

    @classmethod
    def from_mapping(cls, settings: Mapping[str, object]) -> "Rig":
        """Build from a configuration; parts and numbers not named keep their nominal values.

        Raises ConfigError naming the part and key that is unknown or out of range.
        """
        kinds: tuple[type[Numbers], ...] = (*COMPONENTS, Gains)
        parts = {c.owner: c for c in kinds}
        chosen: dict[str, object] = {}
        for key, value in settings.items():
            if key in parts and isinstance(value, Mapping):
                chosen[key] = parts[key].from_mapping(value)
            elif key == "name":
                chosen[key] = str(value)
            elif key == "units":
                if not (isinstance(value, int) and 1 <= value <= MOST_UNITS):
                    raise ConfigError(f"units: 1 to {MOST_UNITS} can be modelled, got {value!r}")
                chosen[key] = int(value)
            else:
                known = ", ".join(["name", "units", *parts])
                raise ConfigError(f"rig has no part '{key}'; it has: {known}")
        return cls(**chosen)  # type: ignore[arg-type]

    def parts(self) -> list[tuple[str, Numbers]]:
        """The model's parts with their names, in the order of the parameter vector."""
        return [(c.owner, getattr(self, c.owner)) for c in COMPONENTS]
