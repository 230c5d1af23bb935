"""One law of dry friction is enough; a delay of whole rows."""

from types import SimpleNamespace

import numpy as np
import pytest

from spirob.diagnosis.model import is_dry
from spirob.effects import all_effects
from spirob.machine.inverse.motion import late
from spirob.machine.laws import related

LIBRARY = all_effects()


def test_dry_friction_is_known_by_its_kernel():
    dry = {name for name, effect in LIBRARY.items() if is_dry(effect)}
    assert dry == {"coulomb_friction", "stribeck_friction", "presliding_friction"}
    assert related(LIBRARY["stribeck_friction"], [LIBRARY["coulomb_friction"]])
    assert not related(LIBRARY["quadratic_drag"], [LIBRARY["coulomb_friction"]])


@pytest.mark.parametrize("rows", [0, 3, -3, 60, -60])
def test_an_effort_that_comes_rows_later_is_held_at_its_ends(rows):
    values = np.sin(np.arange(80.0))
    motion = SimpleNamespace(starts=np.array([0, 30, 80]), steps=np.array([1e-3, 1e-3]))
    parts = values[:30], values[30:]
    expected = [part[np.clip(np.arange(len(part)) - rows, 0, len(part) - 1)] for part in parts]
    np.testing.assert_allclose(late(values, rows * 1e-3, motion), np.concatenate(expected))
