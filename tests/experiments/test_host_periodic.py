"""The wheel with the loop on the host: periods, how sure they are, and when all is settled."""

import re

import numpy as np
import pytest

from spirob.errors import ConfigError
from spirob.experiments import Side
from spirob.experiments.host_periodic import HostPeriodic, judged
from spirob.experiments.passive import (
    BEYOND,
    OPEN,
    WITHIN,
    Figure,
    bootstrap,
    compared,
    highest,
    interval,
    line,
    off,
)

COUNT = 20 / 16384


def test_the_wheel_has_a_row_for_every_rule_and_set():
    experiment = HostPeriodic(bandwidths=(5.0, 20.0), shares=(0.0,), places=(0.25, 0.55, 0.85))
    t = np.arange(4500) * 1e-3
    still = np.zeros((4500, 2))
    sides = {}
    plays = experiment.plays()
    while plays:
        for play in plays:
            swing = 0.0 if "free" in play.name else 20 * COUNT
            current = np.repeat((0.8 + swing * np.sin(2 * np.pi * t / 0.4))[:, None], 2, axis=1)
            sides[play.name] = {s: Side(current, still, still, still) for s in ("robot", "named")}
        plays = experiment.more(sides)
    assert len(sides) == 2 * 4 * 8  # alike to a bit, so that the least plays settle all
    rows = {r["what"]: r for r in experiment.measure(sides)}
    for bandwidth in (5, 20):
        at = f"current, {bandwidth} Hz without back-EMF, at 85%"
        assert rows[f"apparent period of {at}"]["robot"] == pytest.approx(0.4, rel=0.01)
        assert rows[f"apparent period of {at}"]["met"]
        gap = rows[f"interval between peaks of {at}"]
        assert gap["named"] == pytest.approx(0.4, rel=0.01)
        assert gap["met"]
        assert gap["note"].startswith("8 plays each, standard error 0.000 s of the robot's")
        inner = at.replace("85%", "25%")
        assert rows[f"interval between peaks of {inner}"]["met"]
        assert rows[f"strongest line of {at}"]["met"]
    assert rows["apparent period of filtered, 5 Hz without back-EMF, at 25%"]["paper"] == 0.4


def test_peaks_that_stand_out_are_a_period_and_noise_is_none():
    rng = np.random.default_rng(3)
    t = np.arange(4000) * 1e-3
    noise = rng.normal(size=4000)
    pulses = 40 * np.exp(-(((t % 0.35) - 0.1) ** 2) / 2e-4)
    assert interval([pulses + noise], 2 * highest(noise)).value == pytest.approx(0.35, abs=2e-3)
    assert np.isnan(interval([rng.normal(size=4000)], 2 * highest(noise)).value)
    assert highest(np.zeros(100)) == 0.0


def test_a_model_is_within_or_beyond_by_two_standard_errors_of_both():
    robot = Figure(0.4, 0.003)
    assert compared(Figure(0.42, 0.004), robot, 0.1) == WITHIN  # 5 ± 1.3 %
    assert compared(Figure(0.46, 0.004), robot, 0.1) == BEYOND  # 15 ± 1.3 %
    assert compared(Figure(0.433, 0.004), robot, 0.1) == OPEN  # 8.3 ± 1.3 %
    assert compared(Figure(0.42, 0.02), robot, 0.1) == OPEN
    apart = off(Figure(0.42, 0.004), robot)
    assert (apart.value, apart.error) == pytest.approx((0.05, 0.0127), rel=0.01)


def test_a_period_is_met_missed_not_settled_or_none():
    robot, none = Figure(0.4, 0.003), Figure(np.nan, np.nan)
    assert judged({"robot": robot, "named": Figure(0.41, 0.004)}, 8)["met"] is True
    assert judged({"robot": robot, "named": Figure(0.48, 0.004)}, 8)["met"] is False
    told = judged({"robot": robot, "named": Figure(0.43, 0.01)}, 8)
    assert told["met"] == "not settled"
    assert told["note"].endswith("+7.5% ± 2.6% off; not settled")
    unsure = judged({"robot": Figure(0.9, 0.3), "named": Figure(0.3, 0.01)}, 8)  # of two lines
    assert unsure["met"] == "not settled"
    assert unsure["note"].endswith("not settled, the robot's own is not sure to 10%")
    assert judged({"robot": none, "named": robot}, 8)["met"] == "no period"
    assert judged({"robot": robot, "named": none}, 8)["met"] is False
    assert judged({"robot": robot, "named": robot}, 1) == {}
    assert judged({"robot": robot}, 8) == {}


