"""One battery over all hidden effects."""

import numpy as np
import pytest

from spirob.emulator import hidden
from tests.emulator.conftest import play

EFFECTS = [name for name in hidden.effects() if name != "none"]


def motion(made, cycles=1500):
    """Currents [A] and tendon wound in [m] while curling and settling in the end stop."""
    rows = []
    for _ in range(cycles):
        made.cycle((1.2, 0.1))
        rows.append([*made.state["current"][0], *made.state["wound"][0]])
    return np.array(rows)


@pytest.mark.parametrize("effect", EFFECTS)
def test_effect_vanishes_at_strength_zero(machine, effect):
    plain = machine("none")
    if effect == "rotor_friction":
        plain.numbers["coulomb"] = plain.drawn["coulomb"]
        plain.numbers["breakaway"] = 0.3 * plain.drawn["coulomb"]
    gone = machine(effect, strength=0.0)
    play(plain, (0.5, 0.1), 700)
    play(gone, (0.5, 0.1), 700)
    np.testing.assert_allclose(gone.state["wound"], plain.state["wound"], rtol=5e-3, atol=1e-7)


@pytest.mark.parametrize("effect", EFFECTS)
def test_typical_effect_is_seen_and_twice_as_strong_is_seen_more(machine, effect):
    plain = motion(machine("none"))
    visible = np.array([2e-3, 2e-3, 2e-5, 2e-5])  # 2 mA; 20 µm, ten times the encoder's count
    once, twice = (
        np.abs((motion(machine(effect, strength=s)) - plain) / visible).mean(axis=0).max()
        for s in (1.0, 2.0)
    )
    assert once > 1.0
    assert twice > once


@pytest.mark.parametrize("effect", EFFECTS)
def test_details_come_from_the_seed(machine, effect):
    first, again, other = (machine(effect, seed=s).hidden[0].numbers for s in (3, 3, 4))
    assert all(np.array_equal(first[name], again[name]) for name in first)
    assert any(not np.array_equal(first[name], other[name]) for name in first)
