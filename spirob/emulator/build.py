"""How a robot is built: what printing, assembly and another designer's choices change in the arm.

Every row of `ROWS` is drawn from a stream of the robot's own, so that a robot of one build has the
same data sheet, noise and hidden effects as it has of another.  `as_designed` draws none of them.
A build that cannot be is drawn again.

Masses, inertias and outlines of the arm's units are integrated from their shape.  A unit is the
part of a cone of half width w(x) = w₀ - σx between two faces that are slanted by α = Δθ/2 away from
its two hinges, so half its height at x is

    y(x) = min(w(x), x/tan α, (L - x)/tan α),      thickness b(x) = 0.6·2w(x)

    m = ρ∫2y b dx     m·c = ρ∫2y b x dx     I = ρ∫(2y x² + ⅔y³) b dx      (I about the hinge)

Sources: TPU 1200 kg/m³ (data sheets), 45 % infill and thickness 0.6 of the width (the published
design tool's extrusion default): 0.32 kg at full size.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np
from numpy.random import Generator

from spirob.emulator.physics import HINGES, SIDES
from spirob.errors import ConfigError
from spirob.geometry import BASE_WIDTH, SpiralArm
from spirob.robot import MOTORS

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


BuildName = Literal["as_designed", "typical", "rough"]
BUILDS: tuple[str, ...] = get_args(BuildName)
AS_DESIGNED: BuildName = "as_designed"
TYPICAL: BuildName = "typical"  # what pipeline and trial play where nothing is said
STIFFEST_GEAR = 600.0  # N·m/rad at the winch, of the data sheet
TRIES = 100  # draws until a build can be; of rough ones one in a hundred cannot


@dataclass(frozen=True)
class Build:
    """All that the physics takes of how an arm is built.

    arm     lengths and outlines of the units; its guides are those of the drawing
    before  (SIDES, HINGES, 2) where each tendon leaves what is before a hinge, the mount or the
            unit nearer the base, as (x, y) from the hinge [m], the right side mirrored to +y
    after   (SIDES, HINGES, 2) where it enters the unit after the hinge
    sheet   numbers of the data sheet as drawn (`rig.SPREADS`); what is one number there may be
            one for each hinge or unit, (HINGES,), here
    rows    what was drawn of each row
    """

    arm: SpiralArm
    before: np.ndarray
    after: np.ndarray
    sheet: dict[str, np.ndarray]
    rows: dict[str, np.ndarray]

    @property
    def scale(self) -> np.ndarray:
        """Size of each unit over that of the published arm's first, (HINGES,)."""
        return self.arm.half_width * 2 / BASE_WIDTH

    def times(self, name: str, factor: np.ndarray) -> "Build":
        """The same with a number of the data sheet multiplied."""
        return replace(self, sheet=self.sheet | {name: self.sheet[name] * factor})


@dataclass(frozen=True)
class Row:
    """One thing in which builds differ.

    typical, rough  how much, as `draw` takes it; 0 is not at all
    unit            of that and of what is drawn
    draw            draws the row
    put             puts what was drawn into a build
    """

    typical: float
    rough: float
    unit: str
    reason: str
    draw: Callable[[Generator, float], np.ndarray]
    put: Callable[[Build, np.ndarray], Build]


def _scatter(rng: Generator, width: float) -> np.ndarray:
    """A factor for each hinge or unit, normal about 1 and cut at two deviations."""
    return 1.0 + width * np.clip(rng.standard_normal(HINGES), -2, 2)


def _within(*shape: int) -> Callable[[Generator, float], np.ndarray]:
    """Evenly between ±width."""
    return lambda rng, width: np.asarray(rng.uniform(-width, width, size=shape))


def _soft(rng: Generator, least: float) -> np.ndarray:
    """Of each gear, evenly in its logarithm."""
    return np.exp(rng.uniform(np.log(least), np.log(STIFFEST_GEAR), size=SIDES))


def _lengthen(build: Build, relative: np.ndarray) -> Build:
    length = build.arm.unit_length * (1.0 + relative)
    hinge = np.concatenate([[0.0], np.cumsum(length)[:-1]])
    return replace(build, arm=replace(build.arm, unit_length=length, hinge_position=hinge))


def _mount(build: Build, behind: np.ndarray) -> Build:
    before = build.before.copy()
    before[:, 0, 0] = -behind * build.scale[0]
    return replace(build, before=before)


def _shift(build: Build, along: np.ndarray) -> Build:
    moved = along * build.scale
    return _moved(build, 0.0, np.column_stack([moved, np.zeros(HINGES)]))


def _scatter_holes(build: Build, off: np.ndarray) -> Build:
    """Both mouths of a hole together; hole 0 is the mount's, hole k that of unit k."""
    scale = np.append(build.scale[0], build.scale)[:, None]
    return _moved(build, scale[0] * off[:, 0], scale[1:] * off[:, 1:])


