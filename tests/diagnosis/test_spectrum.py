"""Waves over the turns are found with their order and share, and none in noise of any colour."""

import numpy as np
import pytest
from scipy import signal

from spirob.diagnosis.spectrum import orders
from tests.diagnosis.stretches import GEAR, pair, stretch

PIECES = pair()
ANGLE = np.concatenate([p.angle for p in PIECES])
LEFT = np.concatenate([np.full(len(p.seconds), p.channel == "left motor") for p in PIECES])


def test_a_sine_of_order_three_of_the_motor_is_all_of_the_error():
    (found,) = orders(PIECES, np.sin(3.0 * ANGLE + 0.4))
    assert found.of == "motor"
    assert found.order == pytest.approx(3.0, rel=0.01)
    assert found.share_of_error == pytest.approx(1.0, abs=0.02)


def test_motors_may_have_phases_of_their_own():
    (found,) = orders(PIECES, np.where(LEFT, np.sin(2.0 * ANGLE), 0.5 * np.cos(2.0 * ANGLE)))
    assert (found.of, found.share_of_error) == ("motor", pytest.approx(1.0, abs=0.02))


def test_a_slow_wave_is_counted_over_the_turns_of_the_output():
    values = np.sin(7.0 * ANGLE / GEAR)
    strongest = max(orders(PIECES, values), key=lambda w: w.share_of_error)
    assert strongest.of == "output"
    assert strongest.order == pytest.approx(7.0, rel=0.02)
    assert strongest.share_of_error > 0.95


def test_two_waves_are_found_one_beside_the_other_the_stronger_first():
    found = orders(PIECES, np.sin(3.0 * ANGLE) + 0.5 * np.sin(1.4 * ANGLE + 1.0))
    assert [w.order for w in found[:2]] == pytest.approx([3.0, 1.4], rel=0.02)
    assert [w.share_of_error for w in found[:2]] == pytest.approx([0.8, 0.2], abs=0.03)


@pytest.mark.parametrize("cutoff", [0.3, 1.0, 3.0, 30.0])
def test_noise_of_any_colour_holds_hardly_any_wave(cutoff):
    colour = signal.butter(2, cutoff, fs=100.0, output="sos")
    draws = np.random.default_rng(7).standard_normal((8, len(ANGLE)))
    found = [orders(PIECES, values) for values in signal.sosfiltfilt(colour, draws)]
    # two searches a draw, each of which chance passes once in twenty
    assert sum(bool(waves) for waves in found) <= 3


def test_a_wave_of_one_trial_that_no_other_repeats_is_none():
    slow = np.concatenate([np.full(len(p.seconds), p.trial == PIECES[0].trial) for p in PIECES])
    noise = 0.3 * np.random.default_rng(3).standard_normal(len(ANGLE))
    assert orders(PIECES, np.where(slow, np.sin(3.0 * ANGLE), 0.0) + noise) == []


def test_on_a_way_of_hundreds_of_turns_the_spectrum_says_where_to_look():
    far = [
        stretch(p.trial, p.channel, pace, angle=40.0 * p.angle)
        for p, pace in zip(PIECES, (1.0, 1.6, 1.0, 1.6), strict=True)
    ]
    angle = np.concatenate([p.angle for p in far])
    noise = np.random.default_rng(5).standard_normal(len(angle))
    (found,) = orders(far, np.sin(0.2 * angle + 0.4) + noise)
    assert (found.of, found.order) == ("output", pytest.approx(0.2 * GEAR, rel=1e-3))
    assert found.share_of_error == pytest.approx(1 / 3, abs=0.04)
    assert orders(far, noise) == []


def test_where_the_turns_are_not_known_a_wave_is_counted_over_the_stroke():
    slides = [stretch(trial, gear=None, turn="stroke") for trial in ("once", "again")]
    angle = np.concatenate([p.angle for p in slides])
    (found,) = orders(slides, np.sin(3.0 * angle))
    assert (found.of, found.order) == ("stroke", pytest.approx(3.0, rel=0.01))


def test_without_an_angle_or_a_motion_there_are_no_orders():
    still = np.zeros(len(PIECES[0].seconds))
    assert orders([stretch(angle=None)], still) == []
    assert orders([stretch(angle=still)], still) == []
