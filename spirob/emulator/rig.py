"""The machine: what a user may know and choose of it, and how this one differs from its data sheet.

Every row of `SPREADS` is a number that is drawn once for a seed, around its nominal value, for
both sides together or for each side on its own, and never shown to the model.
"""

import math
from dataclasses import dataclass

import numpy as np

from spirob.emulator.build import AS_DESIGNED, Build, anatomy, require_build
from spirob.emulator.physics import HINGES, SIDES
from spirob.emulator.physics.step import NUMBERS
from spirob.errors import ConfigError
from spirob.geometry import BASE_WIDTH, PUBLISHED
from spirob.unit_table import Geometry

M3508_RATIO = 3591 / 187  # 19.203, from published firmware of the motor
STEPS_PER_CYCLE = 10  # 0.1 ms: two periods of the 20 kHz current loop
HINGE_STIFFNESS = 0.15  # N·m/rad for the first hinge of the design, divided among those here
STIFFNESS_EXPONENT = 1.5  # k ∝ s^e; published values lie between 1 and 3
STOP_FRACTION = 0.96  # of the angle between the faces; before they are flush the cables jam
STOP_STIFFNESS = 400.0  # N·m/rad at the base: the end stop gives 0.4° under 75 N
STOP_TIME = 0.0005  # s, damping over stiffness of the faces


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


@dataclass(frozen=True)
class Spread:
    """One drawn number: normal about `nominal`, or its logarithm, cut at two deviations.

    spread   standard deviation, of the number or (log) of its logarithm
    sides    difference between left and right: standard deviation relative to the nominal
    """

    nominal: float
    spread: float
    unit: str
    reason: str
    log: bool = False
    sides: float = 0.0


SPREADS = {
    "efficiency": Spread(
        0.77, 0.035, "1", "0.3 N·m/A over G·k_t gives 0.77, 0.63-0.77", False, 0.01
    ),
    "rotor_inertia": Spread(2e-5, 0.2, "kg·m²", "49 ms mechanical time constant", True, 0.02),
    "rotor_damping": Spread(
        5e-5, 0.2, "N·m·s/rad", "no-load current read 1e-5 to 6e-4", True, 0.05
    ),
    "stiffness": Spread(1.0, 0.15, "1", "printed TPU, sources differ by ten", True),
    "damping_time": Spread(0.02, 0.2, "s", "ring-down of a printed arm, 3 ms to 0.4 s", True),
    "mass": Spread(1.0, 0.05, "1", "infill of the print", True),
    "winch_radius": Spread(1.0, 0.005, "1", "turned part plus half a tendon", False, 0.002),
    "tendon_stiffness": Spread(4e4, 0.15, "N/m", "braided line of 1 mm, half a metre", True, 0.05),
    "tendon_damping": Spread(5.0, 0.2, "N·s/m", "assumed", True),
    "winch_inertia": Spread(2e-5, 0.1, "kg·m²", "aluminium drum of 40 mm", True, 0.02),
    "gear_stiffness": Spread(600.0, 0.15, "N·m/rad", "planetary gear of this size, assumed", True),
    "gear_damping": Spread(0.3, 0.2, "N·m·s/rad", "assumed", True),
    "coulomb": Spread(1e-5, 0.2, "N·m", "bearings; 0.1 % of a typical current", True, 0.1),
    "resistance": Spread(0.194, 0.02, "Ω", "measured by others", True, 0.01),
    "inductance": Spread(0.097e-3, 0.02, "H", "measured by others", True, 0.01),
    "torque_constant": Spread(0.0203, 0.005, "N·m/A", "24.48 rpm/V", True, 0.002),
    "heat_resistance": Spread(2.0, 0.1, "K/W", "motor of 365 g", True, 0.02),
    "heat_capacity": Spread(40.0, 0.1, "J/K", "copper of a motor of 365 g", True, 0.02),
    "ambient": Spread(24.0, 2.0, "°C", "room"),
    "bandwidth": Spread(1.0, 0.05, "1", "tuning of the current loop", True),
}


