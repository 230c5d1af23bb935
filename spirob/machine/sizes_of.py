"""How large a rig is in every dimension, from its training trials."""

from collections.abc import Sequence

import numpy as np

from spirob.errors import ConfigError
from spirob.machine.body import RigidBody
from spirob.machine.recording import Recording
from spirob.machine.rig import ANGLES, LENGTHS, SI, RigFile
from spirob.machine.scaling import Sizes

REST = 0.01  # of the fast part of the motion: the scale of a smooth sign


def sizes_of(
    rig: RigFile, body: RigidBody | None, train: Sequence[Recording]
) -> tuple[Sizes, float]:
    """The rig's size in every dimension, from its training trials, and its speed of rest.

    Raises ConfigError where the speed of rest is given, and faster than the motion.
    """

    def gathered(field: str) -> np.ndarray:
        return np.concatenate([getattr(p, field)[p.use] for r in train for p in r.pieces])

    q, v, effort = gathered("q"), gathered("v"), gathered("effort")
    angular = rig.position.unit in ANGLES
    axis = "rad" if angular else "m"
    scale = rig.known.get("scale", rig.fit["scale"].nominal if "scale" in rig.fit else 0.0)
    unit = SI[rig.effort.kind]
    size = float(np.sqrt(np.mean(effort**2)))
    stroke = float(np.ptp(q))
    gear = rig.gear or (1.0 if angular else 2 * np.pi / stroke)
    sizes = Sizes(
        torque=size * abs(scale or 1.0),
        speed=float(np.sqrt(np.mean(v**2))),
        angle=1.0 / gear,
        stroke=stroke,
        current=size,
        mass=body.mass if body else 0.1,
        torque_unit=("N·m" if angular else "N") if scale else unit,
        effort_unit=unit,
        axis_unit=axis,
    )
    fast = float(np.quantile(np.abs(v), 0.95))
    given = rig.rest_speed and rig.rest_speed * (LENGTHS | ANGLES)[rig.position.unit]
    if given and given > fast:
        raise ConfigError(
            f"rest_speed: {given:.3g} {axis}/s is faster than the motion, whose fast part is at "
            f"{fast:.3g}: friction would have no sign"
        )
    return sizes, given or REST * fast
