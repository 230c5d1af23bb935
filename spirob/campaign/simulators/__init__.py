"""Simulators of single axes, of different structure; none shares an equation with the library.

They meet the diagnosis only in the logs that they write.

motion.py  what one is asked to play and gives back;  hidden.py  what can be hidden in it
rigid.py   a rigid axis under a controller;  two_mass.py  a motor, a spring, its load
arm.py     a joint of an arm whose other joint disturbs it;  bench.py  an imposed motion
"""

from spirob.campaign.simulators.arm import ARM
from spirob.campaign.simulators.bench import BENCH
from spirob.campaign.simulators.motion import Simulator
from spirob.campaign.simulators.rigid import RIGID
from spirob.campaign.simulators.two_mass import TWO_MASS

SIMULATORS: dict[str, Simulator] = {s.name: s for s in (RIGID, TWO_MASS, ARM, BENCH)}

__all__ = ["SIMULATORS", "Simulator"]
