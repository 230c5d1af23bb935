"""The gate names what moves nothing, what starts on a bound, and what cannot be told apart."""

import numpy as np
import pytest

from spirob.identify.identifiability import null_space, probe
from spirob.identify.problem import Effort
from spirob.parameter import Table
from spirob.plant import Rig
from tests.identify.known import residual, spirob

LOADS = ["motor.rotor_inertia", "motor.rotor_damping", "arm.base_stiffness"]
PULL = ["winch.efficiency", "motor.torque_constant"]


class Motor:
    """i = (J a + b w + k x + weight)/(η k_t), each relative to its nominal number."""

    table = Table(Rig().parts())
    effort = Effort("motor current", "A")
    rows = np.ones(300, dtype=bool)

    def __init__(self, weight: float = 0.0):
        self.signals = np.random.default_rng(5).normal(size=(300, 3))
        self.weight = weight

    def measured(self):
        return self.many([{}])[0]

    def many(self, points):
        return [self.current(point) for point in points]

    def current(self, point):
        def of(name):
            return point.get(name, nominal(name)) / nominal(name)

        load = self.signals @ [of(name) for name in LOADS] + self.weight
        return load / (of(PULL[0]) * of(PULL[1]))


def nominal(name):
    return Motor.table.values[Motor.table.position(name)]


def test_two_numbers_that_enter_as_a_product_are_named_and_the_last_is_held():
    gate = probe(Motor(), [PULL[0], LOADS[1], PULL[1]], {})
    assert "η (winch.efficiency) and k_t (motor.torque_constant) cannot be told" in gate.sentence
    assert "only their product moves the motor current" in gate.sentence
    assert gate.held == [PULL[1]]
    (direction,) = gate.null
    assert direction[PULL[0]] == pytest.approx(-direction[PULL[1]], rel=1e-3)


def test_without_a_weight_the_scale_of_force_is_unknown():
    gate = probe(Motor(), [PULL[0], *LOADS], {})
    assert "scale of force" in gate.sentence
    assert "known over η k_t alone; a trial with a known weight" in gate.sentence
    assert len(gate.held) == 1
    (direction,) = gate.null
    assert np.ptp(list(direction.values())) < 1e-3


def test_with_a_weight_every_combination_moves_the_current():
    gate = probe(Motor(weight=2.0), [PULL[0], *LOADS], {}, weighed=True)
    assert gate.null == gate.held == []
    assert gate.sentence.startswith("Every fitted parameter")


def test_all_at_once_leave_two_unknown_and_hold_two():
    gate = probe(Motor(), [*PULL, *LOADS], {})
    assert len(gate.null) == 2
    assert len(set(gate.held)) == 2
    again = probe(Motor(), [n for n in [*PULL, *LOADS] if n not in gate.held], {})
    assert again.null == []


def test_silent_numbers_and_starts_on_a_bound_are_named():
    about = Motor().table.about[PULL[0]]
    most = about.reach(about.nominal)[1]
    gate = probe(Motor(), [PULL[0], "arm.density"], {PULL[0]: most})
    assert gate.silent == ["arm.density"]
    assert gate.at_bound == [PULL[0]]
    assert "move no signal" in gate.sentence
    assert "On a bound from the start: winch.efficiency" in gate.sentence
    assert gate.moves["arm.density"] == 0.0
    # a tenth more pull, a tenth less current
    size = np.sqrt(np.mean(Motor().current({PULL[0]: most}) ** 2))
    assert gate.moves[PULL[0]] == pytest.approx(0.1 * size, rel=0.01)


def test_a_null_space_is_split_into_directions_of_few_numbers():
    slopes = np.zeros((50, 5))
    wave = np.sin(np.arange(50))
    slopes[:, 0], slopes[:, 1] = wave, -wave
    slopes[:, 2], slopes[:, 3] = np.cos(np.arange(50)), np.cos(np.arange(50))
    slopes[:, 4] = np.arange(50) / 50
    found = null_space(slopes, list("abcde"))
    assert sorted(sorted(direction) for direction in found) == [["a", "b"], ["c", "d"]]


def test_the_model_itself_cannot_tell_efficiency_from_torque_constant():
    data = residual(spirob(), {}, "validate")
    gate = probe(data, PULL, {})
    assert "only their product moves the motor current" in gate.sentence
