"""Floor and weights of an arm of our own design, by builds that are drawn about its numbers.

Lengths, mounts, drums, gears and the common place of the holes are none of its builds: what they
change, the fitted numbers take up.
"""

from collections.abc import Mapping, Sequence

from spirob.diagnosis.evidence import complete
from spirob.identify.builds import RESOLUTION, Builds, Floor, floor_of, weighted
from spirob.identify.fit import Fit
from spirob.identify.residual import Residual


def builds_at(changes: Mapping[str, float], names: Sequence[str], scale: float) -> Builds:
    """Builds of a machine with these numbers, of which the named are fitted.

    scale  of the robust loss
    """
    return Builds(changes, names, scale, {})


def floor_at(found: Fit, residuals: Mapping[str, Residual], scale: float) -> Floor:
    """The floor where these numbers were fitted."""
    builds = builds_at(found.changes, list(found.estimates), scale)
    return floor_of(residuals["train"], residuals["validate"], builds)


def weighed_at(
    changes: Mapping[str, float],
    names: Sequence[str],
    residuals: Mapping[str, Residual],
    scale: float,
) -> dict[str, Residual]:
    """The trials weighted by what builds of this machine differ by in them, by role."""
    right = complete(residuals["train"], RESOLUTION)
    return weighted(residuals, builds_at(changes, names, scale), right)
