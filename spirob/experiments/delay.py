"""Delay under a constant tendon force.

At rest a force is commanded on the left tendon; the force law turns it into a current.  Two delays
are read: of the tendon force that the drive reports, F = n i - c v, until it first comes to half of
what is commanded, raw and after the paper's 100-sample mean, which alone is 49.5 ms late; and of
the displacement, until half of what it moves while the force holds.  The force falls again as the
geared motor gains speed, because the law is proportional; its mean over the last second is told.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from spirob.experiments import WINDOW, Experiment, Play, Side, Sides, aimed, curve, plan, row, trial
from spirob.experiments.response import PERIOD, crossing, step_times
from spirob.logs.trace import moving_average

PAPER = 52.4  # ms, "steady-state delay" at 1 N
AIM = 0.05  # of the robot's


@dataclass(frozen=True, kw_only=True)
class Delay(Experiment):
    """forces [N]; rest before the step, and how long the force holds [s].

    newton_per_ampere, drag  of the force law [N/A], [N·s/m]: how the drive's report is read
    """

    title: ClassVar[str] = "Delay under constant tendon force"
    forces: tuple[float, ...] = (0.5, 1.0, 2.0, 4.0)
    rest: float = 0.3
    hold: float = 2.2
    newton_per_ampere: float = 15.0
    drag: float = 92.0

    def plays(self) -> list[Play]:
        return [Play(self._name(f), self._trial(f)) for f in self.forces]

    def _name(self, force: float) -> str:
        return f"delay_{force:g}N"

    def _trial(self, force: float) -> dict[str, Any]:
        steps = {
            "kind": "steps",
            "plateaus": [[self.rest, 0.0], [self.hold, force]],
            "blend": 0.0,
        }
        idle = plan("current", {"kind": "constant", "value": 0.0})
        return trial(self._name(force), self.rest + self.hold, plan("force", steps), idle)

    def times(self, side: Side, commanded: float) -> dict[str, float]:
        """Delays and rises [ms] of one side and the force that it holds [N].

        The baseline has no force but the commanded one, heard through the same mean.
        """
        end = self.rest + self.hold
        shape = step_times(side.driven("displacement", 0), self.rest, (end - 0.1, end))
        found = {"displacement": 1e3 * shape["delay"], "displacement rise": 1e3 * shape["rise"]}
        if side.current is None:
            force = np.where(side.seconds >= self.rest, commanded, 0.0)
        else:
            force = self.force(side)
        first = round(self.rest / PERIOD)
        mean = moving_average(force, WINDOW)[first:] / commanded
        tenth, half, most = (crossing(mean, share) for share in (0.1, 0.5, 0.9 * mean.max()))
        return found | {
            "raw": 1e3 * crossing(force[first:] / commanded, 0.5),
            "filtered": 1e3 * half,
            "filtered rise": 1e3 * (most - tenth),
            "held": float(np.mean(force[-1000:])),
        }

    def force(self, side: Side) -> np.ndarray:
        """The tendon force that the drive reports [N]."""
        return self.newton_per_ampere * side.driven("current", 0) - self.drag * side.driven(
            "velocity", 0
        )

    def measure(self, sides: Sides) -> list[dict[str, Any]]:
        rows = []
        for force in self.forces:
            times = {s: self.times(side, force) for s, side in sides[self._name(force)].items()}
            for key, paper, note in (
                ("filtered", PAPER if force == 1.0 else None, "100-sample mean: 49.5 ms of it"),
                ("filtered rise", None, ""),
                ("raw", None, "without the mean"),
                ("displacement", None, "half of what it moves while the force holds"),
                ("displacement rise", None, "from a tenth to nine tenths of it"),
            ):
                values = {s: t[key] for s, t in times.items()}
                aim = aimed(values, AIM) if key in ("filtered", "displacement") else {}
                name = key if key.startswith("displacement") else f"force, {key}"
                what = f"delay of {name} at {force:g} N"
                rows.append(row(what, "ms", values, paper=paper, note=note, **aim))
            held = {s: t["held"] for s, t in times.items()}
            rows.append(row(f"force held at {force:g} N", "N", held))
        return rows

    def curves(self, sides: Sides) -> list[dict[str, Any]]:
        out = []
        for force in self.forces:
            for name, side in sides[self._name(force)].items():
                play = f"{force:g} N"
                moved = 1e3 * side.driven("displacement", 0)
                out.append(curve(play, "displacement", "mm", name, side.seconds, moved))
                if side.current is not None:
                    felt = moving_average(self.force(side), WINDOW)
                    out.append(curve(play, "force, filtered", "N", name, side.seconds, felt, 5))
        return out
