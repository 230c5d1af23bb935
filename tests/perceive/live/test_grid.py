"""Whatever happens on the way, samples come at equal distances in time."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from spirob.perceive.live import LONGEST, Grid, Sample
from spirob.robot import CYCLE_NS


def line(k):
    """What a motor says in period k: everything rises evenly."""
    return Sample(1.0 * k, 2.0 * k, 3.0 * k)


@given(st.lists(st.booleans(), min_size=2, max_size=200), st.integers(0, 2**40))
def test_lost_frames_of_a_straight_line_are_not_missed(arrives, begins):
    grid, seen = Grid(), []
    periods = [0, *(k for k, there in enumerate(arrives, 1) if there)]
    gaps = [b - a for a, b in pairwise(periods)]
    for k in periods:
        seen += grid.take(begins + k * CYCLE_NS, line(k))
    if max(gaps, default=0) <= LONGEST:
        assert len(seen) == periods[-1] + 1
        for k, sample in enumerate(seen):
            assert all(abs(a - b) < 1e-9 * (1 + k) for a, b in zip(sample, line(k), strict=True))


@given(st.lists(st.floats(-0.49, 0.49), min_size=1, max_size=100))
def test_lateness_within_half_a_period_changes_nothing(jitter):
    grid, count = Grid(), 0
    grid.take(0, line(0))
    for k, late in enumerate(jitter, 1):
        count += len(grid.take(round((k + late) * CYCLE_NS), line(k)))
    assert count == len(jitter)


def test_two_frames_in_one_period_count_once():
    grid = Grid()
    assert grid.take(0, line(0)) == [line(0)]
    assert grid.take(CYCLE_NS // 10, line(1)) == []
    assert not grid.broken


def test_a_long_silence_and_a_clock_set_back_begin_anew():
    grid = Grid()
    grid.take(0, line(0))
    assert not grid.broken
    assert grid.take((LONGEST + 1) * CYCLE_NS, line(1)) == [line(1)]
    assert grid.broken
    assert grid.take(-(10**12), line(2)) == [line(2)]
    assert grid.broken
