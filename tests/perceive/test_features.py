"""Features tell the size of the object and little else."""

import numpy as np
import pytest

from spirob.errors import ConfigError, DataError, MissingChannel, TooShort
from spirob.logs.trace import Trace
from spirob.perceive.features import FEATURES, extract, table
from spirob.trials.trial import wrap_trial
from tests.perceive.conftest import changed, simulate

STEADY = {"placement": 0.0, "speed_variation": 0.0, "friction_variation": 0.0}
LEADING = ("onset_stroke", "half_rise_stroke", "end_stroke", "half_rise_time", "phase_delay")


def ranges(known):
    return known.max() - known.min()


def test_every_feature_is_documented_and_of_a_known_kind():
    assert {f.kind for f in FEATURES.values()} == {"temporal", "spectral", "electromechanical"}
    for feature in FEATURES.values():
        assert feature.unit, feature.name
        assert feature.meaning.endswith("."), feature.name


def test_strokes_and_times_fall_with_every_step_of_diameter(plant):
    rng = np.random.default_rng(0)
    sizes = np.arange(0.01, 0.0701, 0.005)
    rows = [simulate(plant, wrap_trial("steady", "train", s, STEADY, rng)) for s in sizes]
    found = [extract(row) for row in rows]
    for name in LEADING:
        assert (np.diff([row[name] for row in found]) < 0).all(), name
    stroke = np.array([row["end_stroke"] for row in found])
    assert (-np.diff(stroke) / np.diff(sizes)).min() > 0.2


def test_a_later_start_changes_nothing(wraps, known):
    trace = wraps[9]
    late = {
        name: np.concatenate([np.full(700, trace[f"left.{name}"][0]), trace[f"left.{name}"]])
        for name in ("current", "displacement", "velocity")
    }
    # the last 10 % of the log count as the plateau, and the log is longer now
    shift = {n: abs(extract(changed(trace, **late))[n] - v) for n, v in extract(trace).items()}
    for name, value in shift.items():
        assert value < 2e-3 * ranges(known)[name], name


def test_sensor_noise_hardly_matters(wraps, known):
    rng = np.random.default_rng(1)
    trace = wraps[9]
    speed_step = 2 * np.pi / 60 / (3591 / 187) * 0.02
    noisy = changed(
        trace,
        current=trace["left.current"] + 0.01 * rng.standard_normal(len(trace)),
        displacement=np.floor(trace["left.displacement"] / 8e-7) * 8e-7,
        velocity=np.rint(trace["left.velocity"] / speed_step) * speed_step,
    )
    clean, found = extract(trace), extract(noisy)
    for name in LEADING:
        assert abs(found[name] - clean[name]) < 0.01 * ranges(known)[name], name


def test_a_scaled_and_offset_current_is_the_same_wrap(wraps, known):
    # efficiency scales the current; a constant friction torque or a sensor offset adds to it
    trace = wraps[9]
    other = changed(trace, current=1.3 * trace["left.current"] + 0.1)
    clean, found = extract(trace), extract(other)
    for name in (n for n in FEATURES if FEATURES[n].kind == "electromechanical"):
        assert found[name] == pytest.approx(clean[name], rel=1e-6, abs=1e-9), name


def test_more_friction_in_the_motor_is_no_other_size(plant, known):
    rng = np.random.default_rng(0)
    plain = wrap_trial("steady", "train", 0.04, STEADY, rng)
    light, heavy = (
        extract(simulate(plant, plain, {"motor.rotor_damping": b})) for b in (5e-5, 1.5e-4)
    )
    for name in ("onset_stroke", "half_rise_stroke", "end_stroke"):
        assert abs(heavy[name] - light[name]) < 0.06 * ranges(known)[name], name


def test_the_table_holds_the_features_and_the_truth(wraps):
    found = table(wraps[:2])
    assert list(found.columns) == [*FEATURES, "diameter"]
    assert found["diameter"].tolist() == [0.01, 0.01]
    assert found.index.tolist() == [w.name for w in wraps[:2]]


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda t: {"current": np.full(len(t), np.nan)}, "non-finite"),
        (lambda t: {"displacement": np.zeros(len(t))}, "nothing was wrapped"),
        (lambda t: {"current": np.full(len(t), 0.5)}, "saturated all along"),
        (lambda t: {"current": 0.5 - 0.4 * (t.seconds > 3)}, "does not rise"),
        (
            lambda t: {
                "displacement": 0.045 * t.seconds,
                "velocity": np.full(len(t), 0.045),
                "current": np.full(len(t), 0.5),
            },
            "still moves at 45.0 mm/s",
        ),
        (lambda t: {"displacement": 0.01 * np.sin(np.pi * t.seconds / 4.499)}, "paid out again"),
    ],
)
def test_a_log_that_is_no_wrap_is_told_in_a_sentence(wraps, change, says):
    with pytest.raises(DataError, match=says) as caught:
        extract(changed(wraps[0], **change(wraps[0])))
    assert wraps[0].name in str(caught.value)


def test_too_short_and_incomplete_logs_are_told(wraps):
    trace = wraps[0]
    cut = {name: values[:400] for name, values in trace.signals.items()}
    with pytest.raises(TooShort, match="wrap_10_0: 400 samples"):
        extract(Trace(trace.name, trace.time_ns[:400], cut, trace.units))
    with pytest.raises(MissingChannel, match=r"right\.current"):
        extract(trace, motor="right")
    with pytest.raises(ConfigError, match="no feature 'colour'"):
        extract(trace, names=["colour"])
    with pytest.raises(DataError, match="no cylinder"):
        table([Trace(trace.name, trace.time_ns, trace.signals, trace.units)])
    with pytest.raises(DataError, match="two wraps have the name"):
        table([trace, trace])