def test_the_error_of_many_plays_is_that_of_their_mean():
    plays = np.random.default_rng(4).normal(0.5, 0.05, (16, 1))
    found = bootstrap(plays, lambda each: float(each.mean()))
    assert found.value == pytest.approx(plays.mean())
    assert found.error == pytest.approx(plays.std(ddof=1) / 4, rel=0.15)
    assert np.isnan(bootstrap(plays[:1], lambda each: float(each.mean())).error)


def swings(rng, spread, shares):
    """A play: 12 s of lines whose heights [counts] differ from play to play, periods 0.3, 0.9 s."""
    t = np.arange(12000) * 1e-3
    sizes = np.array(shares) * rng.normal(1.0, spread, 2)
    turns = t / np.array([[0.3], [0.9]]) + rng.uniform(size=(2, 1))
    lines = sizes[:, None] * np.sin(2 * np.pi * turns)
    return lines.sum(axis=0) + rng.normal(size=len(t))


def test_of_two_lines_as_high_no_period_is_sure_and_a_mean_of_both_is_none():
    rng = np.random.default_rng(6)
    either, _ = line([swings(rng, 0.3, (4.0, 4.0)) for _ in range(8)], 0.02, 1.5)
    assert min(abs(either.value - 0.3), abs(either.value - 0.9)) < 0.03  # not 0.6
    assert either.error > 0.1
    higher, size = line([swings(rng, 0.3, (4.0, 1.0)) for _ in range(8)], 0.02, 1.5)
    assert (higher.value, size) == (pytest.approx(0.3, abs=0.01), pytest.approx(4.0, rel=0.3))
    assert higher.error < 0.01


def wheel(gap, irregular, small=1.0):
    """Plays of an experiment in which a robot comes back every 0.4 s, a model every `gap` [s].

    irregular  deviation of each return [s];  small  height of every second, of 40 counts
    """
    experiment = HostPeriodic(bandwidths=(10.0,), shares=(0.0,), places=(0.85,))
    rng, sides, still = np.random.default_rng(5), {}, np.zeros((12500, 2))
    new = experiment.plays()
    while new:
        for play in new:
            sides[play.name] = {}
            for side, period in (("robot", 0.4), ("named", gap)):
                counts = np.zeros(12500)
                if "free" not in play.name:
                    at = (period + rng.normal(0.0, irregular, 60)).cumsum()
                    t = np.arange(12500) * 1e-3
                    high = np.tile([40.0, 40.0 * small], 30)
                    counts = np.exp(-(((t[:, None] - at) / 0.03) ** 2)) @ high
                noisy = 0.8 + COUNT * (counts + rng.normal(size=12500))
                current = np.repeat(noisy[:, None], 2, axis=1)
                sides[play.name][side] = Side(current, still, still, still)
        new = experiment.more(sides)
    rows = {r["what"]: r for r in experiment.measure(sides)}
    hits = sum("_85" in name for name in sides)
    return rows["interval between peaks of current, 10 Hz without back-EMF, at 85%"], hits


def test_the_wheel_is_played_until_a_period_is_settled():
    told, plays = wheel(0.41, 0.01)
    assert (told["met"], plays) == (True, 8)
    told, plays = wheel(0.6, 0.01)
    assert (told["met"], plays) == (False, 8)
    told, plays = wheel(0.44, 0.1)
    assert (told["met"], plays) == ("not settled", 16)
    assert told["note"].startswith("16 plays each")


