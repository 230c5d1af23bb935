"""Single contact with the current loop on the host: voltages over the bus, readings a cycle old.

The same shots as in `single_contact`.  A motor that is pushed turns, and its back-EMF moves the
current until the loop has answered.  Fed forward as in (12), by a reading that is τ old, it is
taken away again all but k_e(ω(t) - ω(t - τ)); without that term feedback alone is against it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from spirob.experiments import Sides, curve, row
from spirob.experiments.host_loop import GainSet, OnHost, or_none
from spirob.experiments.single_contact import (
    FIGURES,
    READ,
    SingleContact,
    in_time,
    rank_agreement,
    responses,
    visible,
)

ORDER = 0.9  # least rank agreement
APART = 0.3  # most by which a peak of the model may be off
SMALL = 5.0  # counts; smaller peaks are not compared in size
MODELS = ("base", "named", "single")
SENSITIVITIES = {
    "peak": "sensitivity along the arm",
    "arm peak": "reconstructed sensitivity along the arm",
}
Found = dict[str, list[dict[str, float]]]


def deviations(told: Mapping[str, Mapping[str, float]]) -> str:
    """The standard error of each side's mean, where it has one."""
    noise = {s: r["peak noise"] for s, r in told.items() if r.get("peak noise")}
    each = ", ".join(f"{s} {value:.1f}" for s, value in noise.items())
    return f"standard error in counts: {each}" if each else ""


def _noise(found: Sequence[Mapping[str, float]], told: Sequence[int]) -> float:
    """The largest at some places."""
    return max(found[k].get("peak noise", 0.0) for k in told)


@dataclass(frozen=True, kw_only=True)
class HostContact(OnHost, SingleContact):
    """The shots of SingleContact under each set of gains."""

    title: ClassVar[str] = "Single contact, no gearbox, current loop on the host"
    about: ClassVar[str] = (
        "A loop in the drive answers a push within a fraction of a millisecond and hides it; one "
        "on the host hears of it a cycle late and answers slowly, so that the back-EMF of the "
        "pushed motor stands in its current. Whatever of that back-EMF the host feeds forward, "
        "as the paper's (12) does, it takes away again, but for what came within the latency. "
        "Single dynamics has no motor to be pushed: its current stays the commanded one, 0 counts "
        "at every place, which is 100 % off and has no order, while its angle answers."
    )
    named: ClassVar[str] = "host_ball"
    # a peak is then sure to 0.8 counts, half of the 30 % that are asked of one of 5 counts, and to
    # 0.5, a tenth of it, where there are no larger ones but at the tip: one shot has 2.1 at most
    shots: int = 6
    forward: int = 18

    def _found(self, sides: Sides, one: GainSet) -> Found:
        """Side -> responses at every place."""
        free = self.at(sides, one, None)
        hits = [self.at(sides, one, place) for place in self.places]
        return {s: [responses(hit[s], free[s], self.hit) for hit in hits] for s in free}

    def measure(self, sides: Sides) -> list[dict[str, Any]]:
        rows = [GainSet(b, 1.0, self.latency).margin() for b in self.bandwidths]
        rows += self.told_rows()
        for one in self.sets:
            found = self._found(sides, one)
            for key, what in READ:
                for k, place in enumerate(self.places):
                    told = {s: r[k] for s, r in found.items() if key in r[k]}
                    rows.append(self._row(f"{what}, {one.words}, at {place:.0%}", key, told))
            if "robot" in found:
                rows += [self._order(one, found), self._size(one, found)]
        return rows

    def _row(self, what: str, key: str, told: dict[str, dict[str, float]]) -> dict[str, Any]:
        """With how far noise may have moved a peak."""
        found = super()._row(what, key, told)
        noise = deviations(told) if key == "peak" else ""
        return found | {"note": "; ".join(n for n in (found["note"], noise) if n)}

    def _order(self, one: GainSet, found: Found) -> dict[str, Any]:
        """Rank of the current's peak over the places where the robot shows it."""
        what = f"rank agreement of current peak, {one.words}"
        robot = found["robot"]
        least = [max(r["peak error"], one.unsure) for r in robot]
        shown = [k for k, r in enumerate(robot) if visible(r["peak"], least[k])]
        note = "robot: against the distance from the base, models: against the robot"
        if len(shown) < len(self.places):
            at = ", ".join(f"{self.places[k]:.0%}" for k in shown) or "none"
            rpm = f", where whole rpm make up to {one.unsure:.1f} counts" if one.share else ""
            return row(what, "1", {}, note=f"no order: visible on the robot at {at}{rpm}")
        peaks = {s: [r["peak"] for r in rows] for s, rows in found.items() if "peak" in rows[0]}
        agree = {m: rank_agreement(peaks[m], peaks["robot"]) for m in MODELS if m in peaks}
        agree["robot"] = rank_agreement(peaks["robot"], list(self.places))
        met = bool(min(agree["robot"], agree.get("named", np.nan)) >= ORDER)
        aim = f"at least {ORDER} each"
        told = or_none(agree)
        return row(what, "1", told, paper="rises to the tip", aim=aim, met=met, note=note)

    def _size(self, one: GainSet, found: Found) -> dict[str, Any]:
        """How far the models' peaks are off where the robot's is no noise, at the worst place."""
        robot = found["robot"]
        told = [
            k
            for k, r in enumerate(robot)
            if visible(r["peak"], r["peak error"]) and r["peak"] > SMALL
        ]
        off = {
            m: max(abs(found[m][k]["peak"] / robot[k]["peak"] - 1.0) for k in told)
            for m in MODELS
            if m in found and told
        }
        met = bool(off["named"] <= APART) if "named" in off else None
        at = ", ".join(f"{self.places[k]:.0%}" for k in told) or "none"
        what = f"current peak off the robot's, {one.words}"
        note = f"worst of the places where the robot shows more than {SMALL:g} counts: {at}"
        if told:
            at_most = {s: {"peak noise": _noise(r, told)} for s, r in found.items()}
            note = "; ".join(n for n in (note, deviations(at_most)) if n)
        return row(what, "1", off, aim=f"at most {APART}", met=met, note=note)

    def curves(self, sides: Sides) -> list[dict[str, Any]]:
        out, at = [], 100 * np.array(self.places)
        for one in self.sets:
            for s, found in self._found(sides, one).items():
                for key, quantity in FIGURES:
                    if key in found[0]:
                        peaks = np.array([r[key] for r in found])
                        out.append(curve(one.words, quantity, "counts", s, at, peaks, 1))
        slowest = self.slowest
        for s, found in self._found(sides, slowest).items():
            for key, quantity in SENSITIVITIES.items():
                if key in found[0]:  # of the ball's momentum
                    each = np.array([r[key] for r in found]) / (1e3 * self.mass * self.speed)
                    out.append(curve(slowest.words, quantity, "counts/(mN·s)", s, at, each, 1))
        for place in self.places[:: max(1, len(self.places) // 3)]:
            play = f"{slowest.words}, at {place:.0%}"
            hit, free = (self.at(sides, slowest, p) for p in (place, None))
            out += in_time(play, hit, free, self.hit, self.motor)
        return out
