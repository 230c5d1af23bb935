"""What a residual depends on is said where it comes again in another trial, and how late it is."""

import numpy as np
import pytest
from scipy import signal

from spirob.diagnosis.atlas import lateness
from spirob.diagnosis.document import described
from spirob.diagnosis.flexible import TOGETHER, dependence, told
from spirob.diagnosis.spectrum import Order
from spirob.diagnosis.verdict import Verdict
from tests.diagnosis.stretches import SECONDS, pair, problem, stretch

PIECES = pair()
PROBLEM = problem(*PIECES)


def along(of):
    return np.concatenate([of(p) for p in PIECES])


def test_an_error_that_follows_the_direction_depends_on_the_speed():
    alone = dependence(PROBLEM, along(lambda p: np.tanh(p.velocity / p.still)))
    assert alone["speed"] > 0.9
    assert max(alone, key=alone.get) in ("speed", TOGETHER)
    assert told(alone).startswith("The residual depends on speed (")


def test_an_error_of_load_and_direction_needs_both():
    alone = dependence(PROBLEM, along(lambda p: np.sign(p.velocity) * (p.effort - 0.4)))
    assert alone[TOGETHER] > 0.8
    assert alone["load"] < 0.3


def test_swings_that_do_not_come_again_depend_on_nothing():
    colour = signal.butter(2, 1.0, fs=100.0, output="sos")
    noise = np.random.default_rng(1).standard_normal(4 * len(SECONDS))
    alone = dependence(PROBLEM, signal.sosfiltfilt(colour, noise))
    assert max(alone.values()) < 0.05
    assert told(alone).startswith("The residual follows none of position, speed, acceleration")


def test_where_little_comes_again_no_signal_is_said_to_matter():
    said = told({"speed": 0.01, "time": 0.08, TOGETHER: 0.02})
    assert said == "Little of the residual comes again in another trial (8% of it)."


def test_of_one_trial_half_second_blocks_are_left_out():
    piece = stretch()
    assert dependence(problem(piece), 2.0 * piece.effort)["load"] > 0.9


def test_the_strongest_wave_is_told():
    alone = {"speed": 0.4, "load": 0.1, TOGETHER: 0.5}
    said = told(alone, [Order("motor", 2.0, 0.1), Order("output", 3.0, 0.3)])
    assert said == (
        "The residual depends on speed (40% by itself); "
        "30% is a wave of 3 periods a turn of the gear's output."
    )


@pytest.mark.parametrize("delay", [0.002, -0.001])
def test_a_late_measurement_is_all_delay(delay):
    effort = PIECES[0].effort
    early = np.interp(SECONDS + delay, SECONDS, effort)
    found = lateness([PIECES[0]], early - effort)
    assert found["delay_ms"] == pytest.approx(1e3 * delay, rel=0.05)
    assert found["delay_share"] > 0.95
    assert found["command_share"] is None


def test_an_error_in_step_with_the_command_is_the_commands():
    rate = np.sin(3.0 * SECONDS)
    assert lateness([stretch(command_rate=rate)], 0.1 * rate)["command_share"] == pytest.approx(1.0)


def test_only_an_unknown_effect_is_described_by_what_the_residual_depends_on():
    where = {"depends": {"sentence": "The residual depends on speed (40% by itself)."}}
    unknown, named = (Verdict(kind, {}, "", "Much is left.", "") for kind in ("unknown", "named"))
    assert described(unknown, where).endswith("speed (40% by itself).")
    assert described(named, where) == "Much is left."
    assert described(unknown, {}) == "Much is left."
