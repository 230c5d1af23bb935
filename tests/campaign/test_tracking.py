"""Feed-forward in the simulated axes: the truth tracks, and the shares are counted right."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.campaign.case import Case, made_of, stream
from spirob.campaign.simulators import SIMULATORS
from spirob.campaign.simulators.motion import FINE, plan
from spirob.campaign.tracking import _error, _truth, summary


def test_a_controller_that_knows_the_truth_hardly_misses():
    case = Case("rigid", "coulomb_friction", 4242)
    made = made_of(case, stream(case))
    machine = made.machine
    fast = plan("tones", np.random.default_rng(0), 3.0, machine.stroke, machine.fastest)
    alone = _error(machine, made.hidden, fast, np.zeros(len(fast.wanted)))
    assert _error(machine, made.hidden, fast, _truth(machine, made.hidden, fast)) < 0.05 * alone


def test_no_feed_forward_is_the_axis_as_it_was():
    case = Case("rigid", "none", 1)
    made = made_of(case, stream(case))
    play = SIMULATORS["rigid"].play
    plain = replace(made.plans[0], wanted=made.plans[0].wanted[: round(FINE)])
    nothing = replace(plain, ahead=np.zeros(len(plain.wanted)))
    assert np.array_equal(
        play(made.machine, made.hidden, plain).q, play(made.machine, made.hidden, nothing).q
    )


def test_shares_are_of_what_can_be_gained():
    def row(verdict, none, fitted, model, truth, way=0):
        errors = {"none": none, "fitted": fitted, "model": model, "truth": truth}
        return {"verdict": verdict, "errors": errors, "way": way}

    found = summary(
        [
            row("named", 10.0, 5.0, 1.0, 0.0),
            row("named", 10.0, 1.0, 2.0, 0.0),
            row("unknown", 10.0, 4.0, 4.0, 0.0),
            row("unknown", 10.0, 11.0, 11.0, 0.0),
            row("named", 10.0, 5.0, 16.0, 0.0, way=1),
            {"refused": "no log"},
        ]
    )
    assert found["gain"]["quartiles"][1] == pytest.approx(0.85)
    assert found["gain"]["at_least_0.9"] == 1
    assert found["own"]["quartiles"][1] == pytest.approx(-0.1)
    assert found["one_way"]["least"] == pytest.approx(-0.6)
    assert (found["named"], found["named_worse_than_fitted"]) == (2, 1)
    assert (found["not_named"], found["not_named_worse_than_none"], found["refused"]) == (2, 1, 1)
