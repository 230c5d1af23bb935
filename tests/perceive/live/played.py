"""A trial played on the emulated robot: the frames on its bus, and what its log tells."""

import pandas as pd

from spirob.bench import Trial, record
from spirob.can_protocol import CanFrame
from spirob.control.law import Gains
from spirob.emulator import EmulatedRobot
from spirob.logs import Transmission, read_log
from spirob.logs.messages import unpack_frames
from spirob.logs.reader import RAW_TOPIC, read_content
from spirob.perceive.features import extract


def frames_and_features(plain, folder, features=True):
    """All frames of the bus in their order, and the features of the wrap as a table of one row."""
    trial, robot = Trial.from_plain(plain), EmulatedRobot(seed=2)
    path = record(
        trial,
        robot,
        folder / f"{trial.name}.mcap",
        transmission=Transmission(),
        gains=Gains(),
        rig="spirob",
    )
    robot.close()
    raw, _ = unpack_frames(read_content(path, False, (RAW_TOPIC,)).messages[RAW_TOPIC])
    frames = [CanFrame(int(r["stamp_ns"]), int(r["id"]), r["data"].tobytes()) for r in raw]
    known = pd.DataFrame([extract(read_log(path))], index=["wrap"]) if features else None
    return frames, known
