"""By how much builds of one machine differ after each is fitted: the floor of a diagnosis.

Nobody builds to the drawing, and a fit takes up only a part of that.  So builds are drawn in the
model about the machine at hand, and played in its own trials,

    r_b = r(p, b) - r(p, 0),      d_b = argmin Σ_train w (r_b + J d)²,      e_b = r_b + J d_b,

J being the slopes by the fitted numbers.  What e_b leaves of the trials that no fit has seen is
what the very same fit leaves of such a machine with nothing hidden in it.  Nothing that was
measured takes part, so an effect does not raise the floor under itself.

The mean square of e_b is a sum of squares over the few ways in which scatter shows, so its draws
are taken as those of a multiple of χ² with as many degrees of freedom as their spread tells, and
one more build beside n drawn ones leaves no more than

    m = mean e_b²,    ν = 2 m²/var e_b²,    share² = m F_{ν, nν}(LEVEL)

(Satterthwaite, Biometrics Bulletin 2, 1946), which is steadier than the largest of them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import f

from spirob.errors import SimulationError
from spirob.identify.descent import linear_step, slopes_ahead
from spirob.identify.fit import STEPS, anchor_of
from spirob.identify.problem import effort_rms
from spirob.identify.residual import Residual
from spirob.identify.scaling import Scaling

SCATTER = 0.05  # of printed flexures, one deviation: stiffness goes with the cube of the thickness
FARTHEST = 2.0  # deviations
HOLE = 3e-4  # m, either way, of each hole over the size of its unit: skew and shrinkage of a print
DRAWS = 19  # builds
LEVEL = 0.975  # of builds leave less than the floor
RESOLUTION = 0.003  # of the effort: to which the model itself is right, cut into hinges and steps
SURE = 1.96  # deviations

# By how much a build may differ, at 95 %, and why
TOLERANCES = {
    "holes.shift": 0.05,  # of a unit's length: 1 to 2 mm, as designs differ
    "holes.mount": 0.005,  # m: mounts are each laboratory's own
    "holes.height": 0.03,  # 1 mm of the base unit's 38
    "arm.stiffness_exponent": 0.3,  # published values lie between 1 and 3
    "arm.stiffness_bow": 0.15,  # flexures 5 % thinner half-way along the arm
    "winch.radius_difference": 0.01,  # how deep the line lies in its groove
}


@dataclass(frozen=True)
class Floor:
    """What builds of a machine differ by.

    share   RMS error that all but one in forty of them leave at most, over that of the effort; at
            least `RESOLUTION`
    reason  a sentence
    """

    share: float
    reason: str


def hinges(rng: np.random.Generator, units: int) -> np.ndarray:
    """Stiffness of each hinge of a build, over the drawing's, (units,)."""
    drawn = rng.standard_normal(units)
    return np.asarray(1.0 + SCATTER * np.clip(drawn, -FARTHEST, FARTHEST))


def holes(rng: np.random.Generator, units: int) -> np.ndarray:
    """How far the holes of a build lie from their places, as `Plant.scattered` takes it."""
    return np.asarray(rng.uniform(-HOLE, HOLE, (2, units + 1, 2)))


def floor_of(
    train: Residual,
    unseen: Residual,
    numbers: Mapping[str, float],
    names: Sequence[str],
    scale: float,
    widths: Mapping[str, float] = TOLERANCES,
    single: bool = True,
) -> Floor:
    """The floor of a diagnosis that fits `names` to `train` and judges by `unseen`.

    numbers  where the machine stands, among them those fitted;  scale  of the robust loss
    widths   by how much other numbers of a build may differ, at 95 %; of those fitted, how far the
             fit may be off: what a step puts right does not count, hinges that snap otherwise do
    single   whether single holes lie off their places, too
    """
    plant = train.plant.coarse()  # what builds differ by hardly depends on the steps
    both = replace(train, plant=plant, trials=[*train.trials, *unseen.trials])
    fitted = train.edges[-1]
    values = dict(zip(both.table.names, both.table.vector(numbers).tolist(), strict=True))
    scaling, at = Scaling(both.table, names), both(numbers)
    u = scaling.scaled(values)
    held = {n: v for n, v in numbers.items() if n not in names}
    slopes = slopes_ahead(both, scaling, u, held, at, STEPS[-1])
    low, high = scaling.around(u)
    anchor, _ = anchor_of(train, scaling).rows(u)
    rng, left, units = np.random.default_rng(0), [], both.plant.rig.units
    for _ in range(DRAWS):
        factors, off = hinges(rng, units), holes(rng, units) if single else None
        build = replace(both, plant=both.plant.scattered(factors, off))
        try:
            apart = build({**numbers, **_drawn(rng, widths, values, both)}) - at
        except SimulationError:
            continue  # such a build cannot be played
        room, still = (low - u, high - u), (anchor, np.zeros(len(names)))
        step = linear_step(apart[:fitted], slopes[:fitted], room, scale, still)
        missed = (apart + slopes @ step)[fitted:]
        left.append(float(np.mean(missed[unseen.rows] ** 2)))
    share = np.sqrt(most_of(left)) / effort_rms(unseen)
    return Floor(max(share, RESOLUTION), _reason(share, len(left), widths, single))


def most_of(squares: Sequence[float]) -> float:
    """What a share of LEVEL stays below of that of which these mean squares were drawn."""
    if len(set(squares)) < 2:
        return float(np.sum(squares[:1]))
    mean, spread = float(np.mean(squares)), float(np.var(squares, ddof=1))
    freedom = 2.0 * mean**2 / spread
    return mean * float(f.ppf(LEVEL, freedom, freedom * len(squares)))


def _drawn(
    rng: np.random.Generator,
    widths: Mapping[str, float],
    values: Mapping[str, float],
    problem: Residual,
) -> dict[str, float]:
    about = problem.table.about
    drawn = {n: values[n] + rng.standard_normal() * w / SURE for n, w in widths.items()}
    return {n: float(np.clip(v, about[n].low, about[n].high)) for n, v in drawn.items()}


def _reason(share: float, builds: int, widths: Mapping[str, float], single: bool) -> str:
    off = f" and holes that lie off by up to {1e3 * HOLE:.1f} mm" if single else ""
    also = f", and {', '.join(widths)} by what is not known of them" if widths else ""
    grain = f"; the model itself is right to {RESOLUTION:.1%}, which is more"
    return (
        f"{builds} builds of this machine, drawn with hinges that differ by {SCATTER:.0%}"
        f"{off}{also}, leave up to {share:.2%} of the "
        f"effort in trials that no fit has seen{grain if share < RESOLUTION else ''}."
    )
