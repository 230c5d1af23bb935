"""A fit finds the numbers of the model that made the data, and says how sure it is.

The anchor holds what data say nothing of, and no more.

Several starts lead out of a valley, and what the data do not tell goes back to nominal.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from spirob.effects.motor.cogging import Cogging
from spirob.effects.motor.winding_heating import WindingHeating
from spirob.identify.fit import anchor_of, best_start, differences, fit, fit_identifiable
from spirob.identify.identifiability import probe
from spirob.identify.scaling import Scaling
from spirob.plant import Plant, Rig
from tests.identify.known import NOISE, residual, spirob
from tests.identify.linear import Linear

NAMES = ["winch.efficiency", "motor.rotor_damping", "arm.base_stiffness"]
TRUE = {"winch.efficiency": 0.71, "motor.rotor_damping": 8e-5, "arm.base_stiffness": 0.2}


@pytest.fixture(scope="module")
def data():
    return residual(spirob(), TRUE)


@pytest.fixture(scope="module")
def found(data):
    return fit(data, NAMES, {}, scale=0.05)


def test_the_true_numbers_leave_the_noise(data):
    passed = np.std(data.filter(np.random.default_rng(0).standard_normal(20_000)))
    assert np.std(data(TRUE)[data.rows]) == pytest.approx(NOISE * passed, rel=0.25)


def test_the_numbers_come_back(found):
    for name, true in TRUE.items():
        assert found.estimates[name].value == pytest.approx(true, rel=0.03)


def test_the_intervals_are_narrow_and_near_the_truth(found):
    for name, true in TRUE.items():
        estimate = found.estimates[name]
        width = estimate.high - estimate.low
        assert estimate.low < estimate.value < estimate.high
        assert 0 < width < 0.2 * true
        assert abs(estimate.value - true) < 1.5 * width
        assert not estimate.at_bound


@pytest.mark.parametrize("start", [(0.95, 3e-4, 0.1), (0.65, 3e-5, 0.06), (0.9, 2e-4, 0.5)])
def test_a_fit_from_elsewhere_ends_in_the_same_place(data, found, start):
    start = dict(zip(NAMES, start, strict=True))
    again = fit(data, NAMES, start, scale=0.05)
    for name in NAMES:
        assert again.estimates[name].value == pytest.approx(found.estimates[name].value, rel=0.02)


def test_the_same_fit_twice_gives_the_same_bits(data, found):
    again = fit(data, NAMES, {}, scale=0.05)
    assert again.changes == found.changes
    assert np.array_equal(again.residual, found.residual)


def test_outliers_do_not_move_the_fit(data, found):
    spoiled = residual(spirob(), TRUE)
    spoiled._measured[0] = spoiled._measured[0].copy()
    spoiled._measured[0][::40] += 2.0
    robust = fit(spoiled, NAMES, {}, scale=0.02)
    for name, true in TRUE.items():
        assert robust.estimates[name].value == pytest.approx(true, rel=0.15)


def test_derivatives_agree_with_wider_central_differences(data):
    scaling = Scaling(data.plant.table, NAMES)
    u = scaling.scaled(TRUE)
    columns = differences(data, scaling, u, {})
    for k in range(len(NAMES)):
        step = np.zeros(len(NAMES))
        step[k] = 5e-3
        ahead, behind = (data(scaling.physical(u + sign * step)) for sign in (1, -1))
        central = (ahead - behind) / 1e-2
        assert np.linalg.norm(columns[:, k] - central) < 0.02 * np.linalg.norm(central)


def test_a_number_that_moves_nothing_is_named_before_the_fit(data):
    gate = probe(data, [*NAMES, "drive.voltage_limit"], {})
    assert gate.silent == ["drive.voltage_limit"]
    assert "drive.voltage_limit" in gate.sentence


ANCHORED = ["motor.rotor_inertia", "winding_heating.heating"]


def anchored():
    table = Plant(Rig(), [WindingHeating]).table
    problem = SimpleNamespace(table=table, rows=np.ones(4, dtype=bool), measured=lambda: np.ones(4))
    scaling = Scaling(table, ANCHORED)
    return anchor_of(problem, scaling), scaling, table


def cost(**values):
    anchor, scaling, table = anchored()
    here = {n: float(table.values[table.position(n)]) for n in ANCHORED}
    return anchor.cost(scaling.scaled(here | {k.replace("__", "."): v for k, v in values.items()}))


def test_nominal_numbers_and_absent_effects_cost_nothing():
    assert cost() == 0.0


def test_an_effect_of_some_other_machines_size_costs_less_than_a_doubled_number():
    about = WindingHeating.parameters()["heating"]
    effect = cost(winding_heating__heating=6.0 * about.nominal)
    number = cost(motor__rotor_inertia=2.0 * Rig().motor.rotor_inertia)
    assert 0.0 < effect < number


def test_the_cost_grows_with_the_square():
    about = WindingHeating.parameters()["heating"]
    one, two = (cost(winding_heating__heating=k * about.nominal) for k in (1.0, 2.0))
    assert two == pytest.approx(4.0 * one)


def test_a_shape_is_held_where_its_fit_begins():
    table = Plant(Rig(), [Cogging]).table
    problem = SimpleNamespace(table=table, rows=np.ones(4, dtype=bool), measured=lambda: np.ones(4))
    scaling = Scaling(table, ["motor.rotor_inertia", "cogging.order"])
    start = {"motor.rotor_inertia": 1.1 * Rig().motor.rotor_inertia, "cogging.order": 7.0}
    free, held = (anchor_of(problem, scaling, begin) for begin in ({}, start))
    here = scaling.scaled(start)
    inertia = scaling.scaled({**start, "cogging.order": Cogging.parameters()["order"].nominal})
    assert 0.0 < held.cost(here) == pytest.approx(free.cost(inertia))
    assert free.cost(here) > held.cost(here)


SCALE = 0.05


class TwoValleys(Linear):
    """A shallow valley at the nominal number and a deep one at 2.5 times of it."""

    deep = np.log(2.5)

    def __init__(self):
        super().__init__([0.1], [1.0], 0.0)

    def __call__(self, changes):
        u = np.log(changes.get(self.names[0], 1.0))
        near = 0.7 * np.exp(-((u / 0.25) ** 2))
        height = 1.0 - near - np.exp(-(((u - self.deep) / 0.3) ** 2))
        return np.full(self.edges[-1], 0.01 * height)


def test_one_start_stays_in_its_valley_and_several_find_the_deeper_one():
    problem = TwoValleys()
    name = problem.names[0]
    alone = fit(problem, [name], {}, SCALE, exact=False)
    assert abs(np.log(alone.changes[name])) < 0.3
    begun = best_start(problem, [name], {}, SCALE, count=16)
    found = fit(problem, [name], begun, SCALE, exact=False)
    assert np.log(found.changes[name]) == pytest.approx(problem.deep, abs=0.1)


def test_the_same_starts_every_time():
    problem = TwoValleys()
    starts = [best_start(problem, problem.names, {}, SCALE, count=8, seed=3) for _ in range(2)]
    assert starts[0] == starts[1]


def test_a_number_that_the_data_hardly_hold_goes_back_to_nominal():
    problem = Linear([0.3, 1e-5], [1.3, 3.0], 1e-3)
    sure, vague = problem.names
    found, left = fit_identifiable(problem, problem.names, {vague: 1.7}, SCALE)
    assert left == [vague]
    assert list(found.estimates) == [sure]
    assert found.changes[vague] == 1.0  # wherever the search began
    assert found.changes[sure] == pytest.approx(1.3, rel=0.01)


class Buckles(Linear):
    """As if the search lost its way once the number that is hardly told stands at nominal."""

    def __call__(self, changes):
        lost = 1.0 if changes.get(self.names[1], 1.0) == 1.0 else 0.0
        return super().__call__(changes) + 0.2 * lost


def test_a_fit_that_loses_its_way_without_a_number_is_not_taken():
    problem = Buckles([0.3, 1e-5], [1.3, 3.0], 1e-3)
    sure, vague = problem.names
    found, left = fit_identifiable(problem, problem.names, {vague: 1.7}, SCALE)
    assert left == []
    assert list(found.estimates) == [sure, vague]
    assert found.changes[sure] == pytest.approx(1.3, rel=0.01)


def test_drums_that_differ_show_in_the_length_that_the_other_motor_winds_in():
    """Of 0.6 %: more than a whole model may leave, and found where their difference is fitted."""
    apart = residual(spirob(), {"winch.radius_difference": 0.006})
    alike = fit(apart, NAMES, {}, scale=0.05)
    own = fit(apart, [*NAMES, "winch.radius_difference"], {}, scale=0.05)
    assert own.estimates["winch.radius_difference"].value == pytest.approx(0.006, abs=3e-4)
    other = np.setdiff1d(np.arange(len(own.residual)), np.arange(len(own.residual))[apart.rows])
    lengths = [np.sqrt(np.mean(found.residual[other] ** 2)) for found in (own, alike)]
    assert lengths[1] > 2 * lengths[0]
