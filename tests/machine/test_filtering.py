"""Derivatives, the noise of a sensor, and a cutoff that keeps it small."""

import numpy as np
import pytest
from scipy import signal

from spirob.errors import ConfigError, DataError
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.scaling import sizes_of
from spirob.machine.recordings.checks import EDGE, beside_gaps
from spirob.machine.recordings.clock import SHORTEST
from spirob.machine.recordings.filtering import (
    BELOW,
    PAD,
    acceleration_noise,
    before_thinning,
    derivative,
    rates,
    roomy_cutoff,
    sensor_noise,
    smooth,
    usual_cutoff,
)
from spirob.machine.recordings.recording import prepare
from tests.machine.rigs import description


@pytest.mark.parametrize("order", [1, 3, 4])
def test_a_polynomial_of_fourth_order_is_differentiated_exactly(order):
    t = np.linspace(0, 1, 40)
    found = derivative(t**order, t[1] - t[0])
    np.testing.assert_allclose(found[2:-2], order * t[2:-2] ** (order - 1), atol=1e-9)


@pytest.mark.parametrize("count", [1, 2, 5, 31, 61, 400])
def test_the_filters_are_those_of_scipy_to_the_bit(count):
    values = np.random.default_rng(count).standard_normal(count)
    low = signal.butter(4, 25.0, fs=500.0, output="sos")
    expected = signal.sosfiltfilt(low, values, padlen=min(round(PAD / (25.0 * 2e-3)), count - 1))
    np.testing.assert_array_equal(smooth(values, 25.0, 2e-3), expected)
    alias = signal.cheby1(8, 0.05, 0.8 / 4, output="sos")
    expected = signal.sosfiltfilt(alias, values, padlen=min(60, count - 1))
    np.testing.assert_array_equal(before_thinning(values, 4), expected)


@pytest.mark.parametrize("count", [2, 4, 5, 6, 40])
def test_the_ends_of_a_derivative_are_those_of_second_order(count):
    values = np.random.default_rng(count).standard_normal(count)
    found, expected = derivative(values, 1e-3), np.gradient(values, 1e-3)
    np.testing.assert_array_equal(found[[0, 1, -2, -1]], expected[[0, 1, -2, -1]])


def test_the_noise_of_an_encoder_is_its_step_over_the_root_of_twelve():
    t = np.arange(0, 10, 1e-3)
    q = np.sin(2 * np.pi * t)
    step = 2e-3
    assert sensor_noise(np.round(q / step) * step) == pytest.approx(step / np.sqrt(12), rel=0.3)


def test_the_cutoff_falls_until_noise_is_small():
    t = np.arange(0, 10, 1e-3)
    q = np.sin(2 * np.pi * t) + 0.2 * np.sin(7 * t)
    coarse = np.round(q / 2e-3) * 2e-3
    fine_cutoff, coarse_cutoff = (usual_cutoff(x, 2, -q, 1e-3) for x in (q, coarse))
    assert fine_cutoff == 50.0
    assert 4.0 <= coarse_cutoff < 30.0
    noise = acceleration_noise(coarse, 2, 50.0, 1e-3)
    left = derivative(derivative(smooth(coarse - q, 25.0, 1e-3), 1e-3), 1e-3)
    assert noise == pytest.approx(float(np.std(left)), rel=0.5)


@pytest.mark.parametrize(("inertia", "least", "most"), [(1e-3, 8.0, 12.5), (1.0, 0.0, 4.0)])
def test_a_noise_that_inertia_makes_nothing_of_holds_no_cutoff_down(inertia, least, most):
    """A slow axis in coarse counts: of its friction a cutoff for its acceleration leaves little."""
    t = np.arange(0, 40, 5e-3)
    q = np.sin(0.6 * t) + 0.4 * np.sin(1.1 * t)
    v, a = (np.gradient(x, t) for x in (q, np.gradient(q, t)))
    effort = inertia * a + 0.2 * np.tanh(v / 0.02)
    coarse = np.round(q / 2e-3) * 2e-3
    assert least <= usual_cutoff(coarse, 2, effort, 5e-3) <= most


