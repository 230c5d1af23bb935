"""What a user may know and choose about the emulated machine."""

import math
from dataclasses import dataclass

from spirob.emulator.build import AS_DESIGNED, require_build
from spirob.errors import ConfigError
from spirob.geometry import PUBLISHED
from spirob.unit_table import Geometry

M3508_RATIO = 3591 / 187  # 19.203, from published firmware of the motor
STEPS_PER_CYCLE = 10  # 0.1 ms: two periods of the 20 kHz current loop


@dataclass(frozen=True)
class EmulatedRig:
    """The data sheet of the machine; what the seed draws lies around these numbers.

    gear_ratio         G, rotor turns a winch turn; 1 is direct drive
    winch_radius       nominal [m]
    geometry           what the arm is: as drawn, or as measured
    gravity            components in the plane of the arm, x (base to tip) and y [m/s²];
                       (0, 0) is an arm on a smooth horizontal table
    current_bandwidth  of the drive's own current loop [Hz]
    current_noise      rms of the current sensor [A]
    steps_per_cycle    integration steps in a 1 ms bus cycle
    by_voltage         whether the drives take voltages and leave the current loop to the host
    """

    gear_ratio: float = M3508_RATIO
    winch_radius: float = 0.020
    geometry: Geometry = PUBLISHED
    gravity: tuple[float, float] = (0.0, 0.0)
    current_bandwidth: float = 1000.0
    current_noise: float = 0.005
    steps_per_cycle: int = STEPS_PER_CYCLE
    by_voltage: bool = False

    def __post_init__(self) -> None:
        ranges = {
            "gear_ratio": (1.0, 200.0),
            "winch_radius": (0.002, 0.1),
            "current_bandwidth": (50.0, 3000.0),
            "current_noise": (0.0, 0.2),
            "steps_per_cycle": (4, 1000),
        }
        for name, (low, high) in ranges.items():
            value = getattr(self, name)
            if not low <= value <= high:
                raise ConfigError(f"emulated rig: {name} = {value} is out of range [{low}, {high}]")


@dataclass(frozen=True)
class HiddenSettings:
    """Which hidden effects the machine has, how strong (1 is typical, 0 is none), how it is built.

    effect    one kind, "cogging", or several at once, "cogging+joint_creep", each with a strength
              of its own where one is written, "cogging:0.5+joint_creep:1.2"
    strength  of all of them; it multiplies their own
    build     one of `spirob.emulator.build.BUILDS`
    built     seed that the build alone is drawn by, for the same machine built anew; the machine's
              own where none is given
    """

    effect: str = "guide_friction"
    strength: float = 1.0
    build: str = AS_DESIGNED
    built: int | None = None

    def __post_init__(self) -> None:
        require_build(self.build)
        kinds = [kind for kind, _ in self.parts]
        for kind in kinds:
            if kinds.count(kind) > 1:
                raise ConfigError(f"hidden effect: '{kind}' stands twice in '{self.effect}'")
        if "none" in kinds and len(kinds) > 1:
            raise ConfigError(f"hidden effect: 'none' stands beside others in '{self.effect}'")
        for strength in (self.strength, *(own for _, own in self.parts)):
            if not 0.0 <= strength <= 10.0:
                raise ConfigError(f"hidden effect: strength = {strength} is out of range [0, 10]")

    @property
    def parts(self) -> list[tuple[str, float]]:
        """Every kind with its strength, in the order in which they are written."""
        return [self._part(text) for text in self.effect.split("+")]

    def _part(self, text: str) -> tuple[str, float]:
        kind, colon, own = (piece.strip() for piece in text.partition(":"))
        try:
            strength = float(own) if colon else 1.0
        except ValueError:
            strength = math.nan
        if not kind or math.isnan(strength):
            raise ConfigError(
                f"hidden effect: '{text}' in '{self.effect}' is not a kind or 'kind:strength'"
            )
        return kind, self.strength * strength
