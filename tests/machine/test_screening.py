"""Screening: an offer is what regressing on the differences themselves gives."""

import numpy as np
import pytest

from spirob.diagnosis.flexible import folds_of
from spirob.diagnosis.regression import left_out_linear
from spirob.effects import all_effects
from spirob.identify.fit import fit
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import Sizes
from spirob.machine.recordings.recording import prepare
from spirob.machine.search.screening import Screening
from tests.machine.rigs import description

SIZES = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")
NAMES = ("coulomb_friction", "quadratic_drag", "torque_ripple", "cogging")
LIBRARY = all_effects()
TEETH = 9.0


@pytest.fixture(scope="module")
def screening():
    """Around the fitted numbers of a rig with cogging, nine to a turn, and a little noise."""
    t = np.arange(0, 8, 4e-3)
    q = 2.0 * np.sin(2.1 * t) + 0.8 * np.sin(4.3 * t + 1.0)
    v = np.gradient(q, t)
    u = 0.03 * np.gradient(v, t) + 0.2 * v + 0.1 * np.sin(TEETH * q + 0.4)
    log = {"t": t, "q": q, "u": u + np.random.default_rng(0).normal(0.0, 0.02, len(t))}
    rig = RigFile.model_validate(description())
    effects = [LIBRARY[name] for name in NAMES]
    problem = InverseProblem(rig, None, [prepare("log", log, rig)], effects, SIZES, 0.02)
    start = {"rig.inertia": 0.02, "rig.viscous": 0.1}
    found = fit(problem, list(start), start, 10.0, steps=(1e-3,), exact=False, smooth=True)
    return Screening(problem, found, folds_of(problem.edges))


def test_the_hidden_wave_comes_first(screening):
    best = screening.offers(screening.problem.effects)[0]
    assert best.effect.name() == "cogging"
    orders = [best.values["cogging.order"] * k for k in (1.0, best.values["cogging.ratio"])]
    orders.append(best.values["cogging.order"] * best.values["cogging.third_ratio"])
    assert min(abs(order - TEETH) for order in orders) < 0.5


@pytest.mark.parametrize("name", ["torque_ripple", "cogging"])
def test_the_error_of_an_offer_is_that_of_its_differences(screening, name):
    """Of waves, whose amplitudes no bound holds here."""
    effect = LIBRARY[name]
    (offer,) = screening.offers([effect])
    shape = {k: v for k, v in offer.values.items() if k.split(".")[1] not in effect.neutral}
    at = {**screening.changes, **shape}
    table = screening.problem.table
    columns = []
    for field in effect.neutral:
        moved = 0.2 * (table.about[f"{name}.{field}"].nominal or 1e-3)
        point = {**at, f"{name}.{field}": moved}
        columns.append(screening.problem(point) - screening.residual)
    design = np.column_stack([screening.jacobian, *columns])
    free = np.full(design.shape[1], np.inf)
    left = left_out_linear(design, screening.residual, screening.folds, -free, free)
    assert np.mean(left**2) == pytest.approx(offer.error, rel=1e-3)


def test_an_effect_is_tried_once(screening):
    both = [LIBRARY["quadratic_drag"], LIBRARY["coulomb_friction"]]
    first = screening.offers(both)
    assert screening.untried(both) == []
    assert all(a is b for a, b in zip(first, screening.offers(both[::-1]), strict=True))


def test_a_pair_explains_what_either_does(screening):
    offers = screening.offers([LIBRARY["cogging"], LIBRARY["quadratic_drag"]])
    ((error, one, two),) = screening.pairs(offers)
    assert {one.effect, two.effect} == {o.effect for o in offers}
    assert error < 1.05 * min(o.error for o in offers)
