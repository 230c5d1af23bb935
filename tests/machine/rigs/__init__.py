"""Machines that are not ours, simulated by equations of their own.

Nothing of the library is used here: bristle friction after Canudas de Wit, drag, magnets, dampers
and a pendulum are written out again, in richer forms where there are any.  Every function gives
the description of the rig, its logs (training trials and a held-out one) as columns, and what the
right answer is.
"""

from tests.machine.rigs.axis import Case, description
from tests.machine.rigs.complete import coarse, coloured, nothing_missing
from tests.machine.rigs.drive import late, saturating, smoothed
from tests.machine.rigs.friction import crane, damper, direct_drive, servo
from tests.machine.rigs.load import PENDULUM, belt, lever, magnets, pendulum, play, shaft, spring

CASES = {
    f.__name__: f
    for f in (
        nothing_missing,
        coloured,
        servo,
        direct_drive,
        damper,
        pendulum,
        lever,
        belt,
        shaft,
        play,
        crane,
        saturating,
        smoothed,
        magnets,
        spring,
        late,
        coarse,
    )
}

__all__ = ["CASES", "PENDULUM", "Case", "damper", "description"]
