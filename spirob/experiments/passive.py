"""What the passive experiments share: a hit, its figure beside the robot's, its apparent period.

The response to a contact is the difference to the same trial without it: what drifts without a
contact is none.

Stiffness, inertia and give along the nominal straight arm explain why a hit near the tip is felt
more:

    stiffness  k_j of the last hinge before the place                                [N·m/rad]
    mass       Σ m_i of the units from that hinge on                                 [kg]
    inertia    Σ I_i + m_i (x_i - x_j)² of them about that hinge                     [kg·m²]
    give       ∂y/∂F = Σ_{x_k < x} (x - x_k)² / k_k, what a lateral newton moves the
               place by, as long as angles are small                                 [m/N]

Hinges spring linearly and the tendons hang through, as for a body that is hit at rest.

Whether a model's figure lies within a share of the robot's is told as far as noise lets one: both
are means over plays and have a standard error each.  With r = model/robot,

    |r - 1| + 2σ_r <= share   within        |r - 1| - 2σ_r > share   beyond

and what lies nearer to the border than that is not settled.

The apparent period of a signal that does not come back alike is told from several plays of a trial:

    line      the strongest line of the mean power spectrum: Welch's over `SEGMENT`, half of each
              shared with the next, and the mean of all plays' (Bartlett)
    interval  the mean over all plays of the time between peaks that rise by a given height

An arm that is hit at every turn of a wheel comes back irregularly: one play's strongest line is the
highest of many that noise has raised, and its mean over plays is the period of nothing; that of
the mean spectrum is.  How sure a period is tell the plays themselves, drawn again and again with
replacement (bootstrap), for the place of a maximum has no formula.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from spirob.can_protocol import AMPERE_PER_COUNT, COUNTS_PER_TURN
from spirob.experiments import Side, plan
from spirob.experiments.response import PERIOD
from spirob.geometry import PUBLISHED
from spirob.plant.body import hinge_stiffness, unit_inertia
from spirob.plant.rig import Arm
from spirob.unit_table import Geometry

# as conf/rig/spirob_direct.yaml
DIRECT = {
    "winch": {"gear_ratio": 1.0},
    "gains": {"velocity": 2.0, "integral": 12.0, "newton_per_ampere": 0.78, "drag": 0.25},
}
RADIUS = 0.02  # m, nominal, of the winch
DRUM_WIDTH, ALUMINIUM = 0.03, 2700.0  # m, kg/m³: the drum by its drawing
DRUM = np.pi / 2 * ALUMINIUM * DRUM_WIDTH * RADIUS**4  # kg·m², of a solid one
COUNTS_PER_METRE = COUNTS_PER_TURN / (2 * np.pi * RADIUS)  # without gear
COUNTS_PER_AMPERE = 1 / AMPERE_PER_COUNT
SURE = 2.0  # standard errors
WITHIN, BEYOND, OPEN = "within", "beyond", "not settled"
SEGMENT = 4.0  # s: lines 0.25 Hz apart
APART = 0.02  # s, least between two peaks
DRAWS = 400


def direct(bandwidth: float, **drive: float) -> dict[str, Any]:
    """The rig without gearbox, its drive's current loop at a bandwidth [Hz]."""
    return {**DIRECT, "drive": {"bandwidth": float(bandwidth), **drive}}


def both(current: float) -> dict[str, Any]:
    """Both motors at the same constant current [A]."""
    held = plan("current", {"kind": "constant", "value": float(current), "blend": 0.05})
    return {"left": held, "right": held}


def reconstructed(side: Side) -> str:
    """The signal that stands for i** [A]: a model's own, and the current that a robot measures."""
    return "current" if side.arm_current is None else "arm_current"


def per_unit(signal: str) -> float:
    """Counts of the drive (no gear) to a metre of displacement or to an ampere."""
    return COUNTS_PER_METRE if signal == "displacement" else COUNTS_PER_AMPERE


def difference(hit: Side, free: Side, signal: str, motor: int = 0) -> np.ndarray:
    """A signal with contact less the same without it, in counts of the drive (no gear)."""
    return per_unit(signal) * (hit.driven(signal, motor) - free.driven(signal, motor))


@dataclass(frozen=True)
class Profile:
    """At every place, (P,) each; units as in the head of this file."""

    stiffness: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    give: np.ndarray


