"""The numbers of everything that can be hidden in an axis; at their defaults nothing is there."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np


class Hidden(NamedTuple):
    """Numbers in the axis' own units: torque or force T, angle or length, seconds.

    Dry friction: its level is the sum of what is named here, its way that of a bristle; 0 is the
    simulator's own.
    """

    level: float = 0.0  # T
    excess: float = 0.0  # T, beside the level near rest
    stribeck_speed: float = 1.0
    way: float = 0.0
    by_load: float = 0.0  # of the load behind the motor
    by_drive: float = 0.0  # of the motor's torque
    drift: float = 0.0  # T, comes and goes with time
    drift_time: float = 1.0  # s, a period of it
    spot: float = 0.0  # T, at one place of the turn
    spot_at: float = 0.0
    spot_turn: float = 1.0  # rad for one unit of position
    spot_width: float = 0.3  # rad
    one_way: float = 0.0  # T, while moving forward slowly
    one_way_speed: float = 1.0
    power_level: float = 0.0  # T at the speed below, grows with its power
    power: float = 0.5
    power_speed: float = 1.0

    asymmetric: float = 0.0  # T·s, half of it added forward and taken backward
    drag: float = 0.0  # T·s²
    uneven: float = 0.0  # T·s, viscous friction at the ends of the stroke beside that of its middle
    middle: float = 0.0
    half: float = 1.0  # of the stroke
    force: float = 0.0  # T
    wave: float = 0.0  # T
    second: float = 0.0  # of the first wave
    third: float = 0.0
    order: float = 7.0  # periods in a radian of the motor, which turns by
    turn: float = 1.0  # rad for one unit of position
    phase: float = 0.0
    weight: float = 0.0  # T
    hangs: float = 0.0  # position in which the weight hangs
    cubic: float = 0.0  # T at the ends of the stroke
    magnets: float = 0.0  # T, with a pitch that changes along the way
    pitch: float = 1.0
    hysteresis: float = 0.0  # T, of a spring that yields
    yields: float = 1.0  # way over which it does
    knock: float = 0.0  # T, rings after each reversal
    knock_frequency: float = 6.0
    knock_time: float = 0.3

    ripple: float = 0.0  # of the motor's torque
    ripple_order: float = 6.0
    saturation: float = 0.0  # 1/T²
    dead_band: float = 0.0  # T
    heating: float = 0.0  # 1/(T²·s)
    heating_time: float = 10.0
    speed_loss: float = 0.0  # of the torque at high speed
    loss_speed: float = 1.0

    soft: float = 0.0  # s², 1/f² of the load that swings while the motor is held; 0 is stiff
    play: float = 0.0
    payload: float = 0.0  # of the last link's mass, at the tip of an arm

    offset: float = 0.0  # T, of the reading
    gain: float = 0.0
    lag: float = 0.0  # s
    latency: float = 0.0  # s, of the position
    eccentric: float = 0.0  # of the position as read
    eccentric_second: float = 0.0


@dataclass(frozen=True)
class Scale:
    """How large the motion of a machine is with nothing hidden in it.

    torque, speed  RMS;  middle, half  of the stroke;  seconds  of a log;  angular  of the axis
    turn  rad of the motor for one unit of position
    """

    torque: float
    speed: float
    middle: float
    half: float
    seconds: float
    angular: bool
    turn: float


@dataclass(frozen=True)
class Hiding:
    """One kind in one machine: numbers of its shape, and those that grow with its strength."""

    shape: dict[str, float]
    sizes: dict[str, float]
    most: float = 30.0  # strength
    fixed: bool = False  # its strength is not adjusted to what it shows

    def at(self, strength: float) -> dict[str, float]:
        """The numbers of a strength."""
        return self.shape | {name: strength * size for name, size in self.sizes.items()}


def hiding(kind: str, scale: Scale, rng: np.random.Generator) -> Hiding:
    """A kind's shape in a machine; at strength 1 it is about as large as the effort is."""
    torque, speed, half = scale.torque, scale.speed, scale.half

    def between(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    once = 1.0 if scale.angular else np.pi / (1.2 * half)  # rad of a place on the way
    middle = {"middle": scale.middle, "half": half}
    phase = {"phase": between(0, 2 * np.pi), "turn": scale.turn}
    order = float(rng.choice([5, 6, 7, 8, 9, 11, 12]))
    waves = {"second": between(0, 0.6), "third": between(0, 0.4), "order": order}
    swing = {"soft": between(25.0, 60.0) ** -2}
    made: dict[str, tuple[dict[str, float], dict[str, float]]] = {
        "coulomb_friction": ({}, {"level": torque}),
        "stribeck_friction": (
            {"stribeck_speed": speed * between(0.15, 0.4)},
            {"level": 0.5 * torque, "excess": torque * between(0.6, 1.0)},
        ),
        "presliding_friction": ({"way": half * between(0.03, 0.1)}, {"level": torque}),
        "load_dependent_friction": ({}, {"by_load": 1.0}),
        "direction_dependent_efficiency": ({}, {"by_drive": 1.0}),
        "asymmetric_viscous_friction": ({}, {"asymmetric": 2 * torque / speed}),
        "quadratic_drag": ({}, {"drag": torque / speed**2}),
        "cogging": (phase | waves, {"wave": torque}),
        "torque_ripple": (phase | {"ripple_order": order}, {"ripple": 1.0}),
        "tip_payload": (
            {"hangs": scale.middle + between(-1.5, 1.5)},
            {"weight": torque, "payload": 1.0},
        ),
        "constant_force": ({}, {"force": float(rng.choice([-1, 1])) * torque}),
        "current_offset": ({}, {"offset": float(rng.choice([-1, 1])) * torque}),
        "current_gain": ({}, {"gain": between(0.2, 0.4)}),
        "current_lag": ({}, {"lag": 0.05}),
        "feedback_latency": ({}, {"latency": 0.008}),
        "driver_dead_band": ({}, {"dead_band": torque}),
        "torque_constant_saturation": ({}, {"saturation": 1 / torque**2}),
        "winding_heating": (
            {"heating_time": scale.seconds * between(0.2, 0.6)},
            {"heating": 3.0 / (torque**2 * scale.seconds)},
        ),
        "gear_compliance": ({}, {"soft": 12.0**-2}),
        "backlash": (swing, {"play": 0.2 * half}),
        "encoder_eccentricity": (
            {"turn": scale.turn, "eccentric_second": between(0.0, 0.4)},
            {"eccentric": 0.2 / scale.turn},
        ),
        "position_viscosity": (middle, {"uneven": torque / speed}),
        "drifting_friction": (
            {"drift_time": scale.seconds * between(0.7, 1.5)} | phase,
            {"drift": torque},
        ),
        "power_friction": (
            {"power": between(0.3, 0.6), "power_speed": speed},
            {"power_level": torque},
        ),
        "progressive_spring": (middle, {"cubic": torque}),
        "tight_spot": (
            {
                "spot_at": scale.middle + half * between(-0.4, 0.4),
                "spot_turn": once,
                "spot_width": between(0.2, 0.5),
            },
            {"spot": 2 * torque},
        ),
        "hysteretic_spring": ({"yields": half * between(0.4, 0.8)}, {"hysteresis": torque}),
        "chirped_magnets": (middle | {"pitch": between(5.0, 9.0)}, {"magnets": torque}),
        "speed_efficiency": ({"loss_speed": speed * between(1.0, 2.0)}, {"speed_loss": 1.0}),
        "stick_one_way": ({"one_way_speed": speed * between(0.3, 0.6)}, {"one_way": torque}),
        "loose_screw": (
            {"knock_frequency": between(2.0, 5.0), "knock_time": between(0.2, 0.5)},
            {"knock": 2 * torque},
        ),
    }
    limits = {
        "load_dependent_friction": 0.6,
        "direction_dependent_efficiency": 0.6,
        "feedback_latency": 1.0,
        "current_lag": 3.0,
        "torque_ripple": 0.9,
        "speed_efficiency": 0.9,
        "gear_compliance": 16.0,
        "encoder_eccentricity": 0.5,  # a disc off centre by a tenth of its radius
    }
    return Hiding(*made[kind], limits.get(kind, 30.0), kind == "current_gain")
