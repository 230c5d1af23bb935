"""A measured trial is replayed as it was played."""

from dataclasses import replace

import numpy as np
import pytest

from spirob.can_protocol import AMPERE_PER_COUNT
from spirob.identify.measurement import Measurement
from spirob.trials import Trial
from spirob.trials.simulation import simulate
from tests.identify.known import TRIALS, spirob


@pytest.fixture(scope="module")
def trace():
    plain = {"name": "played", "role": "train", **TRIALS["validate"][0]}
    return simulate(spirob(), Trial.from_plain(plain), {})


def with_command(trace, values):
    return replace(trace, signals={**trace.signals, "right.command": values})


def test_a_current_that_was_asked_for_is_replayed_as_it_was_sent(trace):
    sent = np.round(trace["right.command"] / AMPERE_PER_COUNT) * AMPERE_PER_COUNT
    found = Measurement.from_trace(with_command(trace, sent)).schedule.reference
    assert np.array_equal(found[:, 1], sent)
    assert not np.array_equal(sent, trace["right.reference"])
    assert np.array_equal(found[:, 0], trace["left.reference"])  # a length, followed by the model


def test_without_a_whole_record_of_commands_the_reference_is_replayed(trace):
    broken = np.where(np.arange(len(trace["right.command"])) < 3, np.nan, trace["right.command"])
    found = Measurement.from_trace(with_command(trace, broken)).schedule.reference
    assert np.array_equal(found[:, 1], trace["right.reference"])
    signals = {k: v for k, v in trace.signals.items() if k != "right.command"}
    again = Measurement.from_trace(replace(trace, signals=signals)).schedule.reference
    assert np.array_equal(again, found)
