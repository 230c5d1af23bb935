"""A stuck sensor under a constant command is noticed where noise was seen, and nowhere else."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spirob.can.guard import GuardedRobot
from spirob.can.limits import Limits, Stopped
from spirob.can_protocol import AMPERE_PER_COUNT, encode_command
from spirob.robot import CYCLE_NS, Scene
from tests.can.test_guard import feedback
from tests.trials.fake_robot import FakeRobot

WIDE = {"travel": 10.0, "speed": 100.0, "following": 40.0, "slew": 1e6}


class Drive(FakeRobot):
    """The right drive's current reading: its command, an offset and noise, every few frames anew.

    noise  counts at rest;  growing  counts an ampere;  every  frames from one reading to the next
    turns  angle [counts] by frame;  stuck  frame from which its feedback stays the same
    """

    def __init__(self, noise, growing=0.0, every=1, offset=0.0, turns=None, stuck=None, seed=0):
        super().__init__()
        self.rng = np.random.default_rng(seed)
        self.about = noise, growing, every, offset
        self.turns = turns or (lambda k: 100)
        self.stuck, self.frame, self.data = stuck, None, None

    def exchange(self, command):
        k = len(self.commands)
        frames = super().exchange(command)
        noise, growing, every, offset = self.about
        amperes = self.commands[-1][1]
        if self.frame is None or (k % every == 0 and not self._is_stuck(k)):
            spread = noise + growing * abs(amperes)
            exact = amperes / AMPERE_PER_COUNT + offset
            self.data = round(exact + spread * self.rng.standard_normal())
        if self.frame is None or not self._is_stuck(k):
            stamp = frames[0].stamp_ns + CYCLE_NS
            self.frame = feedback(1, stamp, int(self.turns(k)), 0, self.data)
        stamp = frames[0].stamp_ns + CYCLE_NS
        return [*frames[:2], type(self.frame)(stamp, self.frame.arbitration_id, self.frame.data)]

    def _is_stuck(self, k):
        return self.stuck is not None and k >= self.stuck


def played(drive, amperes, **limits):
    """Frames until the stop and its sentence; (number of commands, None) without one."""
    guard = GuardedRobot(drive, Limits(**WIDE, **limits), 8e-7, 1.1e-4)
    guard.prepare(Scene())
    guard.arm()
    for k, value in enumerate(amperes):
        try:
            guard.exchange(encode_command((0.2, value)))
        except Stopped as stopped:
            return k, str(stopped)
    return len(amperes), None


COMMANDS = st.lists(
    st.tuples(st.floats(-5.0, 5.0), st.integers(30, 400)), min_size=1, max_size=6
).map(lambda pieces: [value for value, frames in pieces for _ in range(frames)])


@settings(max_examples=40, deadline=None)
@given(
    noise=st.one_of(st.just(0.0), st.floats(0.0, 12.0)),
    growing=st.floats(0.0, 2.0),
    every=st.integers(1, 10),
    offset=st.floats(-0.5, 0.5),
    amperes=COMMANDS,
    moving=st.integers(0, 600),
    seed=st.integers(0, 2**32 - 1),
)
def test_a_living_drive_is_never_accused(noise, growing, every, offset, amperes, moving, seed):
    def turns(k):
        return 100 + 3 * min(k, moving)  # it turns for a while, then it stands

    drive = Drive(noise, growing, every, offset, turns, seed=seed)
    _, said = played(drive, amperes)
    # whatever else there may be to say of a drive whose angle and speed tell two stories
    assert said is None or "flickers" not in said


@settings(max_examples=20, deadline=None)
@given(
    noise=st.floats(1.6, 12.0),
    every=st.integers(1, 4),
    offset=st.floats(-0.5, 0.5),
    amperes=st.floats(0.06, 5.0),
    stuck=st.integers(300, 700),
    seed=st.integers(0, 2**32 - 1),
)
def test_one_that_sticks_after_it_has_shown_noise_is_named(
    noise, every, offset, amperes, stuck, seed
):
    frames, said = played(Drive(noise, 0.0, every, offset, None, stuck, seed), [amperes] * 3000)
    assert said.startswith("motor right: the same feedback for")
    assert "from a drive whose reading flickers" in said
    assert stuck + 45 <= frames <= stuck + 60 + 20 * 20 * every


def test_with_typical_noise_it_takes_fifty_milliseconds():
    taken = [played(Drive(4.0, stuck=400, seed=s), [0.2] * 900)[0] - 400 for s in range(8)]
    assert min(taken) >= 45
    assert np.median(taken) <= 90


@pytest.mark.parametrize(
    ("drive", "amperes"),
    [
        (Drive(0.0, stuck=400), 0.5),  # no noise was ever seen
        (Drive(0.4, stuck=400, offset=0.5), 0.5),  # rounding alone, which another level hides
        (Drive(4.0, stuck=400), 0.0),  # no current flows
        (Drive(4.0, stuck=10), 0.5),  # it was stuck before it showed any
    ],
)
def test_without_evidence_nobody_is_accused(drive, amperes):
    assert played(drive, [amperes] * 2500) == (2500, None)


def test_noise_seen_at_a_large_current_says_nothing_of_a_small_one():
    drive = Drive(0.0, growing=4.0)
    assert played(drive, [2.0] * 400 + [0.06] * 1500)[1] is None
