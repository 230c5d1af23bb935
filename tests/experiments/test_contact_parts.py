"""Parts of made-up contacts: each is counted once, and where it belongs."""

import numpy as np
import pytest

from pipeline.contacts import judged
from spirob.experiments import Side
from spirob.experiments.contact_rates import (
    GAPS,
    MOTIONS,
    PLACES,
    SIGNALS,
    by_gap,
    by_motion,
    by_place,
    in_parts,
    uncurlings,
)
from spirob.perceive.contact import ContactSettings
from tests.experiments.test_contact_rates import outcome

RULES = ContactSettings()


@pytest.mark.parametrize(
    ("cut", "name", "span"), [(by_place, "place", PLACES), (by_gap, "gap", GAPS)]
)
def test_contacts_are_counted_once_in_the_part_where_they_are(cut, name, span):
    low, high = span
    values = np.linspace(low, high - 1e-6, 20)
    # those of the upper half are never told
    found = [outcome(2.0, 10.0 if v < (low + high) / 2 else 0.0, **{name: v}) for v in values]
    parts = cut([*found, outcome(np.nan, place=None)], RULES)
    assert sum(p["contacts"] for p in parts) == 20
    assert [p[name] for p in parts] == pytest.approx(low + (high - low) * np.arange(0.1, 1, 0.2))
    assert [p["ever"] for p in parts] == [1.0, 1.0, 0.5, 0.0, 0.0]


def test_a_motion_has_its_contacts_and_its_free_twins():
    slow = [outcome(2.0, motion=0), outcome(np.nan, place=None, motion=0)]
    fast = [outcome(np.nan, bump=0.5, place=None, motion=4)]
    parts = by_motion(slow + fast, RULES)
    assert [(p["speed"], p["load"]) for p in parts] == list(MOTIONS)
    assert [p["contacts"] for p in parts] == [1, 0, 0, 0, 0]
    assert parts[0]["minutes"] == pytest.approx((2 + 4) / 60)
    assert parts[0]["alarms"] == 0.0 < parts[4]["alarms"]


def test_parts_hold_together_what_is_told_of_all():
    found = [
        outcome(2.0 + 0.1 * k, place=p, motion=k) for k, p in enumerate((0.5, 0.6, 0.7, 0.8, 0.9))
    ]
    told = in_parts(found, RULES)
    for parts in (told["by_place"], told["by_gap"], told["by_motion"]):
        assert sum(p["contacts"] for p in parts) == told["contacts"] == 5
        assert sum(p["minutes"] for p in parts) == pytest.approx(told["minutes"])


def test_tuned_thresholds_are_told_in_the_same_parts_as_the_papers():
    drawn = uncurlings(1, seed=0)
    last = max(t.about.window()[1] for t in drawn)
    sides = []
    for trial in drawn:
        current = np.full((last, 2), 0.6)
        if trial.place is not None:  # 2 A/s: lower thresholds hear it sooner
            current += (
                np.maximum(np.arange(last)[:, None] - trial.about.window()[0] - 1000, 0) * 2e-3
            )
        sides.append(Side(current, current, current, current))
    told = judged(dict.fromkeys(("simulation", "robot"), (drawn, sides)))
    for signal in SIGNALS:
        scale, robot = told[signal]["tuned_scale"], told[signal]["robot"]
        assert scale < 1.0
        assert robot["tuned"].keys() == robot["paper"].keys() >= {"by_place", "by_gap", "by_motion"}
        for part in ("by_place", "by_gap", "by_motion"):
            pairs = zip(robot["tuned"][part], robot["paper"][part], strict=True)
            sooner = [(t["delay"][0], p["delay"][0]) for t, p in pairs if t["contacts"]]
            assert sooner
            assert all(t < p for t, p in sooner)
