"""What the data resolve: numbers that only enter by their product cannot be told apart."""

from types import SimpleNamespace

import numpy as np
import pytest

from pipeline.identify import resolution
from spirob.identify.fit import Estimate, Fit
from spirob.parameter import Parameter, Table

SAMPLES = 400


def found(jacobian):
    noise = np.random.default_rng(3).normal(0, 0.01, SAMPLES)
    one = Estimate(1.0, 0.9, 1.1, "1", False)
    names = [f"part.n{k}" for k in range(jacobian.shape[1])]
    fit = Fit(dict.fromkeys(names, 1.0), dict.fromkeys(names, one), noise, jacobian, 0.0, 1)
    decades = Parameter(1.0, 0.01, 100.0, "1", "n", "a number", log=True)
    problem = SimpleNamespace(
        edges=np.array([0, SAMPLES]),
        block=20,
        effort=SimpleNamespace(unit="A"),
        table=Table.of(dict.fromkeys(names, decades), {}),
    )
    return resolution(fit, problem, 0.05)


def test_a_product_leaves_the_ratio_unknown():
    wave = np.sin(np.arange(SAMPLES) / 7)
    other = np.cos(np.arange(SAMPLES) / 3)
    slightly = wave + 1e-3 * np.cos(np.arange(SAMPLES) / 5)
    answer = found(np.column_stack([wave, slightly, other]))
    assert answer["correlation"][0][1] < -0.99
    assert abs(answer["correlation"][0][2]) < 0.9
    weakest = answer["weakest"]
    assert weakest["part.n0"] == pytest.approx(-weakest["part.n1"], abs=0.01)
    assert abs(weakest["part.n2"]) < 0.01
    assert answer["least"] < 0.01 * answer["most"]


def test_the_change_is_that_of_a_tenth():
    answer = found(np.full((SAMPLES, 1), 3.0))
    assert answer["least"] == pytest.approx(0.3)
    assert answer["most"] == pytest.approx(0.3)
    assert answer["correlation"] == [[1.0]]
