"""A motion that leaves the range of a law is said to do so, and by how much."""

from types import SimpleNamespace

import numpy as np

from spirob.machine.composed.law import beyond


def problem(place):
    signals = {"winch.displacement": np.asarray(place, float)}
    asked = SimpleNamespace(
        seen=lambda vector: None,
        load=lambda motion, vector: None,
        signals=lambda motion, load, vector: signals,
    )
    table = SimpleNamespace(vector=lambda changes: None)
    return SimpleNamespace(
        table=table, asked=asked, completed=lambda changes: changes, thinned=lambda values: values
    )


LAW = SimpleNamespace(
    name=lambda: "law", taught={"place": (0.0, 1.0)}, reads={"place": "winch.displacement"}
)


def test_a_quarter_of_a_log_beyond_the_range_is_said():
    inside, outside = problem([0.0, 0.5, 1.0, 1.04]), problem([0.0, 0.5, 1.0, 1.06])
    assert beyond([inside], [LAW], {}) == []
    (said,) = beyond([inside, outside], [LAW], {})
    assert said.startswith("law: the place leaves the range that taught this law, 0 to 1,")
    assert "in up to 25% of the time" in said


def test_an_effect_that_nothing_taught_has_no_range():
    assert beyond([problem([9.0])], [SimpleNamespace(taught={}, reads={})], {}) == []
