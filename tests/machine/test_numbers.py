"""Numbers that a log has for itself: recovered, fixed where only differences count, refused."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from spirob.errors import ConfigError
from spirob.machine import axis
from spirob.machine.axis import diagnose_recordings
from spirob.machine.description.rig import RigFile
from spirob.machine.inverse.numbers import log_numbers, with_payload
from spirob.machine.inverse.problem import InverseProblem
from spirob.machine.inverse.scaling import Sizes
from spirob.machine.recordings.recording import prepare
from spirob.machine.search.differing import may_differ, plainest, tells
from spirob.machine.search.preparation import ready_of, search_of
from tests.machine.judging import OTHERS
from tests.machine.rigs import description

SIZES = Sizes(0.5, 2.0, 1.0, 4.0, 0.5, 0.1, "N·m", "N·m", "rad")
INERTIA, VISCOUS, WEIGHT, ADDED = 0.02, 0.1, 0.8, 0.01


def log(k, offset=0.0, payload=0.0, coulomb=0.0, load=0.0, length=12.0, zero=0.3):
    """An axis that swings a payload on a lever; dry friction, also in proportion to the load."""
    t = np.arange(0, length, 4e-3)
    w = 1.3 + 0.4 * k
    q = 1.1 * np.sin(w * t) + 0.4 * np.sin(2.7 * w * t + k)
    v, a = np.gradient(q, t), np.gradient(np.gradient(q, t), t)
    carried = (INERTIA + payload * ADDED) * a + payload * WEIGHT * np.sin(q - zero)
    dry = (coulomb + load * np.abs(carried)) * np.tanh(v / 0.02)
    noise = np.random.default_rng(k).normal(0, 2e-3, len(t))
    return {"t": t, "q": q, "u": carried + VISCOUS * v + dry + offset + noise}


def rig(**changes):
    return RigFile.model_validate(description(**changes))


def recordings(made, rig):
    return [prepare(f"{k}.csv", columns, rig) for k, columns in enumerate(made)]


def test_held_out_logs_have_their_own_offset_fitted_and_nothing_else():
    described = rig(per_log=["offset"])
    logs = recordings([log(0, offset=0.5), log(1, offset=-0.2)], described)
    numbers = log_numbers(described, logs, SIZES)
    made = InverseProblem(described, None, logs[1:], [], SIZES, 0.02, numbers, ["offset.1.csv"])
    found = made.completed({"rig.inertia": INERTIA, "rig.viscous": VISCOUS})
    assert found["offset.1.csv"] == pytest.approx(-0.2, abs=2e-3)
    left = made({"rig.inertia": INERTIA, "rig.viscous": VISCOUS})
    assert np.sqrt(np.mean(left**2)) < 4e-3


def test_what_counts_only_against_other_logs_is_fixed_for_the_first():
    described = with_payload(rig(per_log=["payload", "zero", "offset"]), SIZES)
    numbers = log_numbers(described, recordings([log(0), log(1)], described), SIZES)
    assert numbers.known == {"payload.0.csv": 1.0, "zero.0.csv": 0.0}
    assert numbers.fitted(["1.csv"]) == ["offset.1.csv", "payload.1.csv", "zero.1.csv"]
    assert {"payload_inertia", "payload_cosine", "payload_sine"} <= set(described.fit)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"logs": {"other.csv": {"offset": 0.1}}}, "no such log; given are 0.csv, 1.csv"),
        ({"logs": {"0.csv": {"payload": 0.1}}}, r"logs\.1\.csv: has no payload"),
    ],
)
def test_a_log_that_is_not_there_or_left_out_is_a_sentence(changes, sentence):
    described = rig(**changes)
    with pytest.raises(ConfigError, match=sentence):
        log_numbers(described, recordings([log(0), log(1)], described), SIZES)


def diagnosed(described, made, held):
    logs = recordings([*made, *held], described)
    return diagnose_recordings(
        described, None, logs[: len(made)], logs[len(made) :], without=OTHERS
    )


def test_a_zero_that_moved_is_recovered_where_a_spring_tells_it():
    described = rig(per_log=["zero"], known={"stiffness": 0.5})
    t = np.arange(0, 12, 4e-3)
    q = np.sin(1.7 * t) + 0.4 * np.sin(4.1 * t)
    v, a = np.gradient(q, t), np.gradient(np.gradient(q, t), t)
    made = [{"t": t, "q": q, "u": INERTIA * a + VISCOUS * v + 0.5 * (q - z)} for z in (0.0, 0.3)]
    logs = recordings(made, described)
    numbers = log_numbers(described, logs, SIZES)
    problem = InverseProblem(described, None, logs[1:], [], SIZES, 0.02, numbers, ["zero.1.csv"])
    found = problem.completed({"rig.inertia": INERTIA, "rig.viscous": VISCOUS})
    assert found["zero.1.csv"] == pytest.approx(0.3, abs=1e-3)


def test_a_zero_of_a_log_is_that_of_a_column():
    zero, made = 0.3, log(0)
    by_column = rig(position={"column": "q", "unit": "rad", "zero": zero}, known={"stiffness": 0.5})
    by_log = rig(logs={"0.csv": {"zero": zero}}, known={"stiffness": 0.5})
    found = []
    for described in (by_column, by_log):
        logs = recordings([made], described)
        numbers = log_numbers(described, logs, SIZES)
        problem = InverseProblem(described, None, logs, [], SIZES, 0.02, numbers)
        found.append(problem({"rig.inertia": INERTIA}))
    assert found[0] == pytest.approx(found[1], abs=1e-9)


def test_a_repeated_search_that_cannot_be_leaves_the_verdict_of_the_first(monkeypatch):
    monkeypatch.setattr(axis, "untaught", lambda *told: "The held-out logs show more.")
    late = rig(known={"delay": -3.0})
    found = diagnosed(late, [log(0, length=8.0)], [log(1, length=8.0)])
    assert found.verdict
    assert any("The held-out logs show more." in said for said in found.notes)


def test_logs_under_another_force_each_are_found_to_differ():
    made = [log(0, offset=0.3), log(1, offset=0.9), log(2, offset=-0.4)]
    found = diagnosed(rig(), made, [log(3, offset=0.1)])
    assert found.verdict == "nothing_missing"
    assert any("a number of their own, offset" in said for said in found.notes)


def pressed(k, force):
    """A cylinder at a pressure of its own, moved to and fro: force [N], way [mm], dry seals."""
    rng, t = np.random.default_rng(k), np.arange(0, 60, 0.02)
    q = gaussian_filter1d(30.0 * np.abs(((2.0 * t / (8 + k)) % 2) - 1.0), 15)
    u = force + 8.0 * np.tanh(np.gradient(q, t) / 0.5) + 0.02 * force * np.sin(q / 9.0)
    return {"t": t, "q": q + rng.normal(0, 0.01, len(t)), "u": u + rng.normal(0, 0.3, len(t))}


def test_a_force_of_each_log_is_asked_before_what_a_search_finds_in_its_place():
    """A current's offset, heating and saturation take what two pressures differ by."""
    cylinder = rig(
        position={"column": "q", "unit": "mm"},
        effort={"column": "u", "unit": "N", "kind": "force"},
        known={"inertia": 0.0},
        fit={"viscous": {"nominal": 100.0, "low": 0.0, "high": 1e5}},
        filter={},
    )
    logs = recordings([pressed(k, force) for k, force in enumerate((350, 150, 250))], cylinder)
    found = diagnose_recordings(cylinder, None, logs[:2], logs[2:]).document
    assert (found["verdict"], found["doubts"]) == ("nothing_missing", [])
    assert any("a number of their own" in said for said in found["repairs"])
    bare = found["ladder"][0]["test"]["rmse"]
    assert bare < 0.01 * found["effort_rms"]["test"]


