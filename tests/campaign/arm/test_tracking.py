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
    wanted, taut = tracking._motion(1.0), tracking.TAUT
    assert np.allclose(wanted[0, :2], 0.0, atol=1e-4)
    model = CorrectedArm("spirob", "named", "", Rig(), (), {}, {}, None, ())
    stiff = tracking._played(robot, wanted, np.zeros(len(wanted)), tracking.STIFF, taut)

    def error(ahead):
        return np.std(tracking._played(robot, wanted, ahead, 1.0, taut).missed[400:])

    none, ours = error(np.zeros(len(wanted))), error(tracking._ahead(model, wanted, taut))
    assert np.std(stiff.missed[400:]) < 0.2 * none
    assert error(stiff.current) < ours < none
    assert stiff.tension[400:].min() > tracking.SLACK


def test_a_motion_that_is_too_fast_is_told_by_its_slack():
    robot, wanted = Machine(EmulatedRig(), HiddenSettings("none"), 5), tracking._motion(2.0)[:1200]
    stiff = tracking._played(robot, wanted, np.zeros(len(wanted)), tracking.STIFF, 0.3)
    assert np.mean(stiff.tension < tracking.SLACK) > 0.2
