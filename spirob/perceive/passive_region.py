"""Where along the arm a push was: base, middle or tip, from current and angle.

Features are the same whichever side is pushed: of both motors the larger entry, then the smaller.
Sizes are taken as logarithms, for a push of another strength scales them all.
"""

from collections.abc import Sequence

import numpy as np
from sklearn.linear_model import LogisticRegression
from sklearn.pipeline import Pipeline, make_pipeline
from sklearn.preprocessing import StandardScaler

from spirob.perceive.passive import Response

REGIONS = ("base", "middle", "tip")
BORDERS = (1 / 3, 2 / 3)  # of the length
LEAST_CURRENT, LEAST_LENGTH = 1e-4, 1e-6  # A, m: what is below is as good as nothing


def region(place: float) -> str:
    """The region of a place, as a share of the arm's length from the base."""
    return REGIONS[int(np.searchsorted(BORDERS, place, side="right"))]


def features(response: Response) -> np.ndarray:
    """Numbers that tell where a push was, in the order in which the classifier takes them."""
    sizes = [_sorted(response.peak, LEAST_CURRENT)]
    sizes += [_sorted(v, LEAST_LENGTH) for v in (response.travel, response.swing)]
    whole = np.concatenate(sizes)
    strongest = int(np.argmax(response.peak))
    times = response.peak_after[strongest], response.travel_after[strongest]
    return np.concatenate([whole, [whole[0] - whole[2]], times])


def _sorted(values: np.ndarray, least: float) -> np.ndarray:
    return np.log(np.maximum(np.sort(values)[::-1], least))


def learned(responses: Sequence[Response], places: Sequence[float]) -> Pipeline:
    """A classifier of regions from pushes at known places."""
    made = make_pipeline(StandardScaler(), LogisticRegression(C=10.0, max_iter=5000))
    made.fit(np.array([features(r) for r in responses]), [region(p) for p in places])
    return made
