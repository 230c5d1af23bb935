"""Machines that training wraps are played by: about the model, each its own, none beyond bounds."""

from pathlib import Path

import numpy as np
import pytest

from pipeline.config import composed
from pipeline.model import plant
from pipeline.schema import validated
from pipeline.wraps import build_of
from spirob.effects import find_effects
from spirob.identify.builds import TOLERANCES

ROOT = Path(__file__).parents[2]
EFFECTS = find_effects(["capstan_friction"])
CHANGES = {"winch.efficiency": 0.7, "capstan_friction.friction": 0.06, "arm.damping_time": 0.03}


def config(*overrides):
    return validated(composed(ROOT, list(overrides)), "conf")


@pytest.fixture(scope="module")
def default():
    return config()


def drawn(config, count, changes=CHANGES):
    model = plant(config, EFFECTS)
    return model.table, [build_of(config, model, changes, k)[1] for k in range(count)]


def test_every_fitted_number_varies_evenly_about_the_model(default):
    table, machines = drawn(default, 400)
    spread = default.perceive.drawn.machines
    assert spread > 0
    values = dict(zip(table.names, table.vector(CHANGES), strict=True))
    for name in ("winch.efficiency", "arm.base_stiffness", "capstan_friction.friction"):
        factors = np.array([one[name] for one in machines]) / values[name]
        assert np.abs(factors - 1).max() <= spread + 1e-12
        assert np.mean(factors) == pytest.approx(1, abs=0.15 * spread)
        assert np.std(factors) == pytest.approx(spread / np.sqrt(3), rel=0.1)


def test_numbers_vary_apart_from_one_another(default):
    _, machines = drawn(default, 400)
    names = ["winch.efficiency", "motor.rotor_damping", "arm.base_stiffness"]
    rows = np.array([[one[name] for name in names] for one in machines])
    apart = np.corrcoef(rows.T)[np.triu_indices(3, 1)]
    assert np.abs(apart).max() < 0.2


def test_a_number_at_its_bound_stays_within(default):
    table, machines = drawn(default, 100, {"winch.efficiency": 1.0})
    for one in machines:
        low, high = table.bounds(one)
        values = np.array(list(one.values()))
        assert (low <= values).all()
        assert (values <= high).all()
    assert max(one["winch.efficiency"] for one in machines) == 1.0


def test_no_spread_is_the_model_itself():
    none = config("perceive.drawn.machines=0")
    table, machines = drawn(none, 3)
    for one in machines:
        np.testing.assert_array_equal(table.vector(one), table.vector(CHANGES))
    model = plant(none, EFFECTS)
    assert build_of(none, model, CHANGES, 0)[0] is model


def test_hinges_holes_and_what_a_fit_leaves_open_differ_from_build_to_build(default):
    model = plant(default, EFFECTS)
    one, two = (build_of(default, model, CHANGES, k) for k in range(2))
    assert len({one[0].scatter, two[0].scatter, model.scatter}) == 3
    assert not np.array_equal(one[0].off, two[0].off)
    assert all(one[1][name] != two[1][name] for name in TOLERANCES)
    assert model.off is None


def test_a_machine_depends_on_its_number_and_the_seed_alone(default):
    _, few = drawn(default, 3)
    _, more = drawn(config("perceive.drawn.count=700"), 5)
    assert more[:3] == few
    assert few[0] != few[1]
    assert drawn(config("perceive.seed=1"), 1)[1] != few[:1]
