"""MuJoCo's warnings are heard, and leave no file in the folder where the program was started."""

import ctypes

import mujoco
import numpy as np

from spirob.geometry import spiral_arm
from spirob.plant import Plant, Rig
from spirob.plant.body import build_spec
from spirob.plant.rig import Arm
from spirob.robot import Scene


def test_a_warning_of_mujoco_leaves_no_file(tmp_path, monkeypatch, capfd):
    Plant(Rig())
    monkeypatch.chdir(tmp_path)
    model = build_spec(Arm(), Scene(), spiral_arm(24), 1e-3, tendons=True).compile()
    data = mujoco.MjData(model)
    data.qvel[0] = np.inf
    mujoco.mj_step(model, data)
    ctypes.CDLL(None).fflush(None)  # C's own buffers, where the console is no terminal
    assert "unstable" in "".join(capfd.readouterr())
    assert list(tmp_path.iterdir()) == []
