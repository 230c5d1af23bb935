"""Regimes are marked where the atlas would count them."""

import numpy as np
import pandas as pd
import pytest

from spirob.report.figures import driven, spans
from spirob.report.sections.comparison import payload

TIME = np.arange(0, 10, 0.01)


def rows():
    stroke = 0.03 * (1 - np.cos(2 * np.pi * TIME / 10))  # winds in for 5 s, then pays out
    return pd.DataFrame(
        {
            "time": TIME,
            "measured_displacement": stroke,
            "measured_velocity": np.gradient(stroke, TIME),
            "measured_current": 1.0 + 10 * stroke,
        }
    )


def test_the_two_directions_take_their_halves():
    found = spans(rows(), "trial", "left")
    (inward,), (outward,) = found["winding in"], found["paying out"]
    assert inward[0] < 0.5 < 4.5 < inward[1] < 5.0
    assert 5.0 < outward[0] < 5.5 < 9.5 < outward[1]
    assert found["left motor driven"] == [[0.0, 9.99]]


def test_the_order_of_the_rows_does_not_matter():
    shuffled = rows().sample(frac=1.0, random_state=1)
    assert spans(shuffled, "trial", "left") == spans(rows(), "trial", "left")


def test_a_signal_with_gaps_marks_nothing():
    broken = rows()
    broken.loc[3, "measured_current"] = np.nan
    assert spans(broken, "trial", "left") == {}


def test_only_driven_motors_are_marked(data):
    known = driven(data.compare)
    assert ("hysteresis_left", "left") in known
    assert ("hysteresis_left", "right") not in known
    trials = {t["name"]: t for t in payload(data.overlay, "best", known)["trials"]}
    motors = trials["hysteresis_left"]["motors"]
    assert motors["left"]["regimes"]["winding in"]
    assert motors["right"]["regimes"] == {}


@pytest.mark.parametrize("compare", [{}, {"trials": []}])
def test_without_a_comparison_nothing_is_known_to_be_driven(compare):
    assert driven(compare) == set()
