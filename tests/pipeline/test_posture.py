"""Watching the emulated robot changes nothing, and tells how it is bent."""

import numpy as np
import pandas as pd

from pipeline.robots import EVERY, POSTURE, WatchedRobot
from spirob.can_protocol import encode_command
from spirob.emulator import EmulatedRig, EmulatedRobot, HiddenSettings
from spirob.robot import Scene

CYCLES = 400
PULL_LEFT = encode_command((1.0, 0.0))


def played(robot):
    robot.prepare(Scene())
    frames = [frame for _ in range(CYCLES) for frame in robot.exchange(PULL_LEFT)]
    return [(frame.stamp_ns, frame.arbitration_id, frame.data) for frame in frames]


def test_the_frames_are_the_same_and_the_left_tendon_bends_to_the_left(tmp_path):
    plain = EmulatedRobot(EmulatedRig(), HiddenSettings(), seed=3)
    alone = played(plain)
    plain.close()
    inner = EmulatedRobot(EmulatedRig(), HiddenSettings(), seed=3)
    watched = WatchedRobot(inner)
    assert played(watched) == alone
    watched.write(tmp_path, "pull")
    watched.close()
    table = pd.read_parquet(tmp_path / POSTURE / "pull.parquet")
    assert np.allclose(np.diff(table["time"]), EVERY * 1e-3)
    assert len(table) == -(-CYCLES // EVERY)
    hinges = table.filter(regex=r"^q\d+$")
    assert np.abs(hinges.iloc[0]).max() < 0.05  # at rest
    assert hinges.iloc[-1].sum() > 0.2
