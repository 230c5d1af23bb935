"""Feed-forward on an emulated arm: the robot's own current is the best that it can be given."""

import numpy as np

from spirob.campaign.arm import tracking
from spirob.emulator.machine import Machine
from spirob.emulator.rig import EmulatedRig, HiddenSettings
from spirob.export.arm import CorrectedArm
from spirob.plant import Rig


def test_a_model_tracks_better_than_none_and_worse_than_the_robot_itself(monkeypatch):
    monkeypatch.setattr(tracking, "SECONDS", 1.2)
    robot = Machine(EmulatedRig(), HiddenSettings("none"), 5)
    wanted = tracking._motion()
    assert np.allclose(wanted[0, :2], 0.0, atol=1e-4)
    model = CorrectedArm("spirob", "named", "", Rig(), (), {}, {}, None, ())
    own, off = tracking._played(robot, wanted, np.zeros(len(wanted)), tracking.STIFF)

    def error(ahead):
        return np.std(tracking._played(robot, wanted, ahead, 1.0)[1][400:])

    none, ours = error(np.zeros(len(wanted))), error(tracking._ahead(model, wanted))
    assert np.std(off[400:]) < 0.2 * none
    assert error(own) < ours < none
