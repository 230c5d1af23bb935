"""A known motion is found again modulo anything, at any speed, with samples lost."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from spirob.errors import DataError
from spirob.machine.recordings.positions import repaired
from spirob.machine.recordings.unwrapping import Track, modulus_of, unwrapped

TURN = 2 * np.pi
MODULI = st.sampled_from([TURN, 2 * TURN, 0.5 * TURN, 25.0, 360.0, 4096.0, 1.0])


def motion(seconds, fastest, rng):
    """Positions of an axis that begins at rest and wanders, (n,); fastest per second."""
    tones, phases = rng.uniform(0.2, 0.8, 3), rng.uniform(0, TURN, 3)
    speed = np.sum(np.sin(TURN * np.outer(seconds, tones) + phases), axis=1)
    speed *= np.clip(0.5 * seconds - 1, 0, 1) ** 2
    return np.cumsum(np.gradient(seconds) * fastest * speed / np.abs(speed).max())


def spun(modulus, fastest, lost, seed):
    """The true motion and its track modulo something; `fastest` in moduli a sample."""
    rng = np.random.default_rng(seed)
    seconds = 0.01 * np.arange(1200)
    true = motion(seconds, 100 * fastest * modulus, rng)
    keep = rng.random(len(true)) >= lost
    values = np.mod(true[keep] + rng.uniform(0, modulus), modulus)
    return true[keep], Track(values, seconds[keep], 0.01, 0.055)


def same(found, true, modulus):
    np.testing.assert_allclose(np.diff(found), np.diff(true), atol=1e-6 * modulus)


@given(MODULI, st.floats(0.02, 0.45), st.floats(0.0, 0.1), st.integers(0, 2**32))
def test_any_speed_below_half_a_modulus_a_sample(modulus, fastest, lost, seed):
    true, track = spun(modulus, fastest, lost, seed)
    assume(np.ptp(true) > 1.5 * modulus)
    found = modulus_of(track)
    assert found == pytest.approx(modulus, rel=0.02)
    known, wraps, _ = unwrapped(track, modulus)
    same(known, true, modulus)
    assert wraps > 0
    assert modulus_of(replace(track, usual=(0.9 * modulus, modulus))) == modulus


@given(MODULI, st.floats(0.6, 2.0), st.floats(0.0, 0.1), st.integers(0, 2**32))
def test_beyond_it_the_speed_before_tells_the_turns(modulus, fastest, lost, seed):
    true, track = spun(modulus, fastest, lost, seed)
    assert modulus_of(track) == pytest.approx(modulus, rel=0.05)
    known, _, fast = unwrapped(track, modulus)
    assert fast
    same(known, true, modulus)


@given(MODULI, st.integers(1, 3), st.floats(-0.4, 0.4), st.floats(-3, 3), st.integers(0, 2**32))
def test_a_sensor_of_speed_tells_turns_that_no_row_shows(modulus, whole, part, scale, seed):
    """Whole turns between two rows, all the time; the sensor is a scale off."""
    assume(abs(scale) > 0.1)
    true, track = spun(modulus, 0.1, 0.0, seed)
    spin = 100 * modulus * (whole + part)
    true = true + spin * track.seconds
    log = replace(track, values=np.mod(true, modulus), speed=scale * np.gradient(true, 0.01))
    known, _, _ = unwrapped(log, modulus)
    same(known, true, modulus)


@given(MODULI, st.floats(0.01, 0.05), st.integers(6, 200), st.integers(0, 2**32))
def test_turns_over_a_gap_are_found_or_told_as_a_guess(modulus, fastest, lost, seed):
    true, track = spun(modulus, fastest, 0.0, seed)
    assume(np.ptp(true) > 1.5 * modulus)
    begin = int(np.random.default_rng(seed).integers(400, 900))
    rest = np.delete(np.arange(1200), slice(begin, begin + lost))
    log = replace(track, values=track.values[rest], seconds=track.seconds[rest], usual=(modulus,))
    said: list[str] = []
    found = repaired("log", "q", log, said)
    told = any("is a guess" in sentence for sentence in said)
    assert told or not len(found.jumps)
    if not told:
        same(found.values, true[rest], modulus)
    assert not (told and fastest * (lost + 1) < 0.3)


@given(MODULI, st.floats(0.01, 0.2), st.integers(0, 2**32))
def test_a_swing_over_the_edge_is_no_turn(modulus, size, seed):
    rng = np.random.default_rng(seed)
    seconds = 0.01 * np.arange(1200)
    true = size * modulus * np.sin(TURN * 0.4 * seconds) + 1e-4 * modulus * rng.random(1200)
    said: list[str] = []
    found = repaired("log", "q", Track(np.mod(true, modulus), seconds, 0.01, 0.055), said)
    np.testing.assert_allclose(np.diff(found.values), np.diff(true), atol=2e-3 * modulus)
    assert "'q' wraps round by" in said[0]
    assert found.modulus == pytest.approx(modulus, rel=1e-2)


@given(MODULI, st.floats(0.02, 0.2), st.integers(0, 2**32))
def test_spikes_in_a_wrapped_position_are_bridged(modulus, fastest, seed):
    true, track = spun(modulus, fastest, 0.0, seed)
    assume(np.ptp(true) > 1.5 * modulus)
    rng = np.random.default_rng(seed)
    rows = 20 * rng.choice(np.arange(2, 58), 4, replace=False)
    values = track.values.copy()
    values[rows] = np.mod(values[rows] + rng.uniform(0.3, 0.7, 4) * modulus, modulus)
    found = repaired("log", "q", replace(track, values=values, usual=(modulus,)), [])
    assert not len(found.jumps)
    rest = np.delete(np.arange(1200), rows)
    same(found.values[rest], true[rest], modulus)


def test_single_zeros_in_a_fiftieth_of_the_rows_are_spikes():
    seconds = 0.01 * np.arange(1200)
    true = 3.0 + motion(seconds, 3.0, np.random.default_rng(1))
    rows = np.arange(20, 1180, 48) + np.random.default_rng(2).integers(0, 20, 25)
    values = true.copy()
    values[rows] = 0.0
    said: list[str] = []
    found = repaired("log", "q", Track(values, seconds, 0.01, 0.055), said)
    np.testing.assert_allclose(found.values, true, atol=0.01 * np.ptp(true))
    assert said == ["log: 25 jumps of 'q' out and back were bridged."]


@pytest.mark.parametrize("reach", [0.5, 3.0, 40.0])
def test_what_never_wraps_is_left_alone(reach):
    seconds = 0.01 * np.arange(1200)
    true = motion(seconds, reach, np.random.default_rng(1))
    said: list[str] = []
    found = repaired("log", "q", Track(true, seconds, 0.01, 0.055, usual=(TURN,)), said)
    np.testing.assert_array_equal(found.values, true)
    assert said == []
    assert found.modulus is None


def test_one_step_over_all_that_the_position_reaches_may_be_a_turn_of_its_own():
    seconds = 0.01 * np.arange(1200)
    moved = 2.5 * seconds + 0.3 * np.sin(3.0 * seconds)
    wrapped = Track(np.mod(moved, 23.0), seconds, 0.01, 0.055, usual=(TURN,))
    said: list[str] = []
    found = repaired("log", "q", wrapped, said)
    np.testing.assert_allclose(found.values, moved, atol=1e-3)
    assert "'q' jumps by -23 at 9" in said[0]
    assert "it begins again after as much (position.modulus), or was reset" in said[0]


def test_one_step_of_no_known_size_is_a_jump_and_many_are_refused():
    seconds = 0.01 * np.arange(1200)
    true = motion(seconds, 3.0, np.random.default_rng(1))
    once = Track(true + 5.0 * (seconds > 6), seconds, 0.01, 0.055, usual=(TURN,))
    said: list[str] = []
    assert list(repaired("log", "q", once, said).jumps) == [601]
    assert "'q' jumps by 5" in said[0]
    assert "lost counts or a reset" in said[0]
    often = replace(once, values=true + 5.0 * np.cumsum(np.arange(1200) % 60 == 0))
    with pytest.raises(DataError, match=r"'q' jumps by .* and 19 times in all"):
        repaired("log", "q", often, [])


@given(st.integers(2, 4), st.integers(0, 2**32))
def test_rows_that_no_stamp_misses_are_lost_samples_and_keep_the_zero(rows, seed):
    """An even clock was put behind stamps that tell no loss: the axis moves rows at once."""
    rng = np.random.default_rng(seed)
    true = 3.0 * np.sin(0.08 * np.arange(1200)) + 1e-4 * rng.standard_normal(1200)
    begin = round(np.pi * rng.integers(2, 28) / 0.08) + int(rng.integers(-3, 4))  # it is fast there
    rest = np.delete(true, slice(begin, begin + rows - 1))
    said: list[str] = []
    found = repaired("log", "q", Track(rest, 0.01 * np.arange(len(rest)), 0.01, 0.055), said)
    np.testing.assert_array_equal(found.values, rest)
    assert list(found.jumps) == [begin]
    assert f"'q' moves by the way of {rows} rows in one" in said[0]


@pytest.mark.parametrize("rows", [2, 3])
def test_an_accelerating_motor_that_mostly_rests_loses_samples_and_no_counts(rows):
    """The row behind the loss is many counts faster than the one before it."""
    moving = np.cumsum(np.r_[np.linspace(0, 300, 20), np.linspace(300, 0, 20)])
    rest = np.full(600, moving[-1])
    whole = np.round(np.r_[np.zeros(600), moving, rest, moving + moving[-1], rest + moving[-1]])
    kept = np.delete(whole, np.s_[612 : 611 + rows])
    said: list[str] = []
    found = repaired("log", "q", Track(kept, 0.01 * np.arange(len(kept)), 0.01, 0.055), said)
    np.testing.assert_array_equal(found.values, kept)
    assert f"'q' moves by the way of {rows} rows in one" in said[0]
    assert "samples were lost that no stamp tells" in said[0]


def test_how_many_rows_lack_is_not_told_where_the_speed_changes_by_more_than_a_row():
    steps = np.r_[np.zeros(600), np.linspace(0, 100, 20), 600, np.full(20, 300), np.zeros(600)]
    said: list[str] = []
    track = Track(np.cumsum(np.round(steps)), 0.01 * np.arange(len(steps)), 0.01, 0.055)
    repaired("log", "q", track, said)
    assert "lost counts or a reset" in said[0]


def steady(rate, modulus=TURN, speed=None):
    """What is said of an axis that moves by so many moduli a row from the first to the last."""
    seconds = 0.01 * np.arange(1200)
    true = modulus * rate * np.arange(1200) + 0.02 * modulus * np.sin(2 * seconds)
    sensor = None if speed is None else speed * np.gradient(true, 0.01)
    said: list[str] = []
    repaired("log", "q", Track(np.mod(true, modulus), seconds, 0.01, 0.055, speed=sensor), said)
    return " ".join(said)


def test_a_steady_turn_of_a_quarter_and_more_a_row_may_be_the_other_way_and_is_told():
    assert "or the other, nothing tells" in steady(0.64)
    assert "0.36" in steady(0.64)
    assert "or the other" not in steady(0.64, speed=2.0)
    assert "or the other" not in steady(0.05)


@given(MODULI, st.floats(0.02, 0.2), st.floats(0.0, 0.1), st.integers(0, 2**32))
def test_a_speed_that_is_gained_by_and_by_is_sure(modulus, fastest, lost, seed):
    _, track = spun(modulus, fastest, lost, seed)
    said: list[str] = []
    repaired("log", "q", track, said)
    assert "or the other" not in " ".join(said)


@pytest.mark.parametrize(("rate", "change"), [(0.3, 0.3), (0.64, 0.36), (1.3, 0.3)])
def test_a_change_of_speed_at_once_may_be_the_other_way_and_is_told(rate, change):
    """An axis at rest that turns by so many moduli from one row to the next."""
    seconds = 0.01 * np.arange(1200)
    true = 100.0 * rate * np.maximum(seconds - 6, 0) + 0.01 * np.sin(seconds)
    said: list[str] = []
    repaired("log", "q", Track(TURN * np.mod(true, 1.0), seconds, 0.01, 0.055), said)
    assert f"changes its speed by {change} of its modulus" in said[-1]
    assert "or the other" in said[-1]


@given(MODULI, st.sampled_from([2.0, 180 / np.pi, 652.0]), st.integers(0, 2**32))
def test_a_modulus_that_the_steps_contradict_is_refused_with_theirs(modulus, times, seed):
    true, track = spun(modulus, 0.1, 0.0, seed)
    assume(np.ptp(true) > 1.5 * modulus)
    repaired("log", "q", replace(track, modulus=modulus), [])
    with pytest.raises(DataError, match=r"again after .* by its own steps, not after its"):
        repaired("log", "q", replace(track, modulus=times * modulus), [])


def test_a_modulus_that_a_position_exceeds_is_refused_or_told_where_it_never_wraps():
    seconds = 0.01 * np.arange(1200)
    degrees = Track(4000.0 * np.sin(seconds), seconds, 0.01, 0.055, modulus=TURN)
    with pytest.raises(DataError, match=r"spans 7999, more than its modulus of 6\.283"):
        repaired("log", "q", degrees, [])
    whole, said = Track(20.0 * np.sin(seconds), seconds, 0.01, 0.055, modulus=TURN), []
    assert np.array_equal(repaired("log", "q", whole, said).values, whole.values)
    assert "never begins again: used as it is" in said[0]


@given(st.integers(600, 1200), st.integers(0, 1), st.integers(0, 2**32))
def test_noise_and_counts_in_turn_at_rest_are_no_wraps(rows, counts, seed):
    noise = np.random.default_rng(seed).random(rows)
    values = np.round(noise) if counts else noise
    assert modulus_of(Track(values, 0.01 * np.arange(rows), 0.01, 0.055)) is None


@pytest.mark.parametrize("seed", range(4))
def test_a_few_counts_to_and_fro_are_no_modulus(seed):
    """Their steps are alike, as there are no others; forty counts of a turn are one."""
    values = np.rint(np.random.default_rng(seed).normal(size=3000))
    track = Track(values, 0.01 * np.arange(3000), 0.01, 0.055)
    assert modulus_of(track) is None
    turns = np.floor(np.mod(0.011 * np.arange(3000), 1.0) * 40.0)
    assert modulus_of(replace(track, values=turns)) == pytest.approx(40.0, rel=0.05)


def test_two_rows_that_the_clock_has_close_are_no_jump():
    """A way as long as those beside, over a tenth of their time, is ten times their speed."""
    seconds = 0.01 * np.arange(1000.0)
    values = np.sin(2.0 * seconds)
    seconds[500:] -= 0.009
    said: list[str] = []
    assert not len(repaired("log", "q", Track(values, seconds, 0.01, 0.055), said).jumps)
    assert said == []
    values[500:] += 0.3
    assert list(repaired("log", "q", Track(values, seconds, 0.01, 0.055), said).jumps) == [500]
