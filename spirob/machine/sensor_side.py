"""Does the position sensor sit at the load?  Asked where a description leaves it open.

A sensor at the motor and one at the load, behind an elastic gear or one with play, see different
motions.  What is left of the model chosen for the one may be what the laws of the other take.
"""

from spirob.machine.laws import LOAD_SIDE, for_axis
from spirob.machine.models import Model
from spirob.machine.rig import RigFile
from spirob.machine.search import Search

AT_LOAD = (
    "The logs fit a position sensor at the load, behind gear and shaft, better than one at the "
    "motor: taken so. position.side says where it sits."
)


def may_sit_at_load(rig: RigFile, search: Search, chosen: Model) -> bool:
    """Whether a description leaves the side open and enough is left for it to matter."""
    opened = rig.position is not None and rig.position.side is None and isinstance(rig.body, str)
    return opened and search.worth.possible(chosen, 0.0)


def fits_at_load(at_load: Search, chosen: Model) -> bool:
    """Whether a law of the load's side halves what the model chosen for the motor's leaves.

    at_load  the search in which the sensor sits there

    Less would be too little to contradict what most descriptions mean: the edges of friction at a
    reversal look like a little play behind the sensor.
    """
    kept = tuple(for_axis((e for e in chosen.effects if e.name() not in LOAD_SIDE), side="load"))
    laws = [e for e in at_load.candidates if e in LOAD_SIDE.values()]
    grown = at_load.extended(kept, chosen.fit.changes, laws)
    return any(at_load.worth.halves(chosen, model) for model in grown)