def draw(rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Draw every number of `SPREADS`; (2,) where the sides differ, otherwise (1,)."""
    drawn = {}
    for name, row in SPREADS.items():
        deviation = row.spread * np.clip(rng.standard_normal(), -2, 2)
        value = row.nominal * np.exp(deviation) if row.log else row.nominal + deviation
        sides = np.clip(rng.standard_normal(SIDES), -2, 2)
        drawn[name] = np.atleast_1d(value * (1 + row.sides * sides if row.sides else 1.0))
    return drawn


def numbers_of(rig: EmulatedRig, build: Build, dt: float) -> np.ndarray:
    """The record of numbers of a machine without any hidden effect.

    dt  integration step [s], of which the current loop takes whole fractions
    """
    numbers = np.zeros(1, NUMBERS)
    _body(numbers, rig, build)
    _tendons(numbers, build)
    _drives(numbers, rig, build.sheet, dt)
    return numbers


def _body(numbers, rig, build) -> None:
    arm, drawn = build.arm, build.sheet
    body = anatomy(arm)
    mass = drawn["mass"] * body.mass
    beyond = np.concatenate([np.cumsum(mass[::-1])[::-1][1:], [0.0]])
    length = arm.unit_length
    base = HINGES / rig.geometry.units * HINGE_STIFFNESS
    stiffness = base * drawn["stiffness"] * arm.scale**STIFFNESS_EXPONENT
    size = rig.geometry.arm().half_width[0] * 2 / BASE_WIDTH
    stop = STOP_STIFFNESS * size * arm.scale
    fields = {
        "length": length,
        "first_moment": mass * body.centre + length * beyond,
        "inertia": drawn["mass"] * body.inertia + length**2 * beyond,
        "gravity": rig.gravity,
        "stiffness": stiffness,
        "damping": drawn["damping_time"] * stiffness,
        "hardening_power": 2.0,
        "creep_time": 1.0,
        "stop_angle": STOP_FRACTION * arm.hinge_angle,
        "stop_stiffness": stop,
        "stop_damping": STOP_TIME * stop,
        "corner_x": body.corner_x,
        "corner_y": body.corner_y,
        "contact_stiffness": 1e5,
        "contact_damping": 40.0,
        "creep_speed": 1e-3,
        "self_friction": 0.4,  # assumed: TPU on TPU
    }
    _assign(numbers, fields)


def _tendons(numbers, build) -> None:
    before = np.linalg.norm(build.before, axis=-1)
    after = np.linalg.norm(build.after, axis=-1)
    angle = np.arctan2(build.before[..., 1], build.before[..., 0])
    angle -= np.arctan2(build.after[..., 1], build.after[..., 0])
    fields = {
        "guide_product": before * after,
        "guide_difference": (before - after) ** 2,
        "guide_span": np.sqrt((before - after) ** 2 + 4 * before * after * np.sin(angle / 2) ** 2),
        "guide_sine": np.sin(angle / 2),
        "guide_cosine": np.cos(angle / 2),
        "guide_slip_distance": 1.5e-4,
        "tendon_stiffness": build.sheet["tendon_stiffness"],
        "tendon_damping": build.sheet["tendon_damping"],
        "tendon_creep_time": 1.0,
    }
    _assign(numbers, fields)


def _drives(numbers, rig, drawn, dt) -> None:
    same = (
        "efficiency rotor_inertia rotor_damping winch_inertia gear_stiffness gear_damping coulomb "
        "resistance inductance torque_constant heat_resistance heat_capacity ambient"
    )
    fields = {name: drawn[name] for name in same.split()}
    fields |= {
        "gear_ratio": rig.gear_ratio,
        "breakaway": 0.3 * drawn["coulomb"],
        "stribeck_speed": 5.0,
        "bristle_angle": 0.01,
        "thinning_speed": 100.0,
        "fan_power": 2.0,
        "saturation_power": 2.0,
        "winch_radius": rig.winch_radius * drawn["winch_radius"],
        "supply": 24.0,
        "bandwidth": rig.current_bandwidth * drawn["bandwidth"],
        "electric_steps": np.ceil(dt / 50e-6 - 1e-9),
        "sensor_gain": 1.0,
        "sensor_drift_time": 1.0,
        "current_noise": rig.current_noise,
        "by_voltage": float(rig.by_voltage),
    }
    _assign(numbers, fields)


def _assign(numbers: np.ndarray, fields: dict) -> None:
    for name, value in fields.items():
        if np.ndim(value) == 1 and np.shape(value) == (1,):
            value = value[0]
        numbers[name][0] = value