def test_a_mount_that_was_moved_is_no_payload():
    made = [log(k, payload=1.0, zero=z) for k, z in enumerate((0.0, 0.6, -0.5))]
    found = diagnosed(rig(), made, [log(3, payload=1.0, zero=0.3)])
    assert [f.name for f in found.findings] == ["tip_payload"], found.sentence
    told = next(said for said in found.notes if "a number of their own, zero" in said)
    assert re.search(r"held-out logs leave 0\.\d+% of the effort, with offset \d+\.", told)
    numbers = found.findings[0].numbers
    assert numbers["sine"]["value"] == pytest.approx(WEIGHT, rel=0.01)


@pytest.mark.parametrize(("left", "best"), [(1.0, "zero"), (1.5, "payload")])
def test_of_kinds_that_leave_the_same_the_one_with_fewest_numbers_is_taken(left, best):
    """A payload with its inertia, sine and cosine gives what a zero that moved gives, and more."""
    numbers = {"offset": (4, 90.0), "zero": (5, left), "payload": (8, 0.98)}
    fits = {
        kind: SimpleNamespace(heldout_square=square, fit=SimpleNamespace(estimates=range(count)))
        for kind, (count, square) in numbers.items()
    }
    assert plainest(fits, 0.5) == best


def test_zeros_of_logs_that_nothing_tells_are_told():
    made = [log(0, coulomb=0.1), log(1, coulomb=0.1)]
    found = diagnosed(rig(per_log=["zero"]), made, [log(2, coulomb=0.1)])
    assert [f.name for f in found.findings] == ["coulomb_friction"], found.sentence
    assert any("nothing in the model depends on the position" in said for said in found.notes)


