"""What the residual showed of an effect, against its fitted law.

The model that holds the effect was played with it and, all other numbers as fitted, without it:

    shown = measured − without,     law = with − without,

both in current [A] on trials that no fit has seen.  A law that is right has shown = law + noise.
"""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
import pandas as pd

from spirob.effects.effect import Effect

KEYS = ["trial", "motor", "time"]
TURNING = ("speed", "velocity", "sliding")
CURRENTS = ("command.current", "sensing.current", "sensing.report")  # ports
LOADING = ("current", "command", "tension", "load_torque", "power")
PLACING = ("angle", "displacement", "stretch", "stiffness", "weight")


@dataclass(frozen=True)
class Against:
    """A measured signal that a law is drawn over: its channel, its name and its unit."""

    channel: str
    title: str


SPEED = Against("velocity", "speed of the tendon [m/s]")
LOAD = Against("current", "motor current [A]")
PLACE = Against("displacement", "wound-in length [m]")
TIME = Against("time", "time since the trial began [s]")


@dataclass(frozen=True)
class Law:
    """Samples of driven motors: the signal it is drawn over, what was shown and the law.

    effort, unit, factor  what both are called, the unit that they are drawn in, from their own
    """

    against: Against
    x: np.ndarray
    shown: np.ndarray
    law: np.ndarray
    effort: str = "current"
    unit: str = "mA"
    factor: float = 1e3

    @property
    def accounted(self) -> float:
        """Share of the squared effort shown that the law takes away; negative if it adds."""
        return 1.0 - float(np.mean((self.shown - self.law) ** 2) / np.mean(self.shown**2))


def against(effect: type[Effect] | None) -> Against:
    """The measured signal nearest to what the law depends on, by the first signal it reads."""
    reads = list(effect.reads.values()) if effect is not None else []
    for signal in reads:
        own = signal.partition(".")[2]
        if any(word in own for word in LOADING):
            return LOAD
        if any(word in own for word in TURNING) and own != "rest_speed":
            return SPEED
        if any(word in own for word in PLACING):
            return PLACE
    if effect is not None and effect.port in CURRENTS:
        return LOAD
    return TIME


def law(
    played: pd.DataFrame,
    overlay: pd.DataFrame,
    driven: Collection[tuple[str, str]],
    effect: type[Effect] | None,
) -> Law | None:
    """One effect's samples, from its rows of `laws.parquet`; None where no motor was driven."""
    wide = played.merge(overlay, on=KEYS, how="inner")
    pairs = pd.Series(list(zip(wide["trial"].astype(str), wide["motor"].astype(str), strict=True)))
    wide = wide[pairs.isin(list(driven)).to_numpy()]
    over = against(effect)
    column = "time" if over is TIME else f"measured_{over.channel}"
    without = wide["without_current"].to_numpy(float)
    shown = wide["measured_current"].to_numpy(float) - without
    found = wide["with_current"].to_numpy(float) - without
    if not len(wide) or not np.any(shown):
        return None
    return Law(over, wide[column].to_numpy(float), shown, found)
