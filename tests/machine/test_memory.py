"""A log cut in pieces, or begun in motion, tells the same numbers as the whole one."""

from pathlib import Path

import numpy as np
import pytest

from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.motion import apart, bridged
from spirob.machine.recordings.recording import prepare
from spirob.machine.search.preparation import ready_of, search_of
from tests.machine.rigs import description, load
from tests.machine.rigs.axis import STEP, driven, reference, trials_of

SEEDS = (13120, 13121)
SHIFTED = 0.06  # of a number, by what a part of the log does not tell
LEFT = 5e-3  # of the effort: in a gap nobody knows what warmed or pushed


def elastic(seed):
    """A load that swings on its shaft: what a piece begins with is in no signal of the log."""
    made = load.shaft(seed)
    start = {"load_inertia": 0.02, "frequency": 5.5, "damping": 0.05}
    return made.rig, [*made.train, made.test], start, ["frequency"]


def lagging(seed):
    """A sensor of the effort that smooths over 50 ms."""

    def make(rng):
        def rubbed(q, v, t, u):
            return -0.05 * v - 0.3 * np.tanh(v / 0.02)

        log = driven(rubbed, reference(rng, 1.5, 2.5), 0.02, (8.0, 0.8))
        shown, now = [], 0.0
        for effort in log["u"]:
            now = effort + (now - effort) * np.exp(-0.002 / 0.05)
            shown.append(now)
        return {**log, "u": np.array(shown)}

    made = trials_of(make, np.random.default_rng(seed), 0.01)
    return description(), made, {"time": 0.04}, ["time"]


def warming(seed):
    """A motor that warms up within ten seconds and gives less torque for an ampere."""

    def make(rng):
        warmth = 0.0

        def weakened(q, v, t, u):
            nonlocal warmth
            warmth += STEP * (0.005 * u * u - warmth / 20.0)
            return u / (1.0 + warmth) - u - 0.05 * v

        return driven(weakened, reference(rng, 3.5, 1.5), 0.03, (8.0, 0.8))

    made = trials_of(make, np.random.default_rng(seed), 0.01)
    effort = {"column": "u", "unit": "A", "kind": "current"}
    start = {"heating": 0.005, "time": 20.0}  # of ten seconds neither can be told well
    return description(effort=effort), made, start, []


def whole(log):
    return np.ones(len(log["t"]), bool)


def begun_in_motion(log):
    return log["t"] > 3.3


def cut(log):
    return np.mod(log["t"], 1.9) < 1.6


def fitted(rig, logs, effects, start, rows):
    """The numbers of a model with these effects, and what it leaves of the effort."""
    read = RigFile.model_validate({**rig, "effects": list(effects)})
    kept = [{name: values[rows(log)] for name, values in log.items()} for log in logs]
    made = [prepare(f"log {k}", log, read) for k, log in enumerate(kept)]
    search, _ = search_of(ready_of(read, Path(), made[:-1], made[-1:]))
    found = search.models.fitted((), {f"{effects[0]}.{n}": v for n, v in start.items()})
    told = {name.partition(".")[2]: value for name, value in found.fit.changes.items()}
    return told, np.sqrt(np.mean(found.fit.residual**2)) / search.models.size


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(
    ("machine", "effects", "ways"),
    [
        (elastic, ["gear_compliance"], (begun_in_motion, cut)),
        (lagging, ["current_lag", "coulomb_friction"], (begun_in_motion, cut)),
        (warming, ["winding_heating"], (cut,)),  # a log begins with a cold motor
    ],
)
def test_parts_of_a_log_tell_the_numbers_of_the_whole(machine, effects, ways, seed):
    rig, logs, start, names = machine(seed)
    told, left = fitted(rig, logs, effects, start, whole)
    for way in ways:
        parts, more = fitted(rig, logs, effects, start, way)
        assert more < LEFT + left, way.__name__
        for name in names:
            assert parts[name] == pytest.approx(told[name], rel=SHIFTED), (way.__name__, name)


