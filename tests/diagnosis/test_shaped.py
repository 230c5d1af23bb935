"""A leader is fitted with its shapes, such as the order of a wave that the stroke hardly shows."""

import numpy as np
import pytest
from spirob.diagnosis.confirm import shaped
from spirob.diagnosis.rungs import ROLES, Confirmed, Settings, scores_of

from spirob.effects.motor.cogging import Cogging
from spirob.identify.fit import fit
from tests.identify.known import residual, spirob

SLOW, FAST = 0.06, 1.2  # per turn; a fifth below, the slow one is within its bound still
TRUE = {
    "cogging.sine": 1.5e-3,
    "cogging.second_sine": 0.5e-3,
    "cogging.order": SLOW,
    "cogging.ratio": FAST / SLOW,
}
NAMES = ["cogging.sine", "cogging.cosine", "cogging.second_sine", "cogging.second_cosine"]
SETTINGS = Settings()


@pytest.mark.parametrize("off", [1.3, 0.8])
def test_a_slow_wave_is_found_from_a_third_off(off):
    """Both waves' orders are begun beside the truth, with amplitudes fitted to the wrong waves."""
    trials = {role: residual(spirob([Cogging]), TRUE, role) for role in ROLES}
    begin = {"cogging.order": off * SLOW, "cogging.ratio": FAST / SLOW / off}
    found = fit(trials["train"], NAMES, begin, SETTINGS.scale, 2, steps=(0.03,), exact=False)
    scores, missed, errors = scores_of(found, trials)
    before = Confirmed((Cogging,), 0.0, found, missed, errors, scores)
    after = shaped(before, trials, SETTINGS, lambda text: None)
    assert after.fit.cost < 0.5 * found.cost
    assert after.fit.changes["cogging.order"] == pytest.approx(SLOW, rel=0.1)
    fast = np.prod([after.fit.changes[f"cogging.{n}"] for n in ("order", "ratio")])
    assert fast == pytest.approx(FAST, rel=0.02)
