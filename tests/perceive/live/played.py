"""A trial played on the emulated robot: the frames on its bus, and what its log tells."""

import pandas as pd

from spirob.can.drive import find_drive
from spirob.can_protocol import CanFrame
from spirob.emulator import EmulatedRobot
from spirob.emulator.rig import EmulatedRig
from spirob.experiments.host_contact import HostContact
from spirob.experiments.host_loop import GainSet
from spirob.logs import read_log
from spirob.logs.messages import unpack_frames
from spirob.logs.reader import RAW_TOPIC, read_content
from spirob.perceive.features import extract
from spirob.plant import Rig
from spirob.trials import Trial, record
from spirob.trials.play import HostCurrentLoop


def pushed(folder):
    """Frames, as its drives send them, of an arm without gear that is hit at 0.95 of its length."""
    about = HostContact(hit=0.9, duration=1.6)
    rig = Rig.from_mapping(GainSet(5.0, 0.0, 1e-3).rig())
    robot = EmulatedRobot(EmulatedRig(gear_ratio=1.0, by_voltage=True), seed=2)
    path = record(
        Trial.from_plain(about.trial_at("push", 0.95)),
        robot,
        folder / "push.mcap",
        rig,
        drive=find_drive("gm6020"),
        loop=HostCurrentLoop.of(rig, 24.0),
    )
    robot.close()
    return frames_of(path)


def frames_of(path):
    """All frames of a log in their order."""
    raw, _ = unpack_frames(read_content(path, False, (RAW_TOPIC,)).messages[RAW_TOPIC])
    return [CanFrame(int(r["stamp_ns"]), int(r["id"]), r["data"].tobytes()) for r in raw]


def frames_and_features(plain, folder, features=True):
    """All frames of the bus in their order, and the features of the wrap as a table of one row."""
    trial, robot = Trial.from_plain(plain), EmulatedRobot(seed=2)
    path = record(
        trial,
        robot,
        folder / f"{trial.name}.mcap",
        Rig(),
    )
    robot.close()
    frames = frames_of(path)
    known = pd.DataFrame([extract(read_log(path))], index=["wrap"]) if features else None
    return frames, known
