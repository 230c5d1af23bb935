"""The unified multi-dynamics model: motor electrics, motor and winch, and the MuJoCo arm.

What a machine is:
    rig.py        nominal numbers of its parts with bounds and source, gains of its controller
    plant.py      the model as a whole, `simulate`; beside it the baseline, `single_dynamics`
    session.py    a plant in motion, and where its arm hangs before a trial
The compiled cycle:
    loop.py       the cycle as a template;  steps.py  its three steps j_a, j_b, j_c
    records.py    what it is told, what it remembers, what it answers
    assemble.py   fills effects into the templates' ports and compiles
The equations that it calls:
    motor.py      electrics, and motor and winch at a one-sided tendon
    tendon.py     a tendon at one hinge, in closed form
    body.py       the arm as a MuJoCo chain of hinges, and what it may touch
    chain.py      the arm that touches nothing, in MuJoCo's own step; its outline that may touch
And check.py, what only the whole model can show of an effect.
"""

import mujoco

from spirob.plant.plant import Plant
from spirob.plant.records import Frames, Response
from spirob.plant.rig import Rig
from spirob.plant.session import Session

__all__ = ["Frames", "Plant", "Response", "Rig", "Session"]

_log = mujoco.MjLogConfig.get()
_log.logto_file = False  # no MUJOCO_LOG.TXT where the program was started; the console still hears
_log.set()
