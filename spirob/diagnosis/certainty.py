"""How sure is a name?  As often as names with such figures were right in the campaign.

    p = 1/(1 + exp(-(w₀ + Σ w_k (x_k - m_k)/s_k)))

x are six figures of what a search shows of one chosen effect, as `figures` takes them; w, m, s
stand in `certainty.json` beside this file, with the cases that they were learned from
(`spirob.campaign.calibration`).  There are two of these: of the name itself, and of its kin, which
is right where the name or one that says a part of the same is.  Logarithms are natural, errors
squared:

fall_heldout   ln of the held-out error without the effect over that with it
ahead_heldout  ln of the held-out error of the best other model over that of the chosen one; the
               other is no richer, without the effect, and says something else
ahead_of_kin   the same, of models without its kin, too: what the kin is judged by
left           ln of what still follows from the motion, over what this effect took
sharp          ln of an amplitude over half its interval's width, of the sharpest
place          0 for the effect that takes most, then 1, 2, ...
late           ln(1 + |delay| over the usual one)
"""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from spirob.effects import Effect
from spirob.identify.fit import Fit

LEARNED = json.loads(Path(__file__).with_name("certainty.json").read_text())
FIGURES = {
    "name": ("fall_heldout", "ahead_heldout", "left", "sharp", "place", "late"),
    "kin": ("fall_heldout", "ahead_of_kin", "left", "sharp", "place", "late"),
}
LIKELY = 0.5  # a name is given where it is more likely right than wrong
TINY = 1e-300
MOST = 10.0  # of a logarithm: what is larger says no more


def probability(figures: Mapping[str, float], of: str = "name") -> float:
    """How likely a name with these figures is right, as it was in the campaign; or its "kin"."""
    x, learned = np.array([figures[name] for name in FIGURES[of]]), LEARNED[of]
    mean, scale, weights = (np.array(learned[key]) for key in ("mean", "scale", "weights"))
    return float(1.0 / (1.0 + np.exp(-(learned["bias"] + weights @ ((x - mean) / scale)))))


def ratio(one: float, two: float) -> float:
    """ln of one over the other, both at least 0, within ± MOST."""
    return float(np.clip(np.log(max(one, TINY) / max(two, TINY)), -MOST, MOST))


def sharp(found: Fit, effect: type[Effect]) -> float:
    """How far an amplitude is from what makes it neutral, in half widths of its interval: ln."""
    told = []
    for field, zero in effect.neutral.items():
        if estimate := found.estimates.get(f"{effect.name()}.{field}"):
            told.append(ratio(abs(estimate.value - zero), 0.5 * (estimate.high - estimate.low)))
    return max(told, default=0.0)


def rounded(figures: Mapping[str, float]) -> dict[str, float]:
    """Six digits, as they are kept."""
    return {name: float(f"{value:.6g}") for name, value in figures.items()}
