"""A stretch of effort that is none of this machine's is left out; what acts on the axis stays.

A servo that follows two tones, simulated with what acts on it, is logged with noise.
"""

from collections.abc import Callable

import numpy as np
import pytest

from spirob.machine.description.rig import RigFile
from spirob.machine.recordings.broken_stretches import least_absolute
from spirob.machine.recordings.recording import Recording, prepare
from tests.machine.rigs import description

RIG = RigFile.model_validate(description())
STEP, EVERY, SECONDS = 2.5e-4, 8, 10.0  # s; steps to a row; s
INERTIA, VISCOUS, DRY = 0.03, 0.06, 0.2
Acts = Callable[[float, float, float], float]  # time, position, speed -> torque on the axis
Columns = dict[str, np.ndarray]


def nothing(t: float, q: float, v: float) -> float:
    return 0.0


def tones(t: float) -> tuple[float, float]:
    w = 2 * np.pi * np.array([0.35, 0.9])
    return 0.5 * float(np.sin(w * t).sum()), 0.5 * float((w * np.cos(w * t)).sum())


def late_step(t: float) -> tuple[float, float]:
    """A slow motion, and one step in it."""
    return 0.3 * np.sin(0.6 * t) + 0.8 * (t > 4.0), 0.18 * np.cos(0.6 * t)


def servo(acts: Acts = nothing, stiff: float = 1.0, wanted=tones) -> Columns:
    noise, rows = np.random.default_rng(0), []
    q, v, u = wanted(0.0)[0], 0.0, 0.0
    for k in range(round(SECONDS / STEP)):
        t = k * STEP
        if k % EVERY == 0:
            aim, rate = wanted(t)
            u = stiff * (25.0 * (aim - q) + 1.5 * (rate - v))
            rows.append((t, q, u))
        v += STEP * (u - VISCOUS * v - DRY * np.tanh(v / 0.02) + acts(t, q, v)) / INERTIA
        q += STEP * v
    t, q, u = np.transpose(rows)
    more = noise.standard_normal((2, len(t)))
    return {"t": t, "q": q + 1e-4 * more[0], "u": u + 5e-3 * more[1]}


@pytest.fixture(scope="module")
def log() -> Columns:
    return servo()


def stretch(log: Columns, place: str, seconds: float) -> np.ndarray:
    begin = {"start": 0.0, "middle": 4.3, "end": SECONDS - seconds}[place]
    return (log["t"] >= begin) & (log["t"] <= begin + seconds)


def told(made: Recording) -> list[str]:
    return [said for said in made.said if "the same motion asks for elsewhere" in said]


def same_but_for(log: Columns, hurt: Columns, seconds: float) -> None:
    """One stretch is left out, with less than a second beside it, and all else is as it was."""
    made, clean = prepare("log", hurt, RIG), prepare("log", log, RIG)
    (said,) = told(made)
    assert said.startswith("log: 'u' is ")
    assert said.endswith("left out, as broken.")
    (piece,), (whole,) = made.pieces, clean.pieces
    lost = (np.count_nonzero(whole.use) - np.count_nonzero(piece.use)) * made.period
    assert lost < seconds + 1.0
    use, size = piece.use, np.ptp(whole.effort)
    np.testing.assert_allclose(piece.effort[use], whole.effort[use], atol=0.02 * size)
    np.testing.assert_array_equal(piece.a, whole.a)


@pytest.mark.parametrize("times", [5.0, 10.0, 50.0, 300.0, -20.0])
@pytest.mark.parametrize(
    ("place", "seconds"),
    [*((p, s) for p in ("start", "middle", "end") for s in (0.2, 0.5, 2.0)), ("middle", 0.05)],
)
def test_an_effort_too_large_for_a_while_is_left_out(log, place, seconds, times):
    broken = stretch(log, place, seconds)
    same_but_for(log, {**log, "u": np.where(broken, times * log["u"], log["u"])}, seconds)


@pytest.mark.parametrize("kind", ["another number", "noise", "beside it", "for good and all"])
def test_whatever_stands_in_its_place_is_left_out(log, kind):
    broken, most = stretch(log, "middle", 0.5), np.abs(log["u"]).max()
    noise = np.random.default_rng(1).standard_normal(len(broken))
    wrong = {
        "another number": 20.0 * most,
        "noise": 20.0 * most * noise,
        "beside it": log["u"] + 10.0 * most,
        "for good and all": 1e6 * most * noise,
    }[kind]
    same_but_for(log, {**log, "u": np.where(broken, wrong, log["u"])}, 0.5)


