"""The same motion in other quantities and units is the same recording."""

import numpy as np
import pytest

from spirob.effects import find_effects
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import Sizes
from spirob.machine.recordings.recording import prepare
from spirob.machine.search.leftovers import depends_on, rig_ceiling
from spirob.machine.search.preparation import applicable
from tests.machine.rigs import description

T = np.arange(0, 8, 2e-3)
Q = 0.8 * np.sin(2.1 * T) + 0.3 * np.sin(5.3 * T) - 0.3 * np.sin(0.7 * T)
V = 0.8 * 2.1 * np.cos(2.1 * T) + 0.3 * 5.3 * np.cos(5.3 * T) - 0.3 * 0.7 * np.cos(0.7 * T)
U = 0.3 * V + 0.05 * np.sin(9 * T)


def read(columns, **changes):
    return prepare(
        "log", {"t": T, "q": Q, "u": U, **columns}, RigFile.model_validate(description(**changes))
    )


PLAIN = read({})


def same(made, names=("q", "v", "a", "effort"), rtol=1e-9):
    for name in names:
        wanted = getattr(PLAIN.pieces[0], name)
        found = getattr(made.pieces[0], name)
        np.testing.assert_allclose(found, wanted, atol=rtol * np.abs(wanted).max())


@pytest.mark.parametrize(
    ("unit", "size", "further"),
    [
        ("deg", 180 / np.pi, {}),
        ("turn", 1 / (2 * np.pi), {}),
        ("mrad", 1e3, {}),
        ("tick", 4096 / (2 * np.pi), {"per_turn": 4096}),
    ],
)
def test_a_position_in_any_unit_is_the_same_motion(unit, size, further):
    position = {"column": "q", "unit": unit, **further}
    same(read({"q": size * Q}, position=position))


@pytest.mark.parametrize(
    ("unit", "size", "further"),
    [
        ("rad/s", 1.0, {}),
        ("rpm", 60 / (2 * np.pi), {}),
        ("deg/s", 180 / np.pi, {}),
        ("rev/s", 1 / (2 * np.pi), {}),
        ("tick/s", 1024 / (2 * np.pi), {"per_turn": 1024}),
    ],
)
def test_a_velocity_alone_is_the_same_speed_and_says_what_it_cannot(unit, size, further):
    velocity = {"column": "v", "unit": unit, **further}
    made = read({"v": size * V}, position=None, velocity=velocity)
    inside = slice(200, -200)
    np.testing.assert_allclose(
        made.pieces[0].v[inside], PLAIN.pieces[0].v[inside], atol=2e-3 * np.abs(V).max()
    )
    same(made, ("effort",))
    assert any("what depends on position cannot be told" in said for said in made.said)


def test_the_effort_of_a_controller_is_that_of_the_speed_in_its_scale():
    """The log's speed is in another unit than described; the controller's own was not."""
    found = [
        read(
            {"r": Q + 0.05 * np.sin(3 * T), "v": scale * V},
            effort={"from": "control", "unit": "N·m", "kind": "torque", "origin": "command"},
            control={"kp": 4.0, "kd": 0.3},
            reference={"column": "r", "unit": "rad"},
            velocity={"column": "v", "unit": "rad/s"},
        )
        for scale in (1.0, 57.3, -1.0)
    ]
    for made in found[1:]:
        np.testing.assert_allclose(
            made.pieces[0].effort[100:-100], found[0].pieces[0].effort[100:-100], atol=3e-3
        )


def test_a_duty_with_its_supply_is_a_voltage():
    volts = 24.0 + 2.0 * np.sin(0.3 * T)
    effort = {"column": "d", "unit": "%", "kind": "duty"}
    fixed = read({"d": 100 * U / 24.0}, effort={**effort, "supply": 24.0})
    logged = read(
        {"d": 100 * U / volts, "bus": 1e3 * volts},
        effort={**effort, "supply": {"column": "bus", "unit": "mV"}},
    )
    for made in (fixed, logged):
        same(made, rtol=1e-6)