HEATING, COOLING = 0.01, 8.0  # 1/(A²·s), s


def heated(seed, warmth, heating=HEATING, scale=1.0):
    """A log of a motor that begins so warm, or whose effort has another scale."""
    rng, t = np.random.default_rng(seed), 0.01 * np.arange(3000)
    tones, phases = 2 * np.pi * rng.uniform([0.3, 0.8], [0.4, 1.0]), rng.uniform(0, 6, 2)
    angle, sizes = np.outer(t, tones) + phases, np.array([1.5, 0.4])
    q, v, a = (
        np.sin(angle) @ sizes,
        np.cos(angle) @ (sizes * tones),
        -np.sin(angle) @ (sizes * tones**2),
    )
    effort = np.empty(len(t))
    for k, torque in enumerate(0.05 * a + 0.1 * v):
        effort[k] = torque * (1.0 + warmth)
        ends = heating * COOLING * effort[k] ** 2
        warmth = ends + (warmth - ends) * np.exp(-0.01 / COOLING)
    noise = 1e-3 * rng.standard_normal(len(t))
    return {"t": t, "q": q, "u": scale * effort + noise}


def test_a_motor_that_is_warm_where_a_log_begins_tells_the_same_heat():
    rig = description(effort={"column": "u", "unit": "A", "kind": "current"})
    start = {"heating": 0.007, "time": 12.0}
    logs = [heated(k, warmth) for k, warmth in enumerate((0.0, 0.12, 0.06))]
    told, left = fitted(rig, logs, ["winding_heating"], start, whole)
    assert told["heating"] == pytest.approx(HEATING, rel=0.05)
    assert told["time"] == pytest.approx(COOLING, rel=0.05)
    assert left < LEFT


def test_logs_of_another_scale_are_not_made_alike_by_heat_they_begin_with():
    rig = description(effort={"column": "u", "unit": "A", "kind": "current"})
    logs = [heated(k, 0.0, 0.0, scale) for k, scale in enumerate((1.0, 1.1, 0.95))]
    start = {"heating": 1e-4, "time": 2000.0}
    _, left = fitted(rig, logs, ["winding_heating"], start, whole)
    assert left > 5.0 * LEFT


def test_a_memory_takes_a_straight_line_through_a_gap_in_as_many_steps():
    starts, steps = np.array([0, 3, 5]), np.array([0.1, 0.1])
    seconds = np.array([0.0, 0.1, 0.2, 0.6, 0.7])
    way = bridged(starts, steps, seconds, (False, True))
    assert way.anew.tolist() == [True, False, False]
    assert way.over(10.0 * seconds[None])[0] == pytest.approx(np.arange(8.0))
    assert way.steps == pytest.approx(0.1)
    assert way.rows.tolist() == [0, 1, 2, 6, 7]


def test_a_night_between_two_pieces_takes_few_steps():
    seconds = np.array([0.0, 0.001, 3e4, 3e4 + 0.001])
    way = bridged(np.array([0, 2, 4]), np.array([1e-3, 1e-3]), seconds, (False, True))
    assert len(way.share) < 1100
    assert np.sum(way.steps * np.diff(way.starts)) == pytest.approx(3e4, rel=1e-3)


def test_pieces_that_overlap_by_part_of_a_row_are_a_row_apart():
    seconds = np.array([0.0, 0.1, 0.2, 0.15, 0.25])
    way = bridged(np.array([0, 3, 5]), np.array([0.1, 0.1]), seconds, (False, True))
    assert way.steps[1] == pytest.approx(0.05)
    assert way.rows.tolist() == [0, 1, 2, 4, 5]


def test_a_memory_that_begins_anew_goes_through_the_rows_of_the_motion():
    way = apart(np.array([0, 2, 5]), np.array([0.1, 0.2]))
    assert way.over(np.arange(5.0)[None])[0].tolist() == [0, 1, 2, 3, 4]
    assert way.anew.all()
