"""Simulators of single axes, of different structure; none shares an equation with the library.

They meet the diagnosis only in the logs that they write.
"""

from spirob.campaign.simulators.arm import ARM
from spirob.campaign.simulators.bench import BENCH
from spirob.campaign.simulators.motion import Simulator
from spirob.campaign.simulators.rigid import RIGID
from spirob.campaign.simulators.two_mass import TWO_MASS

SIMULATORS: dict[str, Simulator] = {s.name: s for s in (RIGID, TWO_MASS, ARM, BENCH)}

__all__ = ["SIMULATORS", "Simulator"]
