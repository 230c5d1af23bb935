"""What a named effect does on a rig's held-out samples, for the page's two plots."""

import numpy as np
import pytest

from spirob.machine.page_tables import laws
from tests.machine.test_inverse import LIBRARY, problem

BARE = {"rig.inertia": 0.03, "rig.viscous": 0.2}
NUMBERS = {**BARE, "quadratic_drag.drag": 0.05}


def rows(*names, numbers=()):
    effects = [LIBRARY[name] for name in names]
    held = problem(*names)
    return laws(held, effects, {**BARE, **dict(numbers)}, held.sizes.axis_unit), held


def test_law_and_residual_differ_by_what_the_whole_model_misses():
    found, held = rows("quadratic_drag", numbers=NUMBERS)
    np.testing.assert_allclose(found["law"] - found["shown"], held(NUMBERS), atol=1e-12)
    speed = found["velocity"].to_numpy()
    np.testing.assert_allclose(found["law"], 0.05 * speed * np.abs(speed), atol=0.02)
    assert set(found["axis"]) == {held.sizes.axis_unit}
    np.testing.assert_array_equal(found["effort"], held.measured())


def test_each_effect_is_taken_out_alone():
    numbers = {**NUMBERS, "constant_force.force": 0.3}
    found, _ = rows("quadratic_drag", "constant_force", numbers=numbers)
    constant = found[found["effect"] == "constant_force"]["law"]
    assert np.ptp(constant) < 1e-9
    assert abs(constant.iloc[0]) == pytest.approx(0.3)


def test_a_model_without_effects_has_no_law():
    assert len(rows()[0]) == 0
