"""A live push is that of the same signals at once; nothing is felt where feedback is missing."""

import numpy as np
import pytest

from spirob.perceive.live import PATIENCE, LivePush, Sample
from spirob.perceive.passive import REGIONS, learned
from tests.perceive.test_passive import drawn, noisy, told


@pytest.fixture(scope="module")
def classifier():
    return learned(*drawn(60, 0))


def heard(live, current, first=0):
    """What is told of two currents, sample by sample: when, and what."""
    found = []
    for k, pair in enumerate(current, first):
        for m, i in enumerate(pair):
            found += [(k, *one) for one in live.take(m, [Sample(0.0, 0.0, float(i))])]
    return found


def test_it_tells_what_the_detector_tells_of_the_log(classifier):
    current = noisy(3.0, 1, size=0.05)
    (one,), felt = told(current)
    found = heard(LivePush(classifier), current)
    assert [(k, kind) for k, kind, _ in found] == [
        (one.sample, "push"),
        (int(np.flatnonzero(felt)[-1]) + 1, "push"),
    ]
    assert found[0][2] == "felt"
    region, _, rest = found[1][2].partition(" ")
    assert region in REGIONS
    assert rest.endswith(f"{1e3 * one.peak.max():.0f} mA at most")


def test_frames_that_come_late_or_in_pieces_change_nothing(classifier):
    current = noisy(3.0, 1, size=0.05)
    live, found = LivePush(classifier), []
    for k in range(0, len(current), PATIENCE):
        for m in (1, 0):
            samples = [Sample(0.0, 0.0, float(i)) for i in current[k : k + PATIENCE, m]]
            found += live.take(m, samples)
    assert found == [one[1:] for one in heard(LivePush(classifier), current)]


@pytest.mark.parametrize("silent", [0, 1])
def test_nothing_is_felt_without_feedback_and_it_listens_anew(classifier, silent):
    current = noisy(3.0, 1, size=0.05)
    live = LivePush(classifier)
    felt = heard(live, current[:1600])
    assert [words for _, _, words in felt] == ["felt"]
    assert live.felt
    said = []
    for _ in range(PATIENCE + 1):  # one motor alone goes on
        said += live.take(1 - silent, [Sample(0.0, 0.0, 0.8)])
    assert [kind for kind, _ in said] == ["no push"]
    assert not live.felt
    assert heard(live, noisy(2.0, 2)[200:]) == []


def test_a_long_gap_is_no_signal(classifier):
    live = LivePush(classifier)
    heard(live, noisy(1.4, 1))
    gap = [Sample(0.0, 0.0, 5.0)] * (PATIENCE + 1)  # as a grid fills it
    assert live.take(0, gap) == []
    assert not live.felt
