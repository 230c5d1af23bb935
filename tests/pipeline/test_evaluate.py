"""Which wraps are scored apart, and how predictors are compared."""

import numpy as np
import pandas as pd
import pytest

from pipeline.evaluate import rival, unlisted
from spirob.perceive.size import TARGET

LISTED = pd.DataFrame({TARGET: [0.010, 0.020, 0.030, 0.010]})


def test_only_wraps_of_unlisted_diameters_are_scored_apart():
    true = np.array([0.010, 0.015, 0.020, 0.025, 0.030])
    # 9 mm off where a diameter is listed, 1 and 3 mm where it is not
    found = true + 1e-3 * np.array([9.0, 1.0, -9.0, -3.0, 9.0])
    told = unlisted(pd.DataFrame({TARGET: true}), found, LISTED)["unlisted"]
    assert (told["samples"], told["unit"]) == (2, "mm")
    assert told["mae"] == pytest.approx(2.0)
    assert 1.0 <= told["mae_low"] < told["mae_high"] <= 3.0 + 1e-9


def test_a_diameter_is_listed_though_its_last_bit_differs():
    true = np.array([0.020 * (1 + 1e-15)])
    assert unlisted(pd.DataFrame({TARGET: true}), true, LISTED) == {}


def test_the_gain_over_a_rival_is_of_the_same_wraps():
    true = np.linspace(0.01, 0.07, 20)
    hard = 1e-3 * np.arange(20)  # some wraps are harder than others, for both alike
    told = rival(true, true + hard + 5e-4, true + hard)
    assert told["gain"] == pytest.approx(0.5)
    assert (told["gain_low"], told["gain_high"]) == pytest.approx((0.5, 0.5))
    assert told["mae_high"] - told["mae_low"] > 1.0