def _moved(build: Build, mount: np.ndarray | float, units: np.ndarray) -> Build:
    """The holes of the mount and of the units elsewhere by (x, y) [m]."""
    before, after = build.before.copy(), build.after + units
    before[:, 0] += mount
    before[:, 1:] += units[..., :-1, :]
    return replace(build, before=before, after=after)


ROWS = {
    "hinge_stiffness": Row(
        0.05,
        0.12,
        "1",
        "hinges are printed flexures, as stiff as the cube of their thickness",
        lambda rng, width: _scatter(rng, width / 3) ** 3,
        lambda build, factor: build.times("stiffness", factor),
    ),
    "hinge_damping": Row(
        0.05,
        0.12,
        "1",
        "loss of the printed layers, beside that of the stiffness",
        _scatter,
        lambda build, factor: build.times("damping_time", factor),
    ),
    "unit_mass": Row(
        0.05,
        0.12,
        "1",
        "infill differs from unit to unit",
        _scatter,
        lambda build, factor: build.times("mass", factor),
    ),
    "stiffness_exponent": Row(
        0.0,
        0.3,
        "1",
        "k ∝ s^e: published values of e lie between 1 and 3",
        _within(),
        lambda build, more: build.times("stiffness", build.arm.scale**more),
    ),
    "unit_length": Row(0.003, 0.003, "1", "shrinkage of the print", _within(HINGES), _lengthen),
    "mount_hole": Row(
        0.010,
        0.020,
        "m",
        "behind the first hinge; mounts are each laboratory's own",
        lambda rng, width: np.asarray(rng.uniform(0.0, width)),
        _mount,
    ),
    "hole_shift": Row(
        0.002,
        0.006,
        "m",
        "along the units, in proportion to their size: designs differ",
        _within(),
        _shift,
    ),
    "hole": Row(
        0.0003,
        0.0003,
        "m",
        "each hole along its unit and in height, in proportion to its size: skew and shrinkage",
        _within(SIDES, HINGES + 1, 2),
        _scatter_holes,
    ),
    "drum": Row(
        0.01,
        0.01,
        "1",
        "each drum: how deep the line lies in its groove",
        _within(SIDES),
        lambda build, relative: build.times("winch_radius", 1.0 + relative),
    ),
    "gear_stiffness": Row(
        150.0,
        150.0,
        "N·m/rad",
        "each gear, from this to 600: printed housings, couplings and shafts give way, too",
        _soft,
        lambda build, stiffness: replace(build, sheet=build.sheet | {"gear_stiffness": stiffness}),
    ),
}


def require_build(name: str) -> None:
    """Raise ConfigError with the known names where there is no such build."""
    if name not in BUILDS:
        raise ConfigError(f"no build '{name}' of the emulated robot; known: {', '.join(BUILDS)}")


def built(name: str, arm: SpiralArm, sheet: dict[str, np.ndarray], rng: Generator) -> Build:
    """Build the drawing's arm; what cannot be is drawn again.

    sheet  drawn numbers of the data sheet
    Raises ConfigError where there is no such build or `TRIES` draws in a row cannot be.
    """
    require_build(name)
    before, after = (np.stack([guide] * SIDES) for guide in (arm.guide_before, arm.guide_after))
    plain = Build(arm, before, after, sheet, {})
    if name == AS_DESIGNED:
        return plain
    flaw = ""
    for _ in range(TRIES):
        build = plain
        rows = {key: row.draw(rng, getattr(row, name)) for key, row in ROWS.items()}
        for key, row in ROWS.items():
            build = row.put(build, rows[key])
        flaw = _flaw(build)
        if not flaw:
            return replace(build, rows=rows)
    raise ConfigError(f"emulated robot: none of {TRIES} builds '{name}' of this arm can be: {flaw}")


def _flaw(build: Build) -> str:
    """What cannot be, as the first hole of which it is true; empty where all can be."""
    length = build.arm.unit_length
    enter = build.after
    leave = build.before[:, 1:] + np.column_stack([length, np.zeros(HINGES)])[:-1]
    middle = (enter[:, :-1, 0] + leave[..., 0]) / 2
    edge = corners(build.arm)[1].min(axis=1)
    rooms = {
        "lies beyond the axis": enter[..., 1],
        "leaves its unit beyond the axis": leave[..., 1],
        "lies outside of the unit's edge": edge - enter[..., 1],
        "leaves its unit outside of the edge": edge[:-1] - leave[..., 1],
        "lies nearer to the base than its unit": middle,
        "lies nearer to the tip than its unit": length[:-1] - middle,
        "begins before the hole nearer to the base ends": enter[..., 0] - build.before[..., 0],
        "ends before it begins": leave[..., 0] - enter[:, :-1, 0],
    }
    for said, room in rooms.items():
        if np.any(wrong := room <= 0.0):
            side, unit = np.argwhere(wrong)[0]
            return f"the hole of unit {unit + 1} on the {MOTORS[side]} {said}"
    return ""
