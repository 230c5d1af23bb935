"""How large a rig is in every dimension, from its training trials."""

from collections.abc import Sequence

import numpy as np

from spirob.errors import ConfigError
from spirob.machine.body import RigidBody
from spirob.machine.recording import Recording
from spirob.machine.rig import RigFile
from spirob.machine.scaling import Sizes

REST = 0.01  # of the fast part of the motion: the scale of a smooth sign


def sizes_of(
    rig: RigFile, body: RigidBody | None, train: Sequence[Recording]
) -> tuple[Sizes, float]:
    """The rig's size in every dimension, from its training trials, and its speed of rest."""

    def gathered(field: str) -> np.ndarray:
        return np.concatenate([getattr(p, field)[p.use] for r in train for p in r.pieces])

    q, v, effort = gathered("q"), gathered("v"), gathered("effort")
    angular = rig.angular
    scale = rig.known.get("scale", rig.fit["scale"].nominal if "scale" in rig.fit else 0.0)
    unit = rig.effort.si
    size = float(np.sqrt(np.mean(effort**2)))
    stroke = float(np.ptp(q))
    gear = rig.gear or (1.0 if angular else 2 * np.pi / stroke)
    sizes = Sizes(
        torque=size * (scale or 1.0),
        speed=float(np.sqrt(np.mean(v**2))),
        angle=1.0 / gear,
        stroke=stroke,
        current=size,
        mass=body.mass if body else 0.1,
        torque_unit=("N·m" if angular else "N") if scale else unit,
        effort_unit=unit,
        axis_unit=rig.axis,
    )
    fast = float(np.quantile(np.abs(v), 0.95))
    if rig.rest_speed is None:
        return sizes, REST * fast
    speed, unit = rig.speed_scale, rig.motion.unit.removesuffix("/s")
    if rig.rest_speed * speed >= fast:
        raise ConfigError(
            f"rest_speed: {rig.rest_speed:g} is no speed of rest, as the axis moves at "
            f"{fast / speed:.3g} {unit}/s; about a hundredth of that is usual"
        )
    return sizes, rig.rest_speed * speed
