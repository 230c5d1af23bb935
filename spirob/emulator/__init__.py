"""Pretend hardware behind a CAN bus: the default robot, with physics of its own.

It answers command frames with feedback frames and shares with the model only the published
geometry and the CAN protocol: 48 hinges instead of 24, its own integrator, its own contact, its
own tendon routing, and a hidden effect that the model does not know.  A model that is tested on
data from its own equations proves nothing.

    rig.py      what a user may know and choose: ratio, winch, size, gravity, noise; how this one
                machine differs from its data sheet, drawn from a seed
    build.py    how it is built: scatter and other choices of design, drawn from the seed
    faults/     what goes wrong on the bus, one file each
    hidden/     effects that nobody told the model about, one file each
    physics/    the compiled step
    machine.py  the machine without a bus: state, trials, cycles
    robot.py    the robot: both sides of the bus, one cycle at a time
"""

from spirob.emulator.rig import EmulatedRig, HiddenSettings
from spirob.emulator.robot import EmulatedRobot

__all__ = ["EmulatedRig", "EmulatedRobot", "HiddenSettings"]