@pytest.mark.parametrize(
    ("effort", "known", "told"),
    [
        ({"unit": "A", "kind": "current"}, {}, True),
        ({"unit": "V", "kind": "voltage"}, {}, False),
        ({"unit": "1", "kind": "duty", "supply": 12.0}, {}, False),
        ({"unit": "V", "kind": "voltage"}, {"back_emf": 0.1}, True),
    ],
)
def test_laws_of_the_current_are_asked_where_the_effort_tells_it(effort, known, told):
    """Of a voltage what the turning motor sets against it has to be known."""
    given = description(effort={"column": "u", **effort}, known=known)
    laws = find_effects(["torque_constant_saturation", "winding_heating", "torque_ripple"])
    possible, excluded = applicable(laws, RigFile.model_validate(given), False, 0.0, True)
    assert [e.name() for e in possible] == [e.name() for e in (laws if told else laws[2:])]
    assert told or all("tells no current" in said for said in excluded.values())


@pytest.mark.parametrize(
    "control",
    [
        {"kp": 4.0, "kd": 0.3, "ki": 0.5},
        {"position": 8.0, "velocity": 0.5, "integral": 0.2},
        {"kp": 4.0, "limit": 0.2},
        {"kp": 4.0, "kd": 0.3, "rate": "error"},
        {"position": 8.0, "velocity": 0.5, "integral": 0.2, "rate": "error"},
    ],
)
def test_the_effort_of_a_controller_follows_from_its_gains_and_error(control):
    reference = Q + 0.05 * np.sin(3 * T)
    p, d, i, a, b, _ = RigFile.model_validate(
        description(control=control, reference={"column": "r", "unit": "rad"})
    ).control.gains
    rate = (V + 0.15 * np.cos(3 * T) if control.get("rate") == "error" else 0.0) - V
    wound = np.cumsum(a * (reference - Q) + b * rate) * (T[1] - T[0])
    asked = p * (reference - Q) + d * rate + i * wound
    asked = np.clip(asked, -control.get("limit", np.inf), control.get("limit", np.inf))
    given = read({"u": asked})
    made = read(
        {"r": reference},
        effort={"from": "control", "unit": "N·m", "kind": "torque", "origin": "command"},
        control=control,
        reference={"column": "r", "unit": "rad"},
    )
    inside = slice(100, -100)
    np.testing.assert_allclose(
        made.pieces[0].effort[inside], given.pieces[0].effort[inside], atol=3e-3
    )
    assert any("computed from the controller's gains" in said for said in made.said)


@pytest.mark.parametrize("placed", [True, False])
def test_only_a_position_has_waves(placed):
    """What a wave over the turns would be, a speed that is summed up has no place for."""
    turning = np.cumsum(3.0 + V) * 2e-3
    columns = {"q": turning, "v": 3.0 + V, "u": np.sin(4.0 * turning)}
    velocity = {"velocity": {"column": "v", "unit": "rad/s"}, "position": None}
    made = read(columns, **({} if placed else velocity))
    rig = RigFile.model_validate(description(**({} if placed else velocity)))
    sizes = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")
    problem = InverseProblem(rig, None, [made], [], sizes, 0.02)
    residual, folds = -problem.measured(), np.arange(len(problem.measured())) // 200 % 2
    found = rig_ceiling(problem, problem, residual, residual, folds)
    assert (found.wave > 0.5) is placed


@pytest.mark.parametrize(
    ("described", "unit", "words"),
    [
        ({"gear": 9.0}, "rad", "a turn of the motor"),
        ({}, "rad", "a turn of the axis"),
        ({"position": {"column": "q", "unit": "m"}}, "m", "the whole stroke"),
    ],
)
def test_a_wave_is_counted_over_what_is_known_to_turn(described, unit, words):
    """Of an axis without a gear nothing is known of its motor's turns."""
    turning = np.cumsum(3.0 + V) * 2e-3
    made = read({"q": turning, "u": np.sin(4.0 * turning)}, **described)
    rig = RigFile.model_validate(description(**described))
    sizes = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", unit)
    problem = InverseProblem(rig, None, [made], [], sizes, 0.02)
    residual, folds = -problem.measured(), np.arange(len(problem.measured())) // 200 % 2
    said = depends_on(rig_ceiling(problem, problem, residual, residual, folds))
    assert said.endswith(f" periods in {words}")
