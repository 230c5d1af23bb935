"""A motion that leaves the range of a law is said to do so, and by how much."""

from types import SimpleNamespace

import numpy as np

from spirob.machine.composed.law import beyond


def problem(place, effort=()):
    signals = {"winch.displacement": place, "motor.current": effort}
    read = {name: np.asarray(values, float) for name, values in signals.items()}
    return SimpleNamespace(read=lambda changes: read, thinned=lambda values: values)


LAW = SimpleNamespace(
    name=lambda: "law", taught={"place": (0.0, 1.0)}, reads={"place": "winch.displacement"}
)


def test_a_quarter_of_a_log_beyond_the_range_is_said():
    inside, outside = problem([0.0, 0.5, 1.0, 1.04]), problem([0.0, 0.5, 1.0, 1.06])
    assert beyond([inside], [LAW], {}) == []
    (said,) = beyond([inside, outside], [LAW], {})
    assert said.startswith("law: the place leaves the range that taught this law, 0 to 1,")
    assert "in up to 25% of the time" in said


def test_an_effort_beyond_what_taught_a_loss_of_the_drive_is_said():
    loss = SimpleNamespace(
        name=lambda: "law", taught={"current": (-2.0, 2.0)}, reads={"current": "motor.current"}
    )
    (said,) = beyond([problem([], [0.0, 1.0, -3.0, 2.0])], [loss], {})
    assert said.startswith("law: the effort leaves the range that taught this law, -2 to 2,")
    assert "in up to 25% of the time" in said


def test_an_effect_that_nothing_taught_has_no_range():
    assert beyond([problem([9.0])], [SimpleNamespace(taught={}, reads={})], {}) == []