@pytest.mark.parametrize("cutoff", [0.01, 0.05, 0.125, 0.25])
@pytest.mark.parametrize("tone", [0.05, 0.1, 0.2, 0.3])
def test_beyond_the_edge_the_filters_know_no_end(cutoff, tone):
    """A sine cut at an end, its tone a share of the cutoff; samples are a second apart."""

    def compared(q):
        return smooth(rates(smooth(q, cutoff, 1.0), 1.0)[1], BELOW * cutoff, 1.0)

    n = round(20 / cutoff)
    edge = round(EDGE / cutoff)
    missed = []
    for phase in np.linspace(0, 2 * np.pi, 9):
        q = np.sin(2 * np.pi * tone * cutoff * np.arange(-n, n) + phase)
        whole, cut = compared(q)[n:], compared(q[n:])
        missed.append((cut - whole)[edge : n // 2] / np.std(whole))
    assert np.sqrt(np.mean(np.square(missed), axis=0)).max() < 0.03


@pytest.mark.parametrize(("rate", "share"), [(20, 0.24), (30, 0.15), (60, 0.124)])
def test_a_slow_log_keeps_most_of_its_rows_and_band(rate, share):
    t = np.arange(0, 10, 1 / rate)
    q = np.sin(2 * np.pi * 0.7 * t) + 0.2 * np.sin(9 * t)
    u = np.cos(2 * np.pi * 0.7 * t) + 0.3 * np.sign(np.cos(2 * np.pi * 0.7 * t)) + np.sin(9 * t)
    made = prepare("log", {"t": t, "q": q, "u": u}, RigFile.model_validate(description(filter={})))
    assert made.cutoff > share * rate
    assert made.pieces[0].use.mean() > 0.85


def test_a_cutoff_beyond_the_samples_is_the_usual_one_and_adds_no_lag():
    rig = RigFile.model_validate(description(filter={"cutoff": 300.0}))
    t = np.arange(0, 10, 5e-3)
    made = prepare("log", {"t": t, "q": np.sin(3 * t), "u": np.cos(3 * t)}, rig)
    usual = RigFile.model_validate(description(filter={}))
    same = prepare("log", {"t": t, "q": np.sin(3 * t), "u": np.cos(3 * t)}, usual)
    assert made.cutoff == same.cutoff < 80.0
    assert any("a cutoff of 300 Hz is beyond what 200 samples" in said for said in made.said)
    piece = made.pieces[0]
    np.testing.assert_allclose(3 * piece.effort[piece.use], piece.v[piece.use], atol=1e-3)


@pytest.mark.parametrize(
    ("every", "gap", "cutoff", "goes"),
    [
        (0, 0, 0.5, "nowhere"),
        (40, 1, 0.5, "nowhere"),  # a lost row is nothing beside a period of 2 s
        (1600, 60, 0.5, "nowhere"),
        (400, 60, 0.5, "up"),  # so that the filter smears less beside a gap
        (14, 6, 30.0, "down"),  # so that a gap is short
    ],
)
def test_a_cutoff_leaves_most_rows_beside_lost_ones(every, gap, cutoff, goes):
    period, filled = 0.01, np.zeros(4000, bool)
    for k in range(gap):
        filled[100 + k :: every] = True
    found = roomy_cutoff(cutoff, 0.1, [filled, filled], period)
    assert goes == ("nowhere" if found == cutoff else "up" if found > cutoff else "down")
    assert np.count_nonzero(~beside_gaps(filled, found * period)) > 0.5 * len(filled)


@pytest.mark.parametrize(("cutoff", "gap"), [(12.0, 1), (6.0, 3)])
def test_what_is_compared_is_as_good_over_a_short_gap(cutoff, gap):
    """Of a motion at the edge of the last filter, which is the worst that is compared."""
    rig = RigFile.model_validate(description(filter={"cutoff": cutoff}))
    t = np.arange(0, 40, 0.01)
    w = 2 * np.pi * BELOW * cutoff
    whole = {"t": t, "q": np.sin(w * t), "u": np.cos(w * t)}
    lost = np.zeros(len(t), bool)
    for k in range(gap):
        lost[300 + k :: 40 + 7 * gap] = True
    holed = {name: values[~lost] for name, values in whole.items()}
    one, two = (prepare("log", log, rig).pieces[0] for log in (whole, holed))
    assert np.array_equal(one.use, two.use)
    for name in ("q", "v", "a", "effort"):
        full, bridged = (getattr(piece, name)[one.use] for piece in (one, two))
        assert np.max(np.abs(bridged - full)) < 0.02 * np.max(np.abs(full))


def test_rows_beside_a_short_gap_are_kept_and_beside_a_long_one_left_out():
    cutoff, filled = 0.01, np.zeros(1000, bool)
    filled[500:524] = True
    assert not beside_gaps(filled, cutoff).any()
    filled[500:526] = True
    left_out = np.flatnonzero(beside_gaps(filled, cutoff))
    assert (left_out[0], left_out[-1]) == (500 - 50, 525 + 50)


def test_a_log_that_no_cutoff_leaves_room_is_filtered_as_usual():
    assert roomy_cutoff(0.5, 0.1, [np.ones(400, bool)], 0.01) == 0.5
    assert roomy_cutoff(60.0, 60.0, [np.ones(400, bool)], 0.01) == 60.0


@pytest.mark.parametrize("slow", [5.0, 25.0])
def test_a_short_log_is_filtered_so_that_a_trial_is_left(slow):
    """Most of its rows would be left by a lower cutoff, but less than half a second."""
    filled = [np.zeros(330, bool)]
    found = roomy_cutoff(slow, 0.1, filled, 0.002)
    ends = 2 * round(EDGE / (found * 0.002))
    assert found > slow
    assert (330 - ends) * 0.002 >= SHORTEST
    assert roomy_cutoff(slow, 0.1, [np.zeros(3300, bool)], 0.002) == slow


def test_a_short_log_that_a_given_cutoff_leaves_too_little_of_is_told_both():
    t = np.arange(0, 0.66, 2e-3)
    log = {"t": t, "q": np.sin(20 * t), "u": np.cos(20 * t)}
    rig = RigFile.model_validate(description(filter={"cutoff": 20.0}))
    told = r"only 0\.412 s are left .*, 0\.5 s are needed \(of 0\.66 s a filter of 20 Hz smears"
    with pytest.raises(DataError, match=told):
        prepare("log", log, rig)


@pytest.mark.parametrize("asked", [200, 10**9])
def test_thinning_beyond_the_motion_is_as_usual(asked):
    """At 200 Hz every 200th row of a motion of 0.8 and 3 Hz is none of it."""
    rig = RigFile.model_validate(description(filter={"decimate": asked}))
    t = np.arange(0, 20, 5e-3)
    log = {"t": t, "q": np.sin(5 * t) / 5, "u": np.cos(5 * t) + np.sin(19 * t)}
    made = prepare("log", log, rig)
    usual = prepare("log", log, RigFile.model_validate(description(filter={})))
    assert any(f"a filter.decimate of {asked} leaves" in said for said in made.said)
    assert made.every == usual.every < 200
    few = RigFile.model_validate(description(filter={"decimate": 5}))
    assert prepare("log", {"t": t, "q": np.sin(5 * t), "u": np.cos(5 * t)}, few).every == 5


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        ({"cutoff": 1e-9}, r"filter\.cutoff of 1e-09 Hz leaves nothing of 10 s"),
        ({"drop": 10**9}, "only 0 s are left after the row filters"),
    ],
)
def test_filters_that_leave_nothing_are_refused(settings, sentence):
    t = np.arange(0, 10, 5e-3)
    with pytest.raises(DataError, match=sentence):
        rig = RigFile.model_validate(description(filter=settings))
        prepare("log", {"t": t, "q": np.sin(3 * t), "u": np.cos(3 * t)}, rig)


def test_a_speed_of_rest_above_the_motion_is_a_mistake():
    t = np.arange(0, 10, 5e-3)
    rig = RigFile.model_validate(description(rest_speed=1e10))
    made = prepare("log", {"t": t, "q": np.sin(3 * t), "u": np.cos(3 * t)}, rig)
    with pytest.raises(ConfigError, match=r"rest_speed: 1e\+10 .* moves at [\d.]+ rad/s \(RMS\)"):
        sizes_of(rig, None, [made])


@pytest.mark.parametrize("cutoff", [10.0, 20.0])
def test_the_way_that_no_log_shows_is_gone_in_the_time_of_the_last_filter(cutoff):
    rig = RigFile.model_validate(description(filter={"cutoff": cutoff}))
    t = np.arange(0, 20, 2e-3)
    w = 2 * np.pi
    made = prepare("log", {"t": t, "q": np.sin(w * t), "u": np.cos(w * t)}, rig)
    sizes, _ = sizes_of(rig, None, [made])
    time = 1.0 / (2 * np.pi * BELOW * cutoff)
    assert sizes.unseen == pytest.approx(0.5 * w**2 / np.sqrt(2) * time**2, rel=0.03)
