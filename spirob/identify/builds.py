"""By how much builds of one machine differ after each is fitted: weights and floor of a diagnosis.

Nobody builds to the drawing, and a fit takes up only a part of that.  So builds are drawn in the
model about the machine at hand, and played in its own trials,

    r_b = r(p, b) - r(p, 0),      d_b = argmin Σ_train w (r_b + J d)²,      e_b = r_b + J d_b,

J being the slopes by the fitted numbers.  What e_b leaves of the trials that no fit has seen is
what the very same fit leaves of such a machine with nothing hidden in it.  Nothing that was
measured takes part, so an effect does not raise the floor under itself.

Where an arm is about to buckle, builds are far apart for a moment.  Such a moment tells little of a
machine whose build is not known, so each cycle counts by its own variance,

    w² ~ 1/(s² + mean_b e_b²),

s being what the model is right to anyhow, as in generalised least squares with the correlations
left out.  Weighted so, floor and error stand on what builds agree on.  Weights and floor are drawn
apart: a floor of the builds that made the weights would be too low.

The mean square of e_b is a sum of squares over the few ways in which scatter shows, so its draws
are taken as those of a multiple of χ² with as many degrees of freedom as their spread tells, and
one more build beside n drawn ones leaves no more than

    m = mean e_b²,    ν = 2 m²/var e_b²,    share² = m F_{ν, nν}(LEVEL)

(Satterthwaite, Biometrics Bulletin 2, 1946), which is steadier than the largest of them.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
import scipy

from spirob.errors import SimulationError
from spirob.identify.descent import linear_step, slopes_ahead
from spirob.identify.fit import STEPS, anchor_of
from spirob.identify.problem import effort_rms
from spirob.identify.residual import Residual
from spirob.identify.scaling import Scaling
from spirob.parameter import Table
from spirob.plant import Plant

SCATTER = 0.05  # of printed flexures, one deviation: stiffness goes with the cube of the thickness
FARTHEST = 2.0  # deviations
HOLE = 3e-4  # m, either way, of each hole over the size of its unit: skew and shrinkage of a print
DRAWS = 19  # builds
LEVEL = 0.975  # of builds leave less than the floor
RESOLUTION = 0.003  # of the effort: to which the model itself is right, cut into hinges and steps
SURE = 1.96  # deviations
FLOOR, WEIGHTS = 0, 1  # seeds of the builds of either

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


@dataclass(frozen=True)
class Builds:
    """The builds of a machine that are drawn about it.

    numbers  where the machine stands, among them those fitted;  names  of these
    scale    of the robust loss
    widths   by how much other numbers of a build may differ, at 95 %; of those fitted, how far the
             fit may be off: what a step puts right does not count, hinges that snap otherwise do
    single   whether single holes lie off their places, too
    """

    numbers: Mapping[str, float]
    names: Sequence[str]
    scale: float
    widths: Mapping[str, float] = field(default_factory=lambda: TOLERANCES)
    single: bool = True

    def left(self, train: Residual, further: Sequence[Residual], seed: int) -> Iterator[np.ndarray]:
        """e_b of all these trials, (N,), of each build that can be played."""
        plant = train.plant.coarse()  # what builds differ by hardly depends on the steps
        trials = [trial for of in (train, *further) for trial in of.trials]
        whole, fitted = replace(train, plant=plant, trials=trials), train.edges[-1]
        table, names, numbers = whole.table, self.names, self.numbers
        values = dict(zip(table.names, table.vector(numbers).tolist(), strict=True))
        scaling, at = Scaling(table, names), whole(numbers)
        u = scaling.scaled(values)
        held = {n: v for n, v in numbers.items() if n not in names}
        slopes = slopes_ahead(whole, scaling, u, held, at, STEPS[-1])
        low, high = scaling.around(u)
        room = low - u, high - u
        still = anchor_of(train, scaling).rows(u)[0], np.zeros(len(names))
        rng, units = np.random.default_rng(seed), plant.rig.units
        for _ in range(DRAWS):
            factors, off = hinges(rng, units), holes(rng, units) if self.single else None
            build = replace(whole, plant=plant.scattered(factors, off))
            try:
                apart = build({**numbers, **apart_by(rng, self.widths, values, table)}) - at
            except SimulationError:
                continue  # such a build cannot be played
            step = linear_step(apart[:fitted], slopes[:fitted], room, self.scale, still)
            yield apart + slopes @ step


def weighted(
    residuals: Mapping[str, Residual], builds: Builds, right: float
) -> dict[str, Residual]:
    """The same trials by role, each cycle weighted by how far builds are apart in it.

    right  to which the model is in any case, RMS [A]

    All signals of a cycle have one weight.  Of each role the mean square of weights is one, so that
    an error stays an RMS in its unit, and noise what it is.
    """
    roles = sorted(residuals, key=lambda role: role != "train")
    plain = {role: residuals[role].unweighted() for role in roles}
    train, *further = plain.values()
    apart = [e**2 for e in builds.left(train, further, WEIGHTS)]
    if not apart:
        return plain
    ends = np.cumsum([of.edges[-1] for of in plain.values()])[:-1]
    squares = zip(plain.items(), np.split(np.mean(apart, axis=0), ends), strict=True)
    return {role: _weighted(of, square, right) for (role, of), square in squares}


def _weighted(of: Residual, square: np.ndarray, right: float) -> Residual:
    """With weights by the mean square in which builds are apart, (N,)."""
    cycles = [of.cycles(t) for t in of.trials]
    parts = [
        square[a:b].reshape(-1, len(own))
        for (a, b), own in zip(pairwise(of.edges), cycles, strict=True)
    ]
    weights = [(right**2 + part.sum(axis=0)) ** -0.5 for part in parts]
    size = np.sqrt(np.mean(np.concatenate(weights) ** 2))
    trials = [
        replace(t, weight=np.interp(np.arange(len(t.current)), own, weight / size))
        for t, own, weight in zip(of.trials, cycles, weights, strict=True)
    ]
    return replace(of, trials=trials)


def counting(problem: Residual) -> float:
    """Share of the samples that a mean over the weighted ones is worth: (Σw²)²/(n Σw⁴)."""
    square = np.concatenate([problem.weight(t) for t in problem.trials]) ** 2
    return float(np.mean(square) ** 2 / np.mean(square**2))


def floor_of(train: Residual, unseen: Residual, builds: Builds) -> Floor:
    """The floor of a diagnosis that fits the numbers to `train` and judges by `unseen`."""
    fitted = train.edges[-1]
    left = [
        float(np.mean(e[fitted:][unseen.rows] ** 2)) for e in builds.left(train, [unseen], FLOOR)
    ]
    share = np.sqrt(most_of(left)) / effort_rms(unseen)
    return Floor(max(share, RESOLUTION), _reason(share, len(left), builds, counting(unseen)))


def most_of(squares: Sequence[float]) -> float:
    """What a share of LEVEL stays below of that of which these mean squares were drawn."""
    if len(set(squares)) < 2:
        return float(np.sum(squares[:1]))
    mean, spread = float(np.mean(squares)), float(np.var(squares, ddof=1))
    freedom = 2.0 * mean**2 / spread
    return mean * float(scipy.stats.f.ppf(LEVEL, freedom, freedom * len(squares)))


def anew(
    plant: Plant,
    changes: Mapping[str, float],
    rng: np.random.Generator,
    widths: Mapping[str, float] = TOLERANCES,
) -> tuple[Plant, dict[str, float]]:
    """A build of a plant with these numbers, and its own: those in `widths` differ by them at 95 %.

    Its hinges and holes scatter; what is not in `widths` is as in `changes`.
    """
    table, units = plant.table, plant.rig.units
    known = dict(zip(table.names, table.vector(changes).tolist(), strict=True))
    build = plant.scattered(hinges(rng, units), holes(rng, units))
    return build, {**changes, **apart_by(rng, widths, known, table)}


def apart_by(
    rng: np.random.Generator,
    widths: Mapping[str, float],
    values: Mapping[str, float],
    table: Table,
) -> dict[str, float]:
    """Numbers of a build that differ from these values by widths at 95 %, within their bounds."""
    drawn = {n: values[n] + rng.standard_normal() * w / SURE for n, w in widths.items()}
    return {n: float(np.clip(v, *table.bounds([n]))[0]) for n, v in drawn.items()}


def _reason(share: float, drawn: int, builds: Builds, counting: float) -> str:
    off = f" and holes that lie off by up to {1e3 * HOLE:.1f} mm" if builds.single else ""
    widths = ", ".join(builds.widths)
    also = f", and {widths} by what is not known of them" if widths else ""
    grain = f"; the model itself is right to {RESOLUTION:.1%}, which is more"
    worth = (
        " Every sample counts by how far builds are apart there, here and in every error: that is "
        f"worth {counting:.0%} of the samples."
    )
    return (
        f"{drawn} builds of this machine, drawn with hinges that differ by {SCATTER:.0%}"
        f"{off}{also}, leave up to {share:.2%} of the "
        f"effort in trials that no fit has seen{grain if share < RESOLUTION else ''}."
        f"{worth if counting < 1.0 else ''}"
    )