def test_three_payloads_tell_friction_that_grows_with_load():
    made = [log(k, payload=m, load=0.12) for k, m in enumerate((0.5, 1.0, 2.0))]
    held = [log(k + 3, payload=m, load=0.12) for k, m in enumerate((0.5, 2.0))]
    given = {f"{k}.csv": {"payload": m} for k, m in enumerate((0.5, 1.0, 2.0, 0.5, 2.0))}
    for described in (rig(logs=given), rig(per_log=["payload"])):
        found = diagnosed(described, made, held)
        assert [f.name for f in found.findings] == ["load_dependent_friction"], found.sentence


@pytest.mark.parametrize(
    ("kind", "numbers", "told"),
    [
        ("payload", {"payload.b": (1.5, 1.7), "rig.payload_inertia": (0.1, 0.3)}, True),
        ("payload", {"payload.b": (0.9, 1.7), "rig.payload_inertia": (0.1, 0.3)}, False),
        ("payload", {"payload.b": (1.5, 1.7), "rig.payload_inertia": (0.0, 22.0)}, False),
        ("payload", {"payload.a": (0.2, 0.3), "payload.b": (0.4, 0.5)}, True),
        ("zero", {"zero.b": (0.1, 0.2)}, True),
        ("zero", {"zero.b": (-0.1, 0.2)}, False),
        ("offset", {"offset.a": (0.1, 0.2), "offset.b": (0.1, 0.2)}, False),
        ("offset", {"offset.a": (-0.1, 0.0), "offset.b": (0.1, 0.2)}, True),
    ],
)
def test_logs_differ_where_the_intervals_of_their_numbers_lie_apart(kind, numbers, told):
    estimates = {name: SimpleNamespace(low=a, high=b) for name, (a, b) in numbers.items()}
    model = SimpleNamespace(fit=SimpleNamespace(estimates=estimates))
    assert tells(kind, model) == told
    idle = numbers.get("rig.payload_inertia") == (0.0, 22.0)
    assert tells(kind, model, alone=True) == (not idle)


def at_one_speed(k, forces, back, changing):
    """A screw against dry friction at a speed of its own in each log, one way or both."""
    t = np.arange(0, 8, 4e-3)
    way = np.sign(np.sin(np.pi / 4 * t + 0.1)) if back else (-1) ** k
    v = way * (1.0 + 0.5 * k) * (1.0 + changing * np.sin(2 * np.pi * 0.4 * t))
    noise = np.random.default_rng(k).normal(0, 2e-3, len(t))
    friction = VISCOUS * v + 0.3 * np.tanh(v / 0.02)
    effort = INERTIA * np.gradient(v, t) + friction + forces[k] + noise
    return {"t": t, "q": np.cumsum(v) * 4e-3, "u": effort}


@pytest.mark.parametrize(
    ("apart", "back", "changing", "differ"),
    [
        (False, False, 0.2, False),  # each goes one way: a force of each is the dry friction
        (True, False, 0.9, False),
        (False, True, 0.0, False),
        (True, True, 0.5, True),
    ],
)
def test_a_force_of_each_log_is_none_where_it_would_be_friction(
    apart, back, changing, differ, tmp_path
):
    forces = np.array([0.3, 0.0, 0.2, -0.2, 0.0, 0.1, 0.0, 0.2]) * apart
    made = recordings([at_one_speed(k, forces, back, changing) for k in range(8)], rig())
    search, _ = search_of(ready_of(rig(), tmp_path, made[:6], made[6:]))
    assert may_differ("offset", rig(), search, search.models.fitted((), {})) is differ