@pytest.mark.parametrize(("apart", "met"), [(0.01, False), (0.15, "a matter of the build")])
def test_a_line_that_builds_of_the_model_do_not_share_is_a_matter_of_the_build(apart, met):
    """Robot 0.4 s, named model 0.6 s, its builds about that by so many seconds either way."""
    experiment = HostPeriodic(bandwidths=(10.0,), shares=(0.0,), places=(0.85,), least=2, builds=4)
    t, still, sides = np.arange(12500) * 1e-3, np.zeros((12500, 2)), {}
    new = experiment.plays()
    while new:
        for play in new:
            own = 0.6 + apart * (-1) ** (play.built or 0)
            periods = {"robot": 0.4, "named": 0.6} if play.built is None else {"built": own}
            sides[play.name] = {}
            for side, period in periods.items():
                swing = 0.0 if "free" in play.name else 20 * COUNT
                current = np.repeat((swing * np.sin(2 * np.pi * t / period))[:, None], 2, axis=1)
                sides[play.name][side] = Side(current, still, still, still)
        new = experiment.more(sides)
    assert sum("_build" in name for name in sides) == 2 * 4 * 2
    rows = {r["what"]: r for r in experiment.measure(sides)}
    told = rows["apparent period of current, 10 Hz without back-EMF, at 85%"]
    assert told["met"] == met
    low, high = re.search(r"; 4 builds of the model have (.+) to (.+) s$", told["note"]).groups()
    assert (float(low), float(high)) == pytest.approx((0.6 - apart, 0.6 + apart), abs=0.02)
    assert told["named"] == pytest.approx(0.6, rel=0.01)


def test_an_interval_that_follows_the_height_of_a_peak_is_no_period():
    """Every second peak of the robot's is small: as high as the noise, not twice as high."""
    told, plays = wheel(0.41, 0.01, small=0.06)
    assert (told["met"], plays) == ("no period", 8)
    assert told["note"].startswith("no period of the robot's: 0.40 s between peaks of ")
    assert " counts, 0.80 s of twice that" in told["note"]


def test_plays_of_the_wheel_are_two_at_least():
    with pytest.raises(ConfigError, match=r"paper\.host_periodic\.least = 1, most = 16: two plays"):
        HostPeriodic(least=1)
    with pytest.raises(ConfigError, match=r"least = 8, most = 3"):
        HostPeriodic(most=3)


def test_irregular_returns_have_one_line_in_the_mean_spectrum():
    rng = np.random.default_rng(1)
    t = np.arange(12000) * 1e-3
    gaps = rng.uniform(0.55, 0.65, 30).cumsum()
    values = sum(np.exp(-(((t - at) / 0.1) ** 2)) for at in gaps) * 8.0 + rng.normal(size=len(t))
    period, size = line([values], 0.02, 1.5)
    assert period.value == pytest.approx(0.6, rel=0.03)
    assert size > 1.0
    period, size = line([3.0 * np.sin(2 * np.pi * t / 0.4)], 0.02, 1.5)
    assert (period.value, size) == pytest.approx((0.4, 3.0), rel=0.01)


def test_every_figure_of_a_current_has_the_reconstructed_one_beside_it():
    experiment = HostPeriodic(bandwidths=(5.0,), shares=(0.0,), places=(0.85,), duration=4.5)
    t = np.arange(4500) * 1e-3
    swing = np.repeat((20 * COUNT * np.sin(2 * np.pi * t / 0.4))[:, None], 2, axis=1)
    still = np.zeros((4500, 2))
    sides = {}
    for play in experiment.plays():
        moved = still if "free" in play.name else swing
        sides[play.name] = {
            "robot": Side(moved, still, still, still),
            "named": Side(moved, still, still, still, arm_current=2 * moved),
            "single": Side(None, 1e-3 * moved, still, still),
        }
    drawn = {(c["quantity"], c["side"]): np.ptp(c["y"]) for c in experiment.curves(sides)}
    for side in ("robot", "named"):
        assert drawn["current", side] == pytest.approx(40, rel=0.05)
    assert drawn["reconstructed", "named"] == pytest.approx(80, rel=0.05)
    assert drawn["reconstructed", "robot"] == pytest.approx(40, rel=0.05)
    rows = {r["what"]: r for r in experiment.measure(sides)}
    told = rows["apparent period of reconstructed current, 5 Hz without back-EMF, at 85%"]
    assert told["named"] == pytest.approx(0.4, rel=0.01)
    assert (told["robot"], told["single"]) == (None, "none")
    measured = rows["apparent period of current, 5 Hz without back-EMF, at 85%"]
    assert (measured["note"], measured["met"]) == ("", None)  # the robot has played once
    assert measured["single"] == "none"
    assert rows["swing of current, 5 Hz without back-EMF, at 85%"]["single"] == 0.0
    angle = rows["apparent period of angle, 5 Hz without back-EMF, at 85%"]
    assert angle["single"] == pytest.approx(0.4, rel=0.01)
    assert drawn["angle", "single"] > 0.0 == drawn["current", "single"]
