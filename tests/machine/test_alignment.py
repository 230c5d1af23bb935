"""No log is aligned to better than a sample, and a smoothed model is no lag."""

import numpy as np
import pytest

from spirob.effects import all_effects
from spirob.machine.alignment import only_aligns, with_delay
from spirob.machine.inverse import InverseProblem
from spirob.machine.models import Models
from spirob.machine.recording import prepare
from spirob.machine.rig import RigFile
from spirob.machine.scaling import Sizes
from tests.machine.rigs import description

SIZES = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")
W = 2 * np.pi * 0.7


def models(lag, effects=(), period=2e-3):
    """A swinging axis whose effort trails its motion by `lag` [s]."""
    t = np.arange(0, 8, period)
    q = np.sin(W * t) + 0.3 * np.sin(3.7 * W * t)

    def effort(t):
        v = W * np.cos(W * t) + 1.11 * W * np.cos(3.7 * W * t)
        return 0.1 * v - 0.03 * W**2 * (np.sin(W * t) + 4.107 * np.sin(3.7 * W * t))

    rig = with_delay(RigFile.model_validate(description(filter={"cutoff": 40.0})), period)
    log = prepare("log", {"t": t, "q": q, "u": effort(t - lag)}, rig)
    chosen = [all_effects()[name] for name in effects]
    problem = InverseProblem(rig, None, [log], chosen, SIZES, 0.02)
    return Models(problem, problem, [f"rig.{n}" for n in rig.fit]), rig


@pytest.mark.parametrize("lag", [-2e-3, 0.0, 1.3e-3])
def test_the_delay_of_a_log_is_found(lag):
    made, _ = models(lag)
    changes = made.fitted((), {}).fit.changes
    assert changes["rig.delay"] == pytest.approx(lag, abs=5e-5)
    assert changes["rig.inertia"] == pytest.approx(0.03, rel=0.01)


def test_a_delay_that_is_given_is_not_fitted():
    rig = RigFile.model_validate(description(known={"delay": 0.0}))
    assert with_delay(rig, 1e-3) is rig


def test_a_lag_counts_from_where_alignment_ends():
    effects = (all_effects()["current_lag"],)
    made, rig = models(0.012, ["current_lag"])
    assert not only_aligns(made.fitted(effects, {"current_lag.time": 0.01}), rig)
    made, rig = models(0.001, ["current_lag"])
    assert only_aligns(made.fitted(effects, {"current_lag.time": 0.001}), rig)
