"""The model's own numbers lie in their intervals; how often, over many draws, is measured apart."""

import pytest

from spirob.benchmark.intervals import coverage, draws

NAMES = ("winch.efficiency", "motor.rotor_damping", "arm.base_stiffness")


def test_shares_are_counted_by_number_and_over_all():
    inside = {"true": 2.0, "value": 2.1, "low": 1.0, "high": 3.0}
    outside = inside | {"true": 4.0}
    found = coverage([{"a": inside, "b": inside}, {"a": outside, "b": inside}])
    assert found["draws"] == 2
    assert found["numbers"]["a"]["inside"] == 0.5
    assert found["inside"] == 0.75
    assert found["numbers"]["b"]["width"] == pytest.approx(0.5)


def test_a_few_draws_of_the_model_are_covered():
    found = draws(3, NAMES, repeats=6, seconds=2.0)
    assert len(found) == 6
    hits = [d[n]["low"] <= d[n]["true"] <= d[n]["high"] for d in found for n in NAMES]
    # of 18 at 95 %: fewer than 14 once in two thousand, were they independent
    assert sum(hits) >= 14
    for draw in found:
        for name in NAMES:
            number = draw[name]
            assert 0.0 < number["high"] - number["low"] < 0.2 * number["true"]
    assert len({draw[NAMES[0]]["value"] for draw in found}) == 6
