"""What is sure of a fall of the error, block by block."""

from types import SimpleNamespace

import numpy as np

from spirob.diagnosis.criteria import Criteria, Worth

WORTH = Worth(Criteria(), 1e-3)
BEFORE = np.random.default_rng(1).uniform(0.8, 1.2, 24)


def model(errors):
    return SimpleNamespace(errors=errors, mean_square=float(np.mean(errors)))


def test_one_block_with_a_blow_does_not_hide_what_all_others_show():
    after = 0.3 * BEFORE
    after[5] = 9.0
    assert WORTH.matters(model(BEFORE), model(after))
    after[5] = 30.0  # but a mean that rises is no fall, whatever the others show
    assert not WORTH.matters(model(BEFORE), model(after))


def test_one_block_alone_proves_nothing():
    after = BEFORE * np.random.default_rng(2).uniform(0.9, 1.1, 24)
    before = np.append(BEFORE, 40.0)
    assert not WORTH.matters(model(before), model(np.append(after, 2.0)))


def test_noise_seldom_passes():
    """Two tests at 2.5 % each, of 24 blocks: chance alone passes one in twenty, or hardly more."""
    draws = np.random.default_rng(3).normal(0.0, 0.5, (300, 24))
    passed = [WORTH.matters(model(BEFORE), model(BEFORE * np.exp(d))) for d in draws]
    assert np.mean(passed) < 0.1
