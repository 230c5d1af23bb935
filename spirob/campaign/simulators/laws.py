"""Torques of one moment and short memories, as all simulators of the campaign have them.

What differs between the simulators stands in each: how motion is integrated, how dry friction
holds and turns round, what the motor is, and what the axis carries.
"""

import math

import numpy as np
from numba import njit

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