def profile(places: Sequence[float], geometry: Geometry = PUBLISHED) -> Profile:
    """Of places in (0, 1], as shares of the arm's length from the base."""
    arm, whole = Arm(), geometry.arm()
    hinge, k = whole.hinge_position, hinge_stiffness(arm, whole)
    mass, inertia = unit_inertia(arm, whole)
    centre = hinge + whole.unit_length / 2
    rows = []
    for x in geometry.length * np.asarray(places, dtype=float):
        last = int(np.flatnonzero(hinge < x)[-1])
        beyond = slice(last, None)
        about = inertia[beyond] + mass[beyond] * (centre[beyond] - hinge[last]) ** 2
        give = np.sum((x - hinge[: last + 1]) ** 2 / k[: last + 1])
        rows.append((k[last], mass[beyond].sum(), about.sum(), give))
    return Profile(*np.array(rows).T)


@dataclass(frozen=True)
class Figure:
    """A figure and its standard error, in the same unit; NaN where it has none."""

    value: float
    error: float


def off(model: Figure, robot: Figure) -> Figure:
    """By which share of the robot's a model's figure is off: r - 1, with its sign."""
    ratio = model.value / robot.value
    error = np.hypot(model.error, ratio * robot.error) / abs(robot.value)
    return Figure(ratio - 1.0, float(error))


def compared(model: Figure, robot: Figure, share: float) -> str:
    """`WITHIN`, `BEYOND`, or `OPEN`."""
    apart = off(model, robot)
    doubt = SURE * apart.error
    if abs(apart.value) + doubt <= share:
        return WITHIN
    return BEYOND if abs(apart.value) - doubt > share else OPEN


def percent(share: Figure) -> str:
    """As text, its standard error behind it."""
    return f"{share.value:+.1%} ± {share.error:.1%}"


def mean_spectrum(signals: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz], and amplitudes of the lines in the mean spectrum of all plays."""
    frequency, power = spectra(signals)
    return frequency, np.sqrt(2 * power.mean(axis=0))


def spectra(signals: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz], and the power spectrum of each play (plays, frequencies)."""
    values = np.stack(signals)
    n = min(values.shape[1], round(SEGMENT / PERIOD))
    found: tuple[np.ndarray, np.ndarray] = scipy.signal.welch(
        values, 1 / PERIOD, nperseg=n, nfft=8 * n, detrend="linear", scaling="spectrum"
    )
    return found


def line(signals: Sequence[np.ndarray], shortest: float, longest: float) -> tuple[Figure, float]:
    """Period [s] within two bounds, and amplitude, of the strongest line of all plays."""
    frequency, power = spectra(signals)
    band = (frequency >= 1 / longest) & (frequency <= 1 / shortest)
    periods, power = 1 / frequency[band], power[:, band]
    size = float(np.sqrt(2 * power.mean(axis=0).max()))
    return bootstrap(power, lambda each: float(periods[np.argmax(each.mean(axis=0))])), size


def interval(signals: Sequence[np.ndarray], least: float) -> Figure:
    """Mean time [s] between peaks that rise by `least` from their surroundings; NaN without."""
    gaps = []
    for values in signals:
        peaks, _ = scipy.signal.find_peaks(values, prominence=least, distance=round(APART / PERIOD))
        gaps.append((PERIOD * np.ptp(peaks), len(peaks) - 1) if len(peaks) else (0.0, 0))
    return bootstrap(np.array(gaps), _ratio)


def _ratio(each: np.ndarray) -> float:
    whole, count = each.sum(axis=0)
    return float(whole / count) if count else float("nan")


def highest(values: np.ndarray) -> float:
    """By how much the highest peak of a signal rises from its surroundings; 0 without any."""
    _, about = scipy.signal.find_peaks(values, prominence=0.0)
    return float(np.max(about["prominences"], initial=0.0))


def bootstrap(plays: np.ndarray, rule: Callable[[np.ndarray], float]) -> Figure:
    """A rule's figure of all plays (plays, ...), and its deviation over plays drawn of them.

    Of few plays draws differ too little, by √(1 - 1/n), which is given back; of one the error is
    NaN.
    """
    n = len(plays)
    if n < 2:
        return Figure(rule(plays), float("nan"))
    drawn = np.random.default_rng(0).integers(0, n, (DRAWS, n))
    deviation = np.std([rule(plays[each]) for each in drawn])
    return Figure(rule(plays), float(deviation * np.sqrt(n / (n - 1))))
