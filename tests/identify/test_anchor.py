"""The anchor holds what data say nothing of, and no more."""

from types import SimpleNamespace

import numpy as np
import pytest

from spirob.effects.motor.cogging import Cogging
from spirob.effects.motor.winding_heating import WindingHeating
from spirob.identify.fit import anchor_of
from spirob.identify.scaling import Scaling
from spirob.plant import Plant, Rig

NAMES = ["motor.rotor_inertia", "winding_heating.heating"]


def anchored():
    table = Plant(Rig(), [WindingHeating]).table
    problem = SimpleNamespace(table=table, rows=np.ones(4, dtype=bool), measured=lambda: np.ones(4))
    scaling = Scaling(table, NAMES)
    return anchor_of(problem, scaling), scaling, table


def cost(**values):
    anchor, scaling, table = anchored()
    here = {n: float(table.values[table.position(n)]) for n in NAMES}
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
