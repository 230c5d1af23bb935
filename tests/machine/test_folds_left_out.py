"""What is left of a fold is what a fit to the others leaves of it."""

import numpy as np

from spirob.diagnosis.flexible import folds_of
from spirob.diagnosis.regression import left_out_linear
from spirob.effects import all_effects
from spirob.identify.fit import fit
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import Sizes
from spirob.machine.recordings.recording import prepare
from spirob.machine.search.models import left_out
from spirob.machine.search.screening import room
from tests.machine.rigs import description

SIZES = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")
WIDTH = 1e-3


class Others:
    """A problem of which the samples of one fold count nothing."""

    def __init__(self, problem, counts):
        self.problem, self.counts = problem, counts

    def __getattr__(self, name):
        return getattr(self.problem, name)

    def __call__(self, changes):
        return self.problem(changes) * self.counts

    def many(self, points):
        return [self(point) for point in points]


def fitted(problem, start):
    return fit(problem, list(start), start, 10.0, steps=(WIDTH,), exact=False, smooth=True)


def moving(effect, hidden):
    """An axis that moves more and more, with something hidden, fitted with an effect or none."""
    t = np.arange(0, 8, 4e-3)
    q = (2.0 * np.sin(2.1 * t) + 0.8 * np.sin(4.3 * t + 1.0)) * np.linspace(0.3, 1.0, len(t))
    v = np.gradient(q, t)
    u = 0.03 * np.gradient(v, t) + 0.2 * v
    u = u + hidden(u, v) + np.random.default_rng(0).normal(0.0, 0.02, len(t))
    rig = RigFile.model_validate(description())
    effects = [all_effects()[effect]] if effect else []
    recording = prepare("log", {"t": t, "q": q, "u": u}, rig)
    problem = InverseProblem(rig, None, [recording], effects, SIZES, 0.02)
    start = {"rig.inertia": 0.02, "rig.viscous": 0.1}
    for name in effects:
        start |= {f"{effect}.{f}": p.nominal for f, p in name.parameters().items()}
    return problem, fitted(problem, start), folds_of(problem.edges)


def linear(problem, found, folds):
    bounds = room(problem.table, found)
    return left_out_linear(found.jacobian, found.residual, folds, *bounds)


def test_of_a_linear_model_it_is_the_regression():
    problem, found, folds = moving(None, lambda u, v: 0.0 * u)
    np.testing.assert_allclose(
        left_out(problem, found, folds, WIDTH), linear(problem, found, folds), atol=1e-9
    )


def test_of_a_bent_one_it_is_a_fit_to_the_others():
    """Breakaway friction whose shape one fold tells far better than the others."""
    problem, found, folds = moving("stribeck_friction", lambda u, v: 0.1 * np.tanh(v / 0.02))
    anew = np.empty_like(found.residual)
    for k in np.unique(folds):
        numbers = fitted(Others(problem, folds != k), found.changes).changes
        anew[folds == k] = problem(numbers)[folds == k]
    off = np.linalg.norm(left_out(problem, found, folds, WIDTH) - anew)
    assert off < 0.5 * np.linalg.norm(linear(problem, found, folds) - anew)
    assert off < 0.2 * np.linalg.norm(anew)


def test_a_fold_on_which_the_model_runs_away_is_missed_by_a_finite_error():
    problem, found, folds = moving(None, lambda u, v: 0.0 * u)
    wild = Others(problem, 1.0)
    wild.problem = lambda changes: np.where(folds < 2, np.nan, 1e200)
    wild.table = problem.table
    wild.many = lambda points: [found.residual for _ in points]
    left = left_out(wild, found, folds, WIDTH)
    assert np.isfinite(left**2).all()
    assert np.abs(left).min() > 1e5 * np.abs(found.residual).max()
