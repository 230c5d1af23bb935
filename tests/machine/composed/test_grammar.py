"""What a law may begin from, and which of it is asked."""

from types import SimpleNamespace

import numpy as np
import pytest

from spirob.diagnosis.criteria import Criteria, Worth
from spirob.machine.composed import greedy
from spirob.machine.composed.grammar import SHARE, terms
from spirob.machine.composed.terms import Shape, Term
from spirob.machine.composed.track import Ranges, Track

STEP = 0.01
TIME = STEP * np.arange(3000)
PLACE = np.sin(0.7 * TIME)
SPEED = np.gradient(PLACE, STEP)
SIGNALS = {"place": PLACE, "speed": SPEED, "time": TIME, "load": np.cos(TIME)}
RANGES = Ranges(0.0, 1.0, 0.7, 1.0, 30.0, 0.01, 0.0)
TRACK = Track(SIGNALS, np.array([0, len(TIME)]), np.array([STEP]))


def left(residual, *kinds):
    """Share of the square that the best term of these kinds leaves, where it begins."""
    shares = []
    for term in terms(RANGES, residual, SIGNALS, placed=True):
        if term.kinds == kinds:
            columns = np.column_stack(term.along(TRACK, RANGES))
            found = np.linalg.lstsq(columns, residual, rcond=None)[0]
            shares.append(np.sum((residual - columns @ found) ** 2) / np.sum(residual**2))
    return min(shares)


@pytest.mark.parametrize("centre", [0.0, -1.0])
def test_a_wave_of_a_changing_pitch_is_found_where_no_even_wave_is(centre):
    away = PLACE - centre
    residual = np.cos(9.0 * away * (1.0 + 0.6 * np.abs(away)) + 0.4)
    assert left(residual, "chirp") < 0.2
    assert left(residual, "wave") > 0.4


@pytest.mark.parametrize(
    ("residual", "kinds", "poorer"),
    [
        ((PLACE - 0.9) ** 3, ("cubic about any place",), ("cubic",)),
        (np.where(SPEED > 0, 1, 0) * np.tanh(SPEED / 0.01) * np.exp(-((SPEED / 0.35) ** 2)),
         ("forward fading",), ("fading",)),
        (np.tanh(SPEED / 0.01) * (1.0 + 0.8 * np.sin(2 * np.pi * TIME / 24.0)),
         ("way", "swell"), ("way", "tide")),
    ],
)  # fmt: skip
def test_one_term_holds_what_comes_from_one_cause(residual, kinds, poorer):
    assert left(residual, *kinds) < 1e-6 < 1e-2 < left(residual, *poorer)


def test_what_rings_after_each_turn_is_found_by_its_period():
    turns = np.flatnonzero(np.diff(np.sign(SPEED))) + 1
    since = TIME - TIME[turns[np.searchsorted(turns, np.arange(len(TIME)), "right") - 1]]
    rings = np.sign(SPEED) * np.exp(-since / 0.5) * np.sin(2 * np.pi * since / 0.31)
    rings[: turns[0]] = 0.0
    assert left(rings, "ringing") < 0.2
    assert left(rings, "slow direction") > 0.9


def test_what_a_gear_loses_is_of_load_and_friction_together():
    load, line = SIGNALS["load"], SPEED / RANGES.fast
    lost = np.tanh(SPEED / RANGES.rest_speed) * np.abs(load / RANGES.heavy + SHARE * line)
    assert left(lost, "way", "passed") < 1e-6 < 1e-3 < left(lost, "weight", "way")


def judged(size, heldout):
    errors = np.full(20, size)
    return SimpleNamespace(errors=errors, mean_square=size, heldout_square=heldout, richness=1)


def test_where_held_out_trials_deny_the_best_the_next_are_asked(monkeypatch):
    kinds = [Term((Shape(f"{k}", "place", ("1.0",)),)) for k in range(greedy.FINALISTS + 2)]
    beyond = greedy.FINALISTS  # the first that holds beyond the motion of the fit

    def made(found):
        k = kinds.index(found[-1])
        return judged(0.1 + 0.01 * k, 0.1 if k >= beyond else 2.0)

    ground = SimpleNamespace(worth=Worth(Criteria(), 0.01))
    drafts = SimpleNamespace(ground=ground, made=made, balanced=lambda draft: True)
    offers = SimpleNamespace(terms=kinds, errors=lambda beside: 0.1 + 0.01 * np.arange(len(kinds)))
    monkeypatch.setattr(greedy, "_refined", lambda drafts, beside, term: term)
    nothing = judged(1.0, 1.0)
    nothing.terms = ()
    assert greedy._best(drafts, offers, nothing).mean_square == pytest.approx(0.1 + 0.01 * beyond)
