"""Several candidates at once: on a machine that is linear in its numbers, first order is exact."""

from types import SimpleNamespace

import numpy as np
import pytest

from spirob.diagnosis.screen import Alone, together
from spirob.effects import find_effects
from spirob.identify.fit import Fit
from spirob.identify.problem import Effort
from spirob.identify.scaling import Scaling
from spirob.parameter import Parameter, Table

OFFSET, FORCE = find_effects(["current_offset", "constant_force"])
NUMBER, FIRST, SECOND = "arm.a", "current_offset.offset", "constant_force.force"
TRUE = {NUMBER: 1.3, FIRST: 0.06, SECOND: 4.0}
RNG = np.random.default_rng(3)
SHARED = RNG.standard_normal(400)
# effects that look alike: each alone takes on what the other does too
COLUMNS = {
    NUMBER: RNG.standard_normal(400) + 0.2 * SHARED,
    FIRST: 20 * (SHARED + 0.5 * RNG.standard_normal(400)),
    SECOND: 0.3 * (SHARED + 0.5 * RNG.standard_normal(400)),
}


class Linear:
    """A problem whose residual is a sum of columns."""

    def __init__(self):
        about = {
            NUMBER: Parameter(1.0, 0.0, 3.0, "1", "a", "a number"),
            FIRST: OFFSET.parameters()["offset"],
            SECOND: FORCE.parameters()["force"],
        }
        self.table = Table.of(about, {FIRST: 0.0, SECOND: 0.0})
        self.edges, self.rows, self.block = np.array([0, 400]), np.ones(400, bool), 10
        self.effort = Effort("motor current", "A")

    def measured(self):
        return np.ones(400)  # little, so that the anchor at nominal numbers is weak

    def __call__(self, changes):
        values = dict(zip(self.table.names, self.table.values, strict=True)) | dict(changes)
        return sum(column * (values[n] - TRUE[n]) for n, column in COLUMNS.items())


PROBLEM = Linear()


def solved(names):
    """Least squares over some numbers, the others as in the table."""
    rows = np.column_stack([COLUMNS[n] for n in names])
    start = {n: float(PROBLEM.table.values[PROBLEM.table.position(n)]) for n in names}
    step = np.linalg.lstsq(rows, -PROBLEM(start), rcond=None)[0]
    return {n: start[n] + float(d) for n, d in zip(names, step, strict=True)}


def base():
    changes = solved([NUMBER])
    scaling = Scaling(PROBLEM.table, [NUMBER])
    u = scaling.scaled(changes)
    moved = PROBLEM(scaling.physical(u + 1e-3)) - PROBLEM(changes)
    estimates = {NUMBER: SimpleNamespace()}
    return Fit(changes, estimates, PROBLEM(changes), moved[:, None] / 1e-3, 0.0, 1)


def alone(effect, name):
    changes = solved([NUMBER, name])
    return Alone(effect, changes, PROBLEM(changes))


def test_two_effects_share_what_each_alone_took_whole():
    first, second = alone(OFFSET, FIRST), alone(FORCE, SECOND)
    assert first.changes[FIRST] > 1.1 * TRUE[FIRST]
    found = together(PROBLEM, base(), [first, second], scale=1e3)
    for name, value in TRUE.items():
        assert found[name] == pytest.approx(value, rel=0.02), name


def test_an_effect_that_explains_nothing_more_gets_no_share():
    first = alone(OFFSET, FIRST)
    useless = Alone(FORCE, {**base().changes, SECOND: -3.0}, PROBLEM({SECOND: -3.0}))
    found = together(PROBLEM, base(), [first, useless], scale=1e3)
    assert found[SECOND] == 0.0


def test_numbers_stay_in_their_bounds():
    first, second = alone(OFFSET, FIRST), alone(FORCE, SECOND)
    found = together(PROBLEM, base(), [first, second], scale=0.01)
    for name, about in PROBLEM.table.about.items():
        assert about.low <= found[name] <= about.high
