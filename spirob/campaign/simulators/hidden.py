"""Everything that can be hidden in an axis: its numbers, and its torques of one moment.

At the defaults of its numbers nothing is there.  Torques of one moment and short memories are alike
in all simulators of the campaign.  What differs between the simulators stands in each: how motion
is integrated, how dry friction holds and turns round, what the motor is, and what the axis carries.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import njit


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
    spring: float = 0.0  # T at the ends of the stroke, from where it is at rest
    at_rest: float = 0.0
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
        "parallel_spring": (
            {"at_rest": scale.middle + half * between(-2.0, 2.0), "half": half},
            {"spring": torque},
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


WARM, BEND, SINCE, WAY = range(4)  # places in the memory
CELLS = 4
LONG = 1e3  # s since a reversal that never was


def memory() -> np.ndarray:
    """Warmth of the motor, bend of a yielding spring, time since a reversal, way of motion."""
    cells = np.zeros(CELLS)
    cells[SINCE] = LONG
    return cells


@njit(cache=True)
def level(q, v, t, load, motor, h):
    """Level of dry friction at this moment, never negative."""
    found = h.level + h.excess * math.exp(-((v / h.stribeck_speed) ** 2))
    found += h.by_load * abs(load) + h.by_drive * abs(motor)
    found += h.drift * 0.5 * (1.0 + math.sin(2.0 * math.pi * t / h.drift_time + h.phase))
    if h.spot > 0.0:
        away = 2.0 * math.sin(0.5 * h.spot_turn * (q - h.spot_at))
        found += h.spot * math.exp(-0.5 * (away / h.spot_width) ** 2)
    if h.one_way > 0.0 and v > 0.0:
        found += h.one_way * math.exp(-((v / h.one_way_speed) ** 2))
    if h.power_level > 0.0:
        found += h.power_level * (abs(v) / h.power_speed) ** h.power
    return found


@njit(cache=True)
def passive(q, v, cells, h):
    """Torque on the axis beside its motor, its dry friction and what is in proportion to speed."""
    far = (q - h.middle) / h.half
    torque = h.force - 0.5 * h.asymmetric * abs(v) - h.drag * v * abs(v)
    torque -= h.uneven * far * far * v
    if h.wave > 0.0:
        angle = h.order * h.turn * q + h.phase
        wave = math.sin(angle) + h.second * math.sin(2.0 * angle + 1.0)
        torque -= h.wave * (wave + h.third * math.sin(3.0 * angle + 2.0))
    torque -= h.weight * math.sin(q - h.hangs)
    torque -= h.spring * (q - h.at_rest) / h.half
    torque -= h.cubic * far * far * far
    torque -= h.magnets * math.sin(h.pitch * far * (1.0 + 0.7 * abs(far)))
    torque -= h.hysteresis * cells[BEND]
    if h.knock > 0.0:
        ring = math.sin(2.0 * math.pi * h.knock_frequency * cells[SINCE])
        torque -= cells[WAY] * h.knock * ring * math.exp(-cells[SINCE] / h.knock_time)
    return torque


@njit(cache=True)
def drive(asked, q, v, cells, h):
    """Torque that the motor gives where `asked` is the torque that it is meant to give."""
    torque = asked
    if h.dead_band > 0.0:
        torque = math.copysign(max(abs(asked) - h.dead_band, 0.0), asked)
    torque /= math.sqrt(1.0 + h.saturation * torque * torque)
    torque *= 1.0 + h.ripple * math.sin(h.ripple_order * h.turn * q + h.phase)
    if h.speed_loss > 0.0:
        torque *= 1.0 - h.speed_loss * abs(v) / (abs(v) + h.loss_speed)
    return torque / (1.0 + cells[WARM])


@njit(cache=True)
def remember(cells, asked, v, dt, h):
    """Move the memory on by dt."""
    cells[WARM] += dt * (h.heating * asked * asked - cells[WARM] / h.heating_time)
    bend = cells[BEND]
    # Bouc and Wen: the spring yields at 1, and springs back when the motion turns
    cells[BEND] = bend + dt * v / h.yields * (1.0 - bend * bend * (0.5 + 0.5 * _sign(v * bend)))
    way = _sign(v)
    if way != 0.0 and way != cells[WAY]:
        cells[SINCE] = 0.0 if cells[WAY] != 0.0 else LONG
        cells[WAY] = way
    cells[SINCE] += dt


@njit(cache=True)
def _sign(x):
    return 1.0 if x > 0.0 else (-1.0 if x < 0.0 else 0.0)
