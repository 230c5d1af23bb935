"""A composed law is an effect like any other: its file does what was composed, and is sound."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.effects import all_effects, load_file
from spirob.effects.check import check
from spirob.effects.replay import run
from spirob.machine.composed.draft import Draft
from spirob.machine.composed.grammar import bristled, losses, terms
from spirob.machine.composed.law import law_of
from spirob.machine.composed.track import Ranges, Track, along
from spirob.machine.composed.writing import formula, told, written
from spirob.machine.inverse.scaling import Sizes

STEP, SAMPLES = 0.01, 300
SIZES = Sizes(0.5, 1.0, 1.0, 3.0, 0.5, 0.1, "N·m", "A", "rad")
RIVAL = all_effects()["coulomb_friction"]


def track():
    t = STEP * np.arange(SAMPLES)
    place = 0.4 + 1.2 * np.sin(2.1 * t) + 0.3 * np.sin(5.3 * t)
    signals = {"place": place, "speed": np.gradient(place, STEP), "time": t}
    signals["load"] = 0.5 * np.cos(3.0 * t)
    signals["current"] = 0.8 * np.cos(3.0 * t + 0.4)
    return Track(signals, np.array([0, SAMPLES]), np.array([STEP]))


def ranges(turn):
    return Ranges(0.4, 1.5, 4.0, 0.5, STEP * SAMPLES, 0.04, turn, strong=0.8)


def by_kind():
    """One term of each kind of the grammar, of an axis that comes round and of one that slides."""
    found = {}
    for turn in (0.0, 2.0):
        residual = np.random.default_rng(0).normal(size=SAMPLES)
        about = ranges(turn), residual, track().signals, True
        for term in (*terms(*about), *losses(*about)):
            for one in (term, *bristled(term, ranges(turn))):
                name = " × ".join(one.kinds) + (
                    " turned" if one.memory and "p" in one.numbers else ""
                )
                found.setdefault(name, (one, turn))
    return found


TERMS = by_kind()
SINGLE = [name for name in TERMS if "×" not in name]
PRODUCTS = ["way × spot", "line × wave", "share × curve k6", "way × tide", "weight × settling"]
LOSSES = [name for name in TERMS if name.startswith("drive × ")]
PRODUCTS += [*LOSSES, "bristle × spot", "bristle × weight", "slow heat × given", "given × wave"]


def law(*names):
    """The law of these terms, with factors that were drawn."""
    rng = np.random.default_rng(1)
    chosen = [TERMS[name][0] for name in names]
    factors = [rng.uniform(0.2, 0.6, len(term.parts)) for term in chosen]
    empty = np.zeros(1)
    draft = Draft(tuple(chosen), tuple(factors), empty, empty, empty, empty)
    return draft, law_of(draft, ranges(TERMS[names[0]][1]), 0.5)


def effect(found, folder):
    path = folder / "law.py"
    path.write_text(written(found, told(found, SIZES), RIVAL), encoding="utf-8")
    return load_file(path)["law"]


@pytest.mark.parametrize("names", [(name,) for name in TERMS] + [("way", "even power", "spot")])
def test_the_file_does_what_was_composed(names, tmp_path):
    draft, found = law(*names)
    made, motion = effect(found, tmp_path), track()
    inputs = {**motion.signals, "rest_speed": np.full(SAMPLES, found.ranges.rest_speed)}
    numbers = {field: about.nominal for field, about in made.parameters().items()}
    upstream = inputs["upstream"] = motion.signals["current"]  # an ampere makes 1 N·m
    given = {a: inputs[a] for a in made.arguments() if a in inputs}
    got, _ = run(made, numbers, given, STEP)
    if found.of_drive:
        got = got - upstream
    parts = [
        factor * values
        for term, factors in zip(draft.terms, draft.factors, strict=True)
        for factor, values in zip(factors, term.along(motion, found.ranges), strict=True)
    ]
    assert np.broadcast_to(got, SAMPLES) == pytest.approx(-np.sum(parts, axis=0), abs=1e-9)


@pytest.mark.parametrize("names", [(n,) for n in SINGLE + PRODUCTS] + [("way", "spot")])
def test_the_file_keeps_every_law_of_an_effect(names, tmp_path):
    made = effect(law(*names)[1], tmp_path)
    assert check(made) == []


@pytest.mark.parametrize(
    ("names", "brakes"),
    [
        (("way",), True),
        (("way × spot",), True),
        (("way", "drag"), True),
        (("bristle",), True),
        (("bristle × spot",), False),
        (("power turned",), False),
        (("steady",), False),
        (("way", "spot"), False),
        (("way × wave",), False),
        (("share",), False),
    ],
)
def test_what_may_drive_the_motion_is_called_no_friction(names, brakes):
    _, found = law(*names)
    assert found.brakes == brakes
    assert told(found, SIZES).startswith("friction" if brakes else "effort")


def test_a_friction_that_would_drive_is_none():
    draft, _ = law("way")
    turned = replace(draft, factors=(-draft.factors[0],))
    assert not law_of(turned, ranges(0.0), 0.5).brakes


@pytest.mark.parametrize(
    ("sizes", "mean", "brakes"), [([0.5, 0.3], 0.4, True), ([0.5, -0.1], 0.2, False)]
)
def test_a_size_in_each_motor_is_their_mean_and_brakes_where_both_do(sizes, mean, brakes):
    draft, _ = law("way")
    found = law_of(replace(draft, factors=(np.array(sizes),)), ranges(0.0), 0.5)
    assert found.parts[0].amplitude == pytest.approx(mean)
    assert found.brakes is brakes


def test_a_law_reads_as_a_formula():
    _, found = law("way × spot")
    assert formula(found, SIZES).startswith("τ = -(0.40")
    assert "tanh(v/v_0)·exp(-½((x - " in formula(found, SIZES)
    assert "in a spot at" in told(found, SIZES)


def test_memories_follow_their_closed_forms():
    speed, ends, step = np.full(500, 0.2), np.array([0, 500]), np.array([0.01])
    path = 0.2 * 0.01 * np.arange(1, 501)
    bristle = along("bristle", speed, [0.1], ends, step)[0]
    assert bristle == pytest.approx(1.0 - np.exp(-path / 0.1))
    spring = along("spring", speed, [0.1], ends, step)[0]
    assert spring == pytest.approx(np.tanh(path / 0.1))
    slow = along("slow", np.ones(500), [0.5], ends, step)[0]
    assert slow == pytest.approx(1.0 - np.exp(-0.01 * np.arange(1, 501) / 0.5))


@pytest.mark.parametrize("kind", ["bristle", "spring", "slow"])
def test_a_memory_does_not_care_for_the_step(kind):
    speed = np.repeat(np.random.default_rng(2).normal(size=60), 4)
    whole = along(kind, speed[::4], [0.3], np.array([0, 60]), np.array([0.08]))
    fine = along(kind, speed, [0.3], np.array([0, 240]), np.array([0.02]))
    assert whole == pytest.approx(fine[:, 3::4])
    assert np.max(np.abs(whole)) <= max(1.0, np.max(np.abs(speed)))


def test_memory_begins_anew_with_each_piece():
    speed = np.concatenate([np.ones(50), np.ones(50)])
    found = along("bristle", speed, [0.3], np.array([0, 50, 100]), np.array([0.01, 0.01]))[0]
    assert np.array_equal(found[:50], found[50:])


def test_the_time_since_a_turn_begins_where_the_motion_turns_not_where_it_stands():
    speed = np.array([0.5, 3.0, 0.5, -0.5, 0.5, 3.0, -3.0, -0.5, -3.0])  # within 1 it stands
    since, side = along("turn", speed, (), np.array([0, 9]), np.array([0.1]))
    assert np.array_equal(side, [0, 1, 1, 1, 1, 1, -1, -1, -1])
    assert since[:6].min() > 999.0  # it never turned
    assert since[6:] == pytest.approx([0.0, 0.1, 0.2])
