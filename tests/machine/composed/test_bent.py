"""A law of dry friction is taken for what it says of the level at every speed."""

import numpy as np
import pytest

from spirob.effects import all_effects
from spirob.machine.axis import base_model
from spirob.machine.composed.draft import is_bent
from spirob.machine.description.rig import RigFile
from spirob.machine.recordings.recording import prepare
from tests.machine.rigs import description

COULOMB, COGGING = (all_effects()[name] for name in ("coulomb_friction", "cogging"))
W = 2 * np.pi * 0.7


def log(level, seed):
    """A swinging axis with friction of some level over the speed, and a little noise."""
    t = np.arange(0, 12, 5e-3)
    q = np.sin(W * t) + 0.3 * np.sin(3.7 * W * t + seed)
    v = W * np.cos(W * t) + 1.11 * W * np.cos(3.7 * W * t + seed)
    a = -(W**2) * (np.sin(W * t) + 4.107 * np.sin(3.7 * W * t + seed))
    noise = 0.002 * np.random.default_rng(seed).standard_normal(len(t))
    return {"t": t, "q": q, "u": 0.03 * a + 0.1 * v + np.tanh(v / 0.02) * level(np.abs(v)) + noise}


@pytest.mark.parametrize(
    ("effect", "level", "bent"),
    [
        (COULOMB, lambda v: 1.5 + 0.0 * v, False),
        (COULOMB, lambda v: 1.5 * np.tanh(v / 0.1), False),  # turns round slowly
        (COULOMB, lambda v: v**0.4, True),
        (COULOMB, lambda v: 1.5 - 1.25 * np.exp(-v / 2.0), True),
        (COGGING, lambda v: v**0.4, False),  # says nothing of a level
    ],
)
def test_a_level_of_another_shape_is_seen(tmp_path, effect, level, bent):
    rig = RigFile.model_validate(description(known={"delay": 0.0}))
    logs = [prepare(f"log_{k}", log(level, k), rig) for k in range(3)]
    search, bare = base_model(rig, tmp_path, logs[:2], logs[2:])
    model = search.models.fitted((effect,), bare.fit.changes)
    assert is_bent(search, model) == bent
