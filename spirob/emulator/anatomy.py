"""Masses, inertias and outlines of the arm's units, integrated from their shape.

A unit is the part of a cone of half width w(x) = w₀ - σx between two faces that are slanted by
α = Δθ/2 away from its two hinges, so half its height at x is

    y(x) = min(w(x), x/tan α, (L - x)/tan α),      thickness b(x) = 0.6·2w(x)

    m = ρ∫2y b dx     m·c = ρ∫2y b x dx     I = ρ∫(2y x² + ⅔y³) b dx      (I about the hinge)

Sources: TPU 1200 kg/m³ (data sheets), 45 % infill and thickness 0.6 of the width (the published
design tool's extrusion default): 0.32 kg at full size.
"""

from dataclasses import dataclass

import numpy as np

from spirob.geometry import SpiralArm

DENSITY = 1200.0  # kg/m³, TPU
FILL = 0.45  # printed infill
THICKNESS = 0.6  # of the local width
SLICES = 4000  # of the midpoint rule


@dataclass(frozen=True)
class Anatomy:
    """Per unit, from base to tip, each (N,).

    mass [kg]; centre of mass from the hinge [m]; inertia about the hinge [kg·m²]
    corner_x, corner_y  (N, 2) where the outline starts and ends, in the unit's own frame [m]
    """

    mass: np.ndarray
    centre: np.ndarray
    inertia: np.ndarray
    corner_x: np.ndarray
    corner_y: np.ndarray


def anatomy(arm: SpiralArm) -> Anatomy:
    """Integrate every unit of the arm."""
    face, start, slope = _shape(arm)
    length = arm.unit_length
    x = (np.arange(SLICES) + 0.5) / SLICES * length[:, None]
    width = start[:, None] - slope[:, None] * x
    height = np.minimum(width, np.minimum(x, length[:, None] - x) / face[:, None])
    density = DENSITY * FILL * THICKNESS * 2 * width * (length / SLICES)[:, None]
    mass = (density * 2 * height).sum(axis=1)
    moment = (density * 2 * height * x).sum(axis=1)
    inertia = (density * (2 * height * x**2 + 2 / 3 * height**3)).sum(axis=1)

    return Anatomy(mass, moment / mass, inertia, *corners(arm))


def corners(arm: SpiralArm) -> tuple[np.ndarray, np.ndarray]:
    """Where each unit's outer edge starts and ends, x and y, (N, 2) each [m]."""
    face, start, slope = _shape(arm)
    length = arm.unit_length
    first = start / (1 + slope * face)
    last = (start - slope * length) / (1 - slope * face)
    corner_x = np.column_stack([face * first, length - face * last])
    return corner_x, np.column_stack([first, last])


def _shape(arm: SpiralArm) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """tan α, w₀ and σ of each unit."""
    ratio = arm.taper
    start = arm.half_width * 2 * ratio / (1 + ratio)
    return np.tan(arm.unit_angle / 2), start, (start - start / ratio) / arm.unit_length