def test_two_of_different_size_are_left_out(log):
    u = log["u"].copy()
    u[stretch(log, "middle", 0.3)] *= 6.0
    u[(log["t"] > 7.5) & (log["t"] < 7.8)] *= 200.0
    made = prepare("log", {**log, "u": u}, RIG)
    assert [said.endswith("left out, as broken.") for said in told(made)] == [True, True]


def stop(t: float, q: float, v: float) -> float:
    """A hard stop, which the axis reaches again and again."""
    return -3000.0 * (q - 0.6) - 3.0 * v if q > 0.6 else 0.0


def rare_stop(t: float, q: float, v: float) -> float:
    """One that it reaches once or twice."""
    return -3000.0 * (q - 0.9) - 3.0 * v if q > 0.9 else 0.0


def load(t: float, q: float, v: float) -> float:
    """A load that comes and stays."""
    return -5.0 * (t > 6.0)


def late_load(t: float, q: float, v: float) -> float:
    return -5.0 * (t > 8.5)


def blow(t: float, q: float, v: float) -> float:
    return -8.0 * (5.0 < t < 5.3)


def clamp(t: float, q: float, v: float) -> float:
    """The axis is held for half a second."""
    return -60.0 * v * (5.0 < t < 5.5)


@pytest.mark.parametrize("acts", [nothing, stop, rare_stop, load, late_load, blow, clamp])
@pytest.mark.parametrize("stiff", [1.0, 5.0])
def test_what_acts_on_the_axis_stays(acts, stiff):
    made = prepare("log", servo(acts, stiff), RIG)
    assert not any(said.endswith("left out, as broken.") for said in made.said)
    assert acts is not nothing or not told(made)


@pytest.mark.parametrize("stiff", [1.0, 5.0])
def test_a_strong_start_out_of_a_slow_motion_stays(stiff):
    assert not told(prepare("log", servo(stiff=stiff, wanted=late_step), RIG))


def test_a_motion_as_nowhere_else_is_said():
    """A soft buffer, touched thrice in gentle motion."""
    made = prepare("log", servo(lambda t, q, v: -40.0 * max(0.0, q - 0.8)), RIG)
    assert all("a blow, a stop or a load? It is kept." in said for said in told(made))


def test_a_constant_force_that_lasts_is_said(log):
    """What a drive without any yield would carry."""
    force = 1.2 * np.abs(log["u"]).max() * stretch(log, "middle", 1.5)
    (said,) = told(prepare("log", {**log, "u": log["u"] + force}, RIG))
    assert said.endswith("a constant force would explain it: a load? It is kept.")


def test_a_brake_may_hold_any_effort(log):
    """An axis that stands, while its motor pushes."""
    held = stretch(log, "middle", 1.0)
    q = np.where(held, log["q"][np.argmax(held)], log["q"])
    after = np.cumsum(held) == held.sum()
    q = np.where(after & ~held, log["q"] - log["q"][np.argmax(after)] + q[np.argmax(held)], q)
    pushes = {**log, "q": q, "u": np.where(held, 30.0, log["u"])}
    assert not any(said.endswith("as broken.") for said in prepare("log", pushes, RIG).said)


def test_half_of_a_log_is_told_by_nothing(log):
    twice = {**log, "u": np.where(log["t"] < 5.0, 50.0 * log["u"], log["u"])}
    assert not told(prepare("log", twice, RIG))


def test_units_change_nothing(log):
    hurt = {**log, "u": np.where(stretch(log, "middle", 0.5), 50.0 * log["u"], log["u"])}
    small = {"t": hurt["t"], "q": np.degrees(hurt["q"]), "u": 1e3 * hurt["u"]}
    same = description()
    same["position"]["unit"], same["effort"]["unit"] = "deg", "m" + same["effort"]["unit"]
    one = prepare("log", hurt, RIG)
    other = prepare("log", small, RigFile.model_validate(same))
    assert told(one) == told(other)
    np.testing.assert_array_equal(one.pieces[0].use, other.pieces[0].use)


def test_a_fifth_of_wild_values_moves_no_number():
    rng = np.random.default_rng(0)
    columns, numbers = rng.standard_normal((500, 4)), np.array([3.0, -2.0, 0.5, 1e3])
    values = columns @ numbers
    values[:100] *= rng.uniform(-300.0, 300.0, 100)
    np.testing.assert_allclose(least_absolute(columns, values), numbers, rtol=1e-3)
